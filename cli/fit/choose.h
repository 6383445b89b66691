// Chooses among the settings that a search found, and holds the choice to views it has not seen.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/search.h"
#include "report.h"

namespace wavefog::cli {

/// Settings are tuned on the first views and checked on the second.
struct FitViews {
    std::vector<View> tuning, held_out;
};

Result<FitViews> fit_views(const Gl& gl, const Scene& scene, const Size& size);

struct FitGoal {
    double max_error = 0;
    std::optional<double> target_ms;
    Size size;  ///< of timed frames
};

/// What was chosen, and what it does on views that it was not chosen on.
struct FitChoice {
    FitMaps maps;
    Method method;
    std::vector<Formula> formulas;  ///< that keep the error, chosen or not
    Worst tuning, held_out, before;
    double ms = 0, before_ms = 0;
    std::size_t gpu_bytes = 0, before_gpu_bytes = 0;
    std::vector<std::string> why;
    Facts kept = Facts::array();    ///< settings that keep the error
    Facts missed = Facts::array();  ///< those that do not
};

/// A data error if nothing keeps the error.
Result<FitChoice> choose(const Gl& gl, const Scene& scene, const FitViews& views,
                         const FitGoal& goal);

}  // namespace wavefog::cli
