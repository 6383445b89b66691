#include "fog_uniforms.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "wavefog/gpu/pixel_rays.h"

namespace wavefog {
namespace {

// Looking for empty squares makes every step a third dearer (llvmpipe, 64x64 linear).
constexpr double kSkipFrom = 0.3;

glm::vec4 to_vec4(const Eigen::Vector4d& v) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()),
            static_cast<float>(v.w())};
}

}  // namespace

Result<void> check_drawable(const Fog& fog) {
    if (fog.degree() > 2)
        return data_error(fmt::format(
            "fog: the shaders draw degree 0, 1 and 2, this fog has degree {}; convert it with "
            "--basis haar, linear or quadratic",
            fog.degree()));
    if (fog.decomposition.levels() >= FOG_MAX_LEVELS)
        return data_error(fmt::format("fog: {} levels, the shaders hold {}; convert with fewer",
                                      fog.decomposition.levels(), FOG_MAX_LEVELS - 1));
    return {};
}

FogFacts fog_facts(const Fog& fog, const CellAtlas& atlas) {
    const auto& d = fog.decomposition;
    FogFacts facts;
    facts.rect = fog.rect;
    facts.profile = fog.profile;
    facts.wind = fog.wind;
    facts.channels = fog.channels;
    facts.extinction = fog.extinction;
    facts.degree = fog.degree();
    facts.boundary = d.boundary;
    facts.width = d.width;
    facts.height = d.height;
    facts.cells_x = d.width + (d.boundary == Boundary::zero ? fog.degree() : 0);
    facts.cells_z = d.height + (d.boundary == Boundary::zero ? fog.degree() : 0);
    facts.levels = atlas.levels;
    facts.density_scale = atlas.density_scale;
    facts.mean_density = atlas.mean_density;
    facts.skip = atlas.skippable > kSkipFrom;
    return facts;
}

double least_share(const Channels& channels) {
    double least = 1;
    for (const double share : channels)
        if (share > 0) least = std::min(least, share);
    return least;
}

double stop_depth(const Channels& channels) {
    return 14.6 / least_share(channels);
}

int profile_number(const Profile& profile) {
    switch (profile.kind) {
        case Profile::Kind::uniform:
            return 0;
        case Profile::Kind::slab:
            return 1;
        case Profile::Kind::exponential:
            return 2;
        case Profile::Kind::linear:
            return 3;
    }
    return 0;
}

shader::FogBlock fog_block(const FogFacts& fog, const Eigen::Vector3d& eye, double mu,
                           double seconds, double limit) {
    shader::FogBlock block{};
    const double cell_x = (fog.rect.x1 - fog.rect.x0) / fog.width;
    const double cell_z = (fog.rect.z1 - fog.rect.z0) / fog.height;
    const Eigen::Vector2d moved = wind_offset(fog.wind, fog.rect, fog.boundary, seconds);
    const double u = (eye.x() - fog.rect.x0 - moved.x()) / cell_x + fog.degree / 2.0;
    const double v = (eye.z() - fog.rect.z0 - moved.y()) / cell_z + fog.degree / 2.0;
    // Beyond 2^23 cells an int would still do but a float would not count them.
    const auto base = [](double c) { return std::clamp(std::floor(c), -8388608.0, 8388608.0); };
    double eta_per_metre = 0, datum = 0;
    switch (fog.profile.kind) {
        case Profile::Kind::uniform:
            break;
        case Profile::Kind::slab:
            datum = fog.profile.bottom;
            eta_per_metre = 1 / (fog.profile.top - fog.profile.bottom);
            break;
        case Profile::Kind::exponential:
            datum = fog.profile.base;
            eta_per_metre = 1 / fog.profile.scale;
            break;
        case Profile::Kind::linear:
            datum = fog.profile.base;
            eta_per_metre = 1 / (fog.profile.top - fog.profile.base);
            break;
    }
    const int finest = static_cast<int>(fog.levels.size()) - 1;
    block.base = {static_cast<int>(base(u)), static_cast<int>(base(v)), finest, 0};
    block.eye = {static_cast<float>(u - base(u)), static_cast<float>(v - base(v)),
                 static_cast<float>((eye.y() - datum) * eta_per_metre), 0};
    block.scale = {static_cast<float>(1 / cell_x), static_cast<float>(1 / cell_z),
                   static_cast<float>(eta_per_metre),
                   static_cast<float>(fog.extinction * fog.density_scale)};
    block.limit = {static_cast<float>(stop_depth(fog.channels)),
                   static_cast<float>(fog.mean_density), static_cast<float>(limit), 0};
    block.size = {fog.cells_x, fog.cells_z, fog.width, fog.height};
    for (int l = 0; l <= finest; ++l) {
        block.level[l] = fog.levels[static_cast<std::size_t>(l)];
        const double reach = std::pow(mu, l);
        block.reach[l] = {static_cast<float>(reach), static_cast<float>(1 - reach), 0, 0};
    }
    return block;
}

Eigen::Matrix3d pixel_directions(const CameraMatrices& matrices, int width, int height) {
    const Eigen::Matrix4d from_clip = eye_from_clip(matrices);
    Eigen::Matrix3d directions;
    directions << from_clip.col(0).head<3>() / width, from_clip.col(1).head<3>() / height,
        from_clip.col(3).head<3>();
    return directions;
}

SplitSum split_sum(const Eigen::Vector3d& coefficients, int width, int height) {
    const double most = coefficients.cwiseAbs().dot(Eigen::Vector3d(width, height, 1));
    if (most == 0) return {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
    // Multiples of a step of which no sum has more than 2^24.
    const double step = std::exp2(std::ceil(std::log2(most)) - 24);
    const Eigen::Vector3d high = ((coefficients / step).array().round() * step).matrix();
    return {high, coefficients - high};
}

shader::ViewBlock view_block(const CameraMatrices& matrices, const Camera& camera, int width,
                             int height, const Eigen::Vector3d& fog_colour, int samples,
                             const Channels& channels) {
    const Eigen::Matrix4d from_clip = eye_from_clip(matrices);
    const Eigen::Vector4d at0 = from_clip.col(3), at1 = from_clip.col(3) + from_clip.col(2);
    shader::ViewBlock block{};
    block.pixel = {static_cast<float>(width), static_cast<float>(height),
                   static_cast<float>(matrices.sky_depth),
                   camera.projection == Camera::Projection::orthographic ? 1.0f : 0.0f};
    for (int i = 0; i < 2; ++i) block.depth0[i] = block.depth1[i] = to_vec4(from_clip.col(i));
    const Eigen::Matrix3d directions = pixel_directions(matrices, width, height);
    for (int axis = 0; axis < 3; ++axis) {
        const SplitSum sum = split_sum(directions.row(axis), width, height);
        for (int i = 0; i < 3; ++i) {
            block.ray_high[i][axis] = static_cast<float>(sum.high[i]);
            block.ray_low[i][axis] = static_cast<float>(sum.low[i]);
        }
    }
    block.depth0[2] = to_vec4(at0);
    block.depth1[2] = to_vec4(at1);
    const double per_depth = from_clip(3, 2);
    const auto high = [](double value) { return static_cast<double>(static_cast<float>(value)); };
    block.depth_line = to_vec4(
        {high(at0.w()), at0.w() - high(at0.w()), high(per_depth), per_depth - high(per_depth)});
    block.fog_colour = {static_cast<float>(fog_colour.x()), static_cast<float>(fog_colour.y()),
                        static_cast<float>(fog_colour.z()), 1};
    block.samples = {samples, 0, 0, 0};
    block.channels = to_vec4({channels[0], channels[1], channels[2], 0});
    return block;
}

}  // namespace wavefog
