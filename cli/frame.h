// One fogged frame, drawn by the GPU pass or by the reference integrator.
#pragma once

#include <string>

#include "wavefog/fogmap/image.h"
#include "wavefog/fogmap/scene.h"

namespace wavefog::cli {

struct Frame {
    Image colour;         ///< linear RGB
    Image transmittance;  ///< one channel, [0, 1]
    std::string renderer;
};

/// Draws `scene` with scene.method at `supersample` times its size and averages back to it: linear
/// colours, and T itself (not the optical depth).
Result<Frame> draw_frame(const Scene& scene, const std::string& context, int supersample);

/// Mean of every factor x factor block; sides must be multiples of the factor.
Image box_average(const Image& image, int factor);

}  // namespace wavefog::cli
