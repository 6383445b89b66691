// Figures drawn from rows of measurements.
#pragma once

#include <vector>

#include "bench/results.h"

namespace wavefog::cli {

/// What a results file shows: its own figures, and for sweeps cost against error and frames a
/// second against mu.
std::vector<Figure> figures_of(const Results& results);

}  // namespace wavefog::cli
