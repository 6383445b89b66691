// Method radial: the table on the GPU (shaders/fog_radial.glsl).
#pragma once

#include "radial_fill.h"

namespace wavefog {

/// One fog's table around one eye, kept until eye, view or fog change.
class RadialTable {
  public:
    /// `fill` makes and fills it, and must be its fog's.
    static Result<RadialTable> create(const Gl& gl, const RadialFill& fill,
                                      const RadialShape& shape, const Method& method);

    /// Fills the table if it is not this one already; tells whether it did.
    bool update(RadialFill& fill, const shader::FogBlock& fog, const shader::RadialBlock& radial,
                GLuint cells);
    /// The next update() fills the table in any case.
    void forget() { filled_ = false; }

    GLuint texture() const { return table_.name(); }
    const shader::RadialBlock& block() const { return radial_; }
    const RadialShape& shape() const { return shape_; }

  private:
    RadialShape shape_;
    Texture table_;
    bool filled_ = false;
    shader::FogBlock fog_{};
    shader::RadialBlock radial_{};
};

}  // namespace wavefog
