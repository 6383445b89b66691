// Which particles each tile of the screen sees: lists made on the CPU for a camera, as textures.
#pragma once

#include <vector>

#include "wavefog/fogmap/particles.h"
#include "wavefog/gpu/frame.h"

namespace wavefog {

/// Lists of particles, tile by tile, tiles by rows from the lowest.
struct ParticleTiles {
    int side = 0;  ///< of a tile, pixels: 16, or more where lists would be too long
    int across = 0, up = 0;
    std::vector<int> first;    ///< entry of `particles` at which a tile's begin; across * up + 1
    std::vector<int> entries;  ///< indices of particles
};

/// Every particle is in all tiles that it dims a ray of, and in few others.
ParticleTiles make_particle_tiles(const std::vector<Particle>& particles, const Camera& camera,
                                  const CameraMatrices& matrices, int width, int height);

/// The texture particle_list of these entries (indices of `particles`): rows of kParticleListWidth
/// RGBA texels, two an entry.
inline constexpr int kParticleListWidth = 2048;  // PARTICLE_LIST_WIDTH of fog_particles.glsl
std::vector<float> particle_list(const std::vector<Particle>& particles,
                                 const std::vector<int>& entries, const Eigen::Vector3d& eye);

class ParticleTextures {
  public:
    explicit ParticleTextures(const Gl& gl) : gl_(&gl) {}
    void set(std::vector<Particle> particles) { particles_ = std::move(particles); }
    /// Returns the side of a tile.
    int upload(const Camera& camera, const CameraMatrices& matrices, int width, int height);
    GLuint tiles() const { return tiles_.name(); }
    GLuint list() const { return list_.name(); }

  private:
    const Gl* gl_;
    std::vector<Particle> particles_;
    Texture tiles_, list_;
    int across_ = 0, up_ = 0, rows_ = 0;
};

}  // namespace wavefog
