// The fog post-process: scene colour + depth in, fogged colour or optical depth out.
#pragma once

#include <memory>
#include <vector>

#include "wavefog/fogmap/particles.h"
#include "wavefog/fogmap/scene.h"
#include "wavefog/gpu/frame.h"

namespace wavefog {

/// Textures of one fog on the GPU.
class FogTextures {
  public:
    static Result<FogTextures> create(const Gl& gl, const Fog& fog);
    FogTextures(FogTextures&&) noexcept;
    FogTextures& operator=(FogTextures&&) noexcept;
    ~FogTextures();
    std::size_t bytes() const;  ///< held on the GPU

    /// Takes the map of `fog`, which differs from create()'s in its coefficients alone (a data
    /// error otherwise). Every pass that draws it needs fogs_changed() afterwards.
    Result<void> update(const Gl& gl, const Fog& fog);

    struct Impl;  ///< of the library

  private:
    friend class FogPass;
    explicit FogTextures(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

struct ModelTables;

/// A camera and the size of its picture, pixels.
struct FogView {
    Camera camera;
    int width = 0, height = 0;
};

/// Draws one or more fogs over a frame with one method. MethodKind::reference is not a GPU method;
/// froxel is the volume that engines ship, without their temporal filter (a still frame). radial
/// fills its table when eye, view, fog or size changed; an orthographic camera, whose rays do not
/// share the eye, gets exact instead.
///
/// Method::sampling makes any of them but froxel cheaper: fog in the pixels of a reduced picture,
/// interpolated, or at vertices (not radial, and not particles, which are listed by pixels).
class FogPass {
  public:
    /// Compiles the programs that `method` needs for these fogs (they stay the caller's). `models`
    /// and particles are drawn alike whatever the method; `particles`: the different channels of
    /// those to come (channels_of(their sources)), none without particles. `scene` has the vertices
    /// that a method
    /// "@vertices" needs, and drew the frames; it must outlive the pass.
    static Result<FogPass> create(const Gl& gl, std::vector<const FogTextures*> fogs,
                                  const Method& method, const Eigen::Vector3d& fog_colour,
                                  std::vector<FogModel> models = {},
                                  const std::vector<Channels>& particles = {},
                                  const SceneRenderer* scene = nullptr);
    FogPass(FogPass&&) noexcept;
    FogPass& operator=(FogPass&&) noexcept;
    ~FogPass();

    /// Replaces what formulas give, such as by where the wind has taken it. A data error as from
    /// create(); a usage error if the pass was made without formulas and particles.
    Result<void> set_models(std::vector<FogModel> models);
    /// Particles to draw from now on, in a pass made for their channels (else a usage error).
    Result<void> set_particles(std::vector<Particle> particles);
    /// The maps have new coefficients (FogTextures::update).
    Result<void> fogs_changed();

    /// L = T L_scene + (1 - T) L_fog (paper 004, eq. 4) into `output` (RGBA16F or RGBA32F colour).
    void draw_colour(const FrameTarget& frame, const Camera& camera, GLuint output_framebuffer,
                     double seconds = 0);
    /// Whether some fog is not seen by all colours alike (Channels).
    bool coloured() const;

    /// The sum of the fogs' optical depths into a R32F target, or if coloured() those of red, green
    /// and blue into an RGBA32F one.
    void draw_optical_depth(const FrameTarget& frame, const Camera& camera,
                            GLuint output_framebuffer, double seconds = 0);

    /// Which pictures will be drawn in turns, for the tables of method radial (other methods keep
    /// nothing): views from one eye (a cube's faces, a split screen, tiles) share a table of all
    /// their azimuths, filled once; each further eye (stereo) has a table, kept while it rests.
    /// Call it again when a camera changes, the eyes in the same order; eyes that stay keep their
    /// tables. A camera that is not among the views, such as any before the first call, fills the
    /// first table for itself. A data error if the context refuses the memory, at most 16 MiB a
    /// table.
    Result<void> set_views(const std::vector<FogView>& views);

    /// How often tables were filled so far, for tests and measurements.
    std::size_t table_fills() const;

    /// Drops what was kept from the frame before (the tables of method radial), as a moved eye
    /// does.
    void forget();

    /// Textures on the GPU that this method reads: of its fogs, and its own.
    std::size_t bytes() const;

  private:
    struct Impl;
    explicit FogPass(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// The fog shader compiled as C++ (the same GLSL text through GLM), in float32, for one fog: what
/// `probe` prints and what the CPU tests check. Not for reference and froxel. Method radial builds
/// its table around each new O, every azimuth of it, and keeps the last one: ask for rays of one
/// eye together.
class ShaderOnCpu {
  public:
    /// The fog stands where its wind has taken it after `seconds`.
    static Result<ShaderOnCpu> create(const Fog& fog, const Method& method, double seconds = 0);
    ShaderOnCpu(ShaderOnCpu&&) noexcept;
    ShaderOnCpu& operator=(ShaderOnCpu&&) noexcept;
    ~ShaderOnCpu();
    double optical_depth(const Eigen::Vector3d& o, const Eigen::Vector3d& p) const;

  private:
    struct Impl;
    explicit ShaderOnCpu(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// The same for fogs given by formulas that the colours see alike.
class ModelsOnCpu {
  public:
    /// A data error if a model is invalid or there are more parts than the shader holds.
    static Result<ModelsOnCpu> create(std::vector<FogModel> models);
    double optical_depth(const Eigen::Vector3d& o, const Eigen::Vector3d& p) const;

  private:
    explicit ModelsOnCpu(std::vector<FogModel> models);
    std::vector<FogModel> models_;
    std::shared_ptr<const ModelTables> tables_;
};

/// The same for particles that the colours see alike.
class ParticlesOnCpu {
  public:
    explicit ParticlesOnCpu(std::vector<Particle> particles);
    double optical_depth(const Eigen::Vector3d& o, const Eigen::Vector3d& p) const;

  private:
    std::vector<Particle> particles_;
    std::vector<int> all_;  ///< their indices
};

}  // namespace wavefog
