// What each preset measures.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/measure.h"

namespace wavefog::cli {

enum class Preset {
    none,
    speed,
    chart,
    paper_tables,
    stability,
    scale,
    compression,
    motion,
    resolution,
    models
};
inline const std::vector<std::string> preset_names = {
    "none",  "speed",       "chart",  "paper-tables", "stability",
    "scale", "compression", "motion", "resolution",   "models"};

/// What the command line may set; empty: the preset's own choice.
struct PlanOptions {
    Preset preset = Preset::none;
    std::optional<Size> size;
    std::vector<Method> methods;
    std::vector<double> mus;
    std::vector<int> levels;
};

/// Groups for `scenes`. What a preset leaves out of them is told in `cut`.
Result<std::vector<Group>> plan(const std::vector<BenchScene>& scenes, const PlanOptions& options,
                                std::vector<std::string>& cut);

/// Seconds that a preset takes at most unless --budget says otherwise; 0: unbounded.
double preset_seconds(Preset preset);

/// "exact,march:32": methods with commas between them; "0,0.5,1"; "0,1,2".
Result<std::vector<Method>> parse_methods(const std::string& text);
Result<std::vector<double>> parse_mus(const std::string& text);
Result<std::vector<int>> parse_level_list(const std::string& text);

}  // namespace wavefog::cli
