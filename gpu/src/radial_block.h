// Where the table of method radial has its columns and rows: from fog, camera and picture, in
// double.
#pragma once

#include "fog_uniforms.h"

namespace wavefog {

/// What a table's texture holds: `layers` tables, one below the other. Within 16 MiB unless the
/// method names a size.
struct RadialShape {
    int columns = 2048, rows = 512;  ///< of a table, at most
    bool fixed = false;              ///< exactly as many; else as the fog and the picture need
    int channels = 1;                ///< floats a texel: RADIAL_ORDER of fog_radial.glsl, 3 as 4
    int layers = 1;                  ///< RADIAL_LAYERED: a table for each level
    int finest = 0;                  ///< level of the first table
    bool step = false;               ///< look-ups take the exact last step

    std::size_t bytes() const;
    /// Optical depth at which a column of a uniform fog ends. T = 9e-4 behind 7, below half of what
    /// can be seen; with the exact last step that would be what errs most, so T = 2e-6.
    double stop() const { return step ? 13 : 7; }
    bool operator==(const RadialShape&) const = default;
};
/// `sharing` views of one eye, with as many times the columns where memory and a context's
/// `largest` texture allow.
RadialShape radial_shape(const FogFacts& fog, const Method& method, int sharing = 1,
                         int largest = 0);

/// What the picture needs: the azimuths in view and the least angle that matters.
struct RadialView {
    bool full = true;             ///< zenith or nadir is in view: every azimuth
    Eigen::Vector2d axis{0, -1};  ///< horizontal unit vector (x, z) in the middle of the view
    double first = 0, last = 0;   ///< radians from the axis, unless full
    double pixel = 0;             ///< angle of a pixel, radians; 0: as fine as the fog needs
    int level_pixels = 0;         ///< pixel columns if azimuths are tangents along them, else 0

    bool operator==(const RadialView&) const = default;
};
RadialView radial_view(const CameraMatrices& matrices, const Camera& camera, int width, int height);
/// What several views of one eye need together.
RadialView radial_union(const std::vector<RadialView>& views);

/// The table for rays from `eye`, in repeated fog no longer than `limit` metres. Columns keep to
/// the fog's part of the view, rows to its distances.
shader::RadialBlock radial_block(const FogFacts& fog, const Eigen::Vector3d& eye,
                                 const RadialView& view, double seconds, double limit,
                                 const RadialShape& shape);

}  // namespace wavefog
