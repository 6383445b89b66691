// Fills the shader's uniform blocks from a fog, an eye and a camera, in double.
#pragma once

#include <Eigen/Core>

#include "cell_atlas.h"
#include "glsl_in_cpp.h"
#include "wavefog/fogmap/fog.h"
#include "wavefog/fogmap/scene.h"
#include "wavefog/gpu/fog_pass.h"

namespace wavefog {

/// What the uniforms need of a fog once its textures are made.
struct FogFacts {
    Rect rect;
    Profile profile;
    Wind wind;
    Channels channels = kAllChannels;
    double extinction = 1;
    int degree = 1;
    Boundary boundary = Boundary::zero;
    int width = 0, height = 0;  ///< map pixels
    int cells_x = 0, cells_z = 0;
    std::vector<glm::ivec4> levels;
    double density_scale = 1, mean_density = 0;
    bool skip = false;  ///< enough empty squares for FOG_SKIP to pay
};
/// A data error for degrees and level counts beyond the shaders'.
Result<void> check_drawable(const Fog& fog);
FogFacts fog_facts(const Fog& fog, const CellAtlas& atlas);

/// FOG_PROFILE of fog_ray.glsl.
int profile_number(const Profile& profile);

/// The share of the colour that sees least of a fog, but some; at most 1.
double least_share(const Channels& channels);
/// The walk stops at this optical depth: T below 2^-21 for every colour that sees some of the fog,
/// a quarter of the accuracy that is promised.
double stop_depth(const Channels& channels);

/// FOG_ETA_MAX of fog_ray.glsl: the exponential profile is negligible above.
inline constexpr double kEtaMax = 40;

/// Rays start near `eye` (world metres): coordinates are counted from its cell, so that float32
/// keeps its precision at any world offset. `sky_limit`: longest sky ray, metres.
shader::FogBlock fog_block(const FogFacts& fog, const Eigen::Vector3d& eye, double mu,
                           double seconds, double sky_limit);

/// Directions of a perspective camera's rays: the columns times x, y and 1, x and y twice the
/// pixel's coordinates (its middle) less the size.
Eigen::Matrix3d pixel_directions(const CameraMatrices& matrices, int width, int height);

/// Coefficients of x, y and 1 as there, in two parts for float32: products and sums of the high
/// ones do not round, those of the low ones are small.
struct SplitSum {
    Eigen::Vector3d high, low;
};
SplitSum split_sum(const Eigen::Vector3d& coefficients, int width, int height);

shader::ViewBlock view_block(const CameraMatrices& matrices, const Camera& camera, int width,
                             int height, const Eigen::Vector3d& fog_colour, int samples,
                             const Channels& channels = kAllChannels);

}  // namespace wavefog
