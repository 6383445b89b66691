// Where the table of method radial has its columns and rows: from fog, camera and picture, in double.
#pragma once

#include "fog_uniforms.h"

namespace wavefog {

/// Columns and rows of a table; 0: chosen for the fog and the picture.
struct RadialSize {
    int columns = 0, rows = 0;
};

/// Largest table that radial_block() asks for by itself.
inline constexpr RadialSize kRadialLargest = {2048, 512};

/// What the picture needs: the azimuths in view and the least angle that matters.
struct RadialView {
    bool full = true;               ///< zenith or nadir is in view: every azimuth
    Eigen::Vector2d axis{0, -1};    ///< horizontal unit vector (x, z) in the middle of the view
    double first = 0, last = 0;     ///< radians from the axis, unless full
    double pixel = 0;               ///< angle of a pixel, radians; 0: none
    int level_pixels = 0;           ///< pixel columns if azimuths are tangents along them, else 0
};
RadialView radial_view(const CameraMatrices& matrices, const Camera& camera, int width, int height);

/// The table for rays from `eye`, no longer than `limit` metres. Columns keep to the fog's part of
/// the view, rows to its distances.
shader::RadialBlock radial_block(const FogFacts& fog, const Eigen::Vector3d& eye,
                                 const RadialView& view, double seconds, double limit,
                                 RadialSize size);

}  // namespace wavefog
