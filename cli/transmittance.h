// How far apart two fogs are along rays.
#pragma once

#include <cstddef>

#include "wavefog/fogmap/fog.h"

namespace wavefog::cli {

struct SampledError {
    double worst = 0;      ///< largest |dT|
    std::size_t rays = 0;  ///< of so many
};

/// Compares transmittances along rays between random points of the map's rectangle (the same ones
/// every time), where the height profile is 1, of up to `path` metres (0: any length).
SampledError sampled_transmittance_error(const Fog& a, const Fog& b, double path);

}  // namespace wavefog::cli
