// Fog that is not computed in every pixel (FogSampling): what surrounds the fogs' own passes.
#pragma once

#include "program_inputs.h"
#include "wavefog/gpu/fog_pass.h"

namespace wavefog {

/// A reduced picture of the frame's depth, and the pass that brings the optical depth of its
/// pixels, or of vertices, to the frame.
class SampledFog {
  public:
    static Result<SampledFog> create(const Gl& gl, const FogSampling& sampling, bool coloured,
                                     const Eigen::Vector3d& fog_colour);

    /// Not where the reduced picture would be the frame itself.
    bool applies(int width, int height) const;
    /// The camera and size with which fogs are drawn, for those of a frame.
    FogView view(const FogView& frame) const;

    /// What fogs read instead of the frame: its depth reduced. With vertices the frame itself.
    const FrameTarget& begin(const FrameTarget& frame, const Camera& camera);
    /// Where they draw the sum of their optical depths after begin().
    GLuint target() const { return tau_framebuffer_.name(); }
    /// With vertices the depth texture of target(), for framebuffers that fogs draw before; else 0.
    GLuint depth() const { return depth_.name(); }
    /// Draws the frame's colour or optical depth with what target() holds.
    void finish(const FrameTarget& frame, const Camera& camera, GLuint output, bool colour) const;

    std::size_t bytes() const;  ///< of its textures

  private:
    SampledFog(const Gl& gl, const FogSampling& sampling, bool coloured,
               const Eigen::Vector3d& fog_colour);
    void make_targets(int width, int height);
    void draw_full_screen(const Program& program) const;

    const Gl* gl_;
    FogSampling sampling_;
    bool coloured_;
    Eigen::Vector3d fog_colour_;
    Program reduce_, colour_, optical_depth_;
    VertexArray vertices_;
    FrameTarget reduced_;  ///< without colour
    Texture tau_, depth_;
    Framebuffer tau_framebuffer_;
    int width_ = 0, height_ = 0;
};

/// Programs of fog_vertex.vert for SceneRenderer::draw_vertices().
struct VertexPrograms {
    Program terrain, meshes;
};
/// `defines`, `units` and `blocks` as for fog_pass.frag.
Result<VertexPrograms> build_vertex_programs(const Gl& gl, std::vector<std::string> defines,
                                             std::span<const UnitOf> units,
                                             std::span<const BindingOf> blocks);

}  // namespace wavefog
