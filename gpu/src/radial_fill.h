// Filling tables of method radial on the GPU (shaders/fog_radial_fill.glsl).
#pragma once

#include "radial_block.h"

namespace wavefog {

/// Fills tables of one fog: by one compute shader where the context has them, else by drawing into
/// the table and a texture of its size in turns.
class RadialFill {
  public:
    static Result<RadialFill> create(const Gl& gl, const FogFacts& fog, const RadialShape& shape);

    /// A table of zeros, filtered.
    Texture make_table(const RadialShape& shape) const;
    /// Fills a table of make_table(). Leaves framebuffer, viewport and program to the caller.
    void fill(GLuint table, const RadialShape& shape, const shader::FogBlock& fog,
              const shader::RadialBlock& radial, GLuint cells);
    /// Held on the GPU beside the tables.
    std::size_t bytes() const { return scratch_ ? scratch_shape_.bytes() : 0; }

  private:
    explicit RadialFill(const Gl& gl) : gl_(&gl) {}
    void dispatch(GLuint table, const RadialShape& shape, const shader::RadialBlock& radial);
    void draw(GLuint table, const RadialShape& shape, const shader::RadialBlock& radial);

    const Gl* gl_;
    Buffer fog_uniforms_, radial_uniforms_;
    Program compute_;          ///< or, without compute shaders:
    Program segments_, scan_;  ///< radial_segments.frag, radial_scan.frag
    GLint scan_at_ = -1;       ///< its uniform radial_scan
    Framebuffer framebuffer_;  ///< of the texture drawn into
    VertexArray vertices_;
    Texture scratch_;
    RadialShape scratch_shape_;
};

}  // namespace wavefog
