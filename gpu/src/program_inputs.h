// Units of samplers and images, bindings of uniform blocks: what every pass tells its programs.
#pragma once

#include <span>

#include "wavefog/gpu/objects.h"

namespace wavefog {

/// A sampler or image uniform and its unit.
struct UnitOf {
    const char* name;
    GLint unit;
};
/// A uniform block and its binding point.
struct BindingOf {
    const char* name;
    GLuint binding;
};

/// Sets those that the program has; the driver drops what a program does not read. Leaves no
/// program in use.
void connect_inputs(const Gl& gl, const Program& program, std::span<const UnitOf> units,
                    std::span<const BindingOf> blocks);

/// Replaces the buffer's content by `block`, at a binding point of uniform blocks.
template <class Block>
void upload_uniforms(const Gl& gl, const Buffer& buffer, GLuint binding, const Block& block) {
    gl.BindBuffer(GL_UNIFORM_BUFFER, buffer.name());
    gl.BufferData(GL_UNIFORM_BUFFER, sizeof(Block), &block, GL_DYNAMIC_DRAW);
    gl.BindBufferBase(GL_UNIFORM_BUFFER, binding, buffer.name());
}

}  // namespace wavefog
