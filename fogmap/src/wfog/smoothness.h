// How a map lends itself to bounds of their own for coarse levels.
#pragma once

#include <cstdint>

#include "samples.h"
#include "wavefog/wavelet/grid.h"

namespace wavefog::wfog {

/// Whether more than `share` of the pixels follow within `bound` from the mean of the four around
/// them; of those inside the map, of every other row.
bool mostly_foretold(const Grid<float>& map, const Scale& scale, std::int64_t bound, double share);

/// RMS error, in densities, of every integer moved to the nearest of those that are 2 bound + 1
/// apart, beginning with the least; `roughly`: of every fourth row of maps that have many.
double prequantised_rms(const Grid<float>& map, const Scale& scale, std::int64_t bound,
                        bool roughly);

}  // namespace wavefog::wfog
