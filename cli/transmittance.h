// How far apart two fogs are along rays.
#pragma once

#include <cstddef>

#include "wavefog/fogmap/fog.h"

namespace wavefog::cli {

struct SampledError {
    double worst = 0;      ///< largest |dT|
    std::size_t rays = 0;  ///< of so many
};

/// Compares transmittances along rays through the pixels that are off by most and random points
/// (the same ones every time) above or below the map's rectangle: along rows and columns, level
/// ones, straight up and of any slope, of `path` metres (0: the rectangle's diagonal), half of it,
/// a quarter and so on, from where fog is densest above the height `ground` (or -infinity).
SampledError sampled_transmittance_error(const Fog& a, const Fog& b, double path, double ground);

}  // namespace wavefog::cli
