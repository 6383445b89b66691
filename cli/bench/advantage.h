// At equal error: what a frame costs with our methods, and with those that take samples.
#pragma once

#include <string>
#include <vector>

#include "bench/figure.h"
#include "bench/results.h"

namespace wavefog::cli {

/// Methods of this project that one would use: exact and radial. (paper and paper-scaling are as
/// published.)
bool is_ours(const Row& row);

/// For each decade of error from 1e-1 to 1e-5 and each group of rows: the cheapest setting of ours
/// and of march or froxel that errs no more, and how many times ours is faster.
std::string advantage_text(const std::vector<Row>& rows, bool markdown);

/// Five times the cost of our cheapest settings, as a curve of the chart of cost against error:
/// what lies to its right is at least five times slower. Empty without settings of ours.
Curve five_times_ours(const std::vector<Row>& group);

}  // namespace wavefog::cli
