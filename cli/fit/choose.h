// Chooses among the settings that a search found, and holds the choice to views it has not seen.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/search.h"
#include "report.h"

namespace wavefog::cli {

/// Settings are tuned on the first views and checked on the others.
struct FitViews {
    std::vector<View> tuning, held_out;
    std::vector<View> whole;  ///< the scene's own cameras at the size asked for
};

Result<FitViews> fit_views(const Gl& gl, const Scene& scene, const Size& size);

struct FitGoal {
    double max_error = 0;
    std::optional<double> target_ms;
    Size size;  ///< of timed frames and of the pictures that are checked in full
};

/// What was chosen.
struct FitChoice {
    FitMaps maps;
    Method method;
    std::vector<Formula> formulas;  ///< that keep the error, chosen or not
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
