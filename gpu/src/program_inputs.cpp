#include "program_inputs.h"

namespace wavefog {

void connect_inputs(const Gl& gl, const Program& program, std::span<const UnitOf> units,
                    std::span<const BindingOf> blocks) {
    const GLuint name = program.name();
    gl.UseProgram(name);
    for (const auto& input : units)
        if (const GLint at = gl.GetUniformLocation(name, input.name); at >= 0)
            gl.Uniform1i(at, input.unit);
    gl.UseProgram(0);
    for (const auto& block : blocks)
        if (const GLuint index = gl.GetUniformBlockIndex(name, block.name);
            index != GL_INVALID_INDEX)
            gl.UniformBlockBinding(name, index, block.binding);
}

}  // namespace wavefog
