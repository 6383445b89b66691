// The shader's clarity of a ray through particles compiled as C++, for one ray at a time.
#include <numeric>

#include "fog_uniforms.h"
#include "particle_tiles.h"
#include "wavefog/gpu/fog_pass.h"

// What the ray's helpers offer the maps is not all used here.
#pragma GCC diagnostic ignored "-Wunused-function"

namespace wavefog {
namespace shader {
namespace {
#include "fog_particles.glsl"
}  // namespace
}  // namespace shader

ParticlesOnCpu::ParticlesOnCpu(std::vector<Particle> particles)
    : particles_(std::move(particles)), all_(particles_.size()) {
    std::iota(all_.begin(), all_.end(), 0);
}

double ParticlesOnCpu::optical_depth(const Eigen::Vector3d& o, const Eigen::Vector3d& p) const {
    // One tile that sees all of them.
    const float tile[] = {0, static_cast<float>(particles_.size())};
    const std::vector<float> list = particle_list(particles_, all_, o);
    shader::models.count_more.w = 1;
    shader::models.limit.z = static_cast<float>(stop_depth(common_channels(particles_)));
    shader::particle_tiles = {tile, 1, 1, 2};
    shader::particle_list = {list.data(), kParticleListWidth,
                             static_cast<int>(list.size() / (4 * kParticleListWidth)), 4};
    const Eigen::Vector3d path = p - o;
    const double metres = path.norm();
    const auto vec4 = [](const Eigen::Vector3f& v) { return glm::vec4(v.x(), v.y(), v.z(), 0); };
    const float single = static_cast<float>(metres);
    const Eigen::Vector3d direction = metres > 0 ? path / metres : path;
    // The middle pixel of a picture, which looks along the path. Not high = float(direction): at
    // -O2 GCC 12 takes direction - double(float(direction)) for 0 where it vectorises.
    const Eigen::Vector3d high = (direction * double(PARTICLE_DIRECTION_STEPS)).array().round() /
                                 double(PARTICLE_DIRECTION_STEPS);
    shader::view.ray_high[2] = vec4(high.cast<float>());
    shader::view.ray_low[2] = vec4((direction - high).cast<float>());
    return shader::fog_particles(glm::ivec2(0), glm::vec3(0.0f), vec4(path.cast<float>()), single,
                                 {0, 0, 1}, {single, static_cast<float>(metres - double(single))});
}

}  // namespace wavefog
