// Depth pictures from elsewhere become what the fog pass reads.
#pragma once

#include "wavefog/fogmap/camera_file.h"
#include "wavefog/fogmap/image.h"

namespace wavefog {

/// A depth buffer and the camera whose convention it has.
struct DepthPicture {
    Camera camera;
    Image depth;                 ///< one channel
    std::size_t background = 0;  ///< pixels with nothing in them: infinite, or at or beyond far
    std::size_t unmeasured = 0;  ///< NaN, or 0 metres: taken as background
};

/// `values`: one channel, or several that are equal. Metres and inverse metres become a reversed
/// depth buffer, which keeps float32's precision at every distance; depth-buffer values stay as
/// they are. A data error names the first pixel that is negative or, with Kind::gl, outside [0, 1].
Result<DepthPicture> depth_for_fog(const Image& values, const CameraFile& file);

}  // namespace wavefog
