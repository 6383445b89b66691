// Fogs from fogs: of other pixels, smaller ones, of another degree.
#pragma once

#include "wavefog/fogmap/fog.h"

namespace wavefog {

/// `map` decomposed as `options` say, in the place, thickness and wind of `like`.
Result<Fog> fog_like(const Fog& like, const Grid<float>& map, const FogOptions& options);

/// The fog's finest map. Rounding of the inverse transform may leave -1e-8 where it is 0: that
/// becomes 0.
Grid<float> map_of(const Fog& fog);

/// The fog without its `dropped` finest levels: an approximation of the pyramid becomes the map.
/// The function is the one that mu = 0 leaves of a fog of `dropped` levels, but for coefficients
/// below 0, which become 0. With a zero border the coarse functions reach past the fine map's, so
/// the rectangle grows by a few fine cells. A usage error if the fog has fewer levels.
Result<Fog> without_finest(const Fog& fog, int dropped);

/// The same pixels read as coefficients of a degree, decomposed by its default family into `levels`
/// (capped as decompose() does).
Result<Fog> decomposed_as(const Fog& fog, int degree, int levels);

}  // namespace wavefog
