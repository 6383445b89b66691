// The pass that adds fogs given by formulas to the optical depth of the maps.
#pragma once

#include <optional>
#include <vector>

#include "particle_tiles.h"
#include "sampled_fog.h"
#include "wavefog/fogmap/models.h"
#include "wavefog/fogmap/scene.h"
#include "wavefog/gpu/frame.h"

namespace wavefog {

/// Formulas and particles that the colours see alike.
struct ModelGroup {
    Channels channels = kAllChannels;
    std::vector<FogModel> models;
    bool with_particles = false;
};

/// A group in one draw; it comes after the maps (or other groups) and blends colour once for all.
class ModelPass {
  public:
    /// A data error says which model is invalid, or what there is too much of. `after_maps`: a
    /// previous optical depth is added. `coloured`: depths of red, green and blue, of which these
    /// models have their channels. `vertices`: computed at those of the scene, else null.
    static Result<ModelPass> create(const Gl& gl, ModelGroup group, bool after_maps, bool coloured,
                                    const Eigen::Vector3d& fog_colour,
                                    const SceneRenderer* vertices);

    /// Of its models and particles.
    const Channels& channels() const { return channels_; }
    bool with_particles() const { return particles_.has_value(); }

    /// A data error as from create(). Models of a kind that was not there before cost new programs.
    Result<void> set_models(std::vector<FogModel> models);
    /// A usage error if the pass was made without.
    Result<void> set_particles(std::vector<Particle> particles);

    /// The target for the maps' optical depth (R32F, coloured RGBA32F), of the frame's size, with a
    /// depth texture or 0.
    GLuint maps_target(const FrameTarget& frame, GLuint depth);

    /// Draws colour or optical depth; what maps_target() holds is added if there are maps.
    void draw(const FrameTarget& frame, const Camera& camera, GLuint output, bool colour);

  private:
    ModelPass(const Gl& gl, const Channels& channels, bool after_maps, bool coloured,
              const Eigen::Vector3d& fog_colour);
    /// The programs, for the kinds of models in `kinds_`.
    Result<void> build();

    const Gl* gl_;
    Channels channels_;
    std::vector<FogModel> models_;
    int kinds_ = 0;  ///< MODEL_KIND_* that the programs are for
    std::optional<ParticleTextures> particles_;
    bool after_maps_, coloured_;
    Eigen::Vector3d fog_colour_;
    const SceneRenderer* vertices_ = nullptr;
    Program colour_, optical_depth_;
    VertexPrograms at_vertices_;
    Buffer model_uniforms_, view_uniforms_;
    VertexArray no_attributes_;
    Texture tables_;
    Texture maps_;
    Framebuffer maps_framebuffer_;
    int width_ = 0, height_ = 0;
};

}  // namespace wavefog
