// Method radial: the table on the GPU (shaders/fog_radial.glsl).
#pragma once

#include "radial_block.h"

namespace wavefog {

/// One fog's table around the eye, filled by a compute shader and kept until eye, view or fog
/// change.
class RadialTable {
  public:
    static Result<RadialTable> create(const Gl& gl, const FogFacts& fog, const Method& method);

    /// Fills the table if it is not this one already. `fog_uniforms` holds FogBlock.
    void update(const shader::FogBlock& fog, const shader::RadialBlock& radial, GLuint cells);
    /// The next update() fills the table in any case.
    void forget() { filled_ = false; }

    GLuint texture() const { return table_.name(); }
    GLuint uniforms() const { return radial_uniforms_.name(); }
    const RadialShape& shape() const { return shape_; }

  private:
    explicit RadialTable(const Gl& gl) : gl_(&gl) {}

    const Gl* gl_;
    RadialShape shape_;
    Texture table_;
    Program fill_;
    Buffer fog_uniforms_, radial_uniforms_;
    bool filled_ = false;
    shader::FogBlock fog_{};
    shader::RadialBlock radial_{};
};

}  // namespace wavefog
