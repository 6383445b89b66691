// Camera files (JSON, strict keys): the camera of a picture with depth, and what its depth means.
#pragma once

#include <filesystem>

#include "wavefog/fogmap/scene.h"

namespace wavefog {

/// What the values of a depth picture stand for.
struct DepthValues {
    enum class Kind {
        gl,      ///< the depth buffer's, 0 to 1, by the camera's near, far and depth convention
        metres,  ///< metres / scale - offset; 0 is not measured
        inverse  ///< scale / metres - offset (a stereo pair's disparity, scale = focal length in
                 ///< pixels times the distance of its eyes); 0 metres^-1 is infinitely far,
                 ///< infinite is not measured
    };
    /// gl is along the axis.
    enum class Measured {
        axis,     ///< along the view axis, from the plane of the eye
        distance  ///< along the pixel's own ray, from the eye
    };
    Kind kind = Kind::gl;
    Measured measured = Measured::axis;
    double scale = 1;  ///< above 0
    double offset = 0;
    /// What is not measured: background, or as far as the farther one of the nearest measured
    /// pixels to its left and right (what one eye of a stereo pair does not see lies behind).
    enum class Unmeasured { background, neighbours };
    Unmeasured unmeasured = Unmeasured::background;
};

struct CameraFile {
    Camera camera;
    DepthValues depth;
};

/// Reads a camera file: the keys of a scene's "camera", and "depth_values": "gl", "metres" or
/// "inverse"; the last two with "measured": "axis" or "distance", and perhaps "depth_scale",
/// "depth_offset" and "unmeasured": "background" or "neighbours".
/// Data errors name file and key.
Result<CameraFile> load_camera(const std::filesystem::path& file);

}  // namespace wavefog
