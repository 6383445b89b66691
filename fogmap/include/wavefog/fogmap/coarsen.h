// Smaller fogs from large ones.
#pragma once

#include "wavefog/fogmap/fog.h"

namespace wavefog {

/// The fog without its `dropped` finest levels: an approximation of the pyramid becomes the map.
/// The function is the one that mu = 0 leaves of a fog of `dropped` levels, but for coefficients
/// below 0, which become 0. With a zero border the coarse functions reach past the fine map's, so
/// the rectangle grows by a few fine cells. A usage error if the fog has fewer levels.
Result<Fog> without_finest(const Fog& fog, int dropped);

/// The same pixels read as coefficients of a degree, decomposed by its default family into `levels`
/// (capped as decompose() does).
Result<Fog> decomposed_as(const Fog& fog, int degree, int levels);

}  // namespace wavefog
