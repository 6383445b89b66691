// Setting uniforms by name from double values, and vertex attributes.
#pragma once

#include <Eigen/Core>
#include <cstddef>

#include "wavefog/gpu/gl.h"

namespace wavefog {

/// The program must be in use. A name that the program lacks (or the compiler removed) is ignored,
/// as OpenGL does. Values are rounded to float.
inline void set_uniform(const Gl& gl, GLuint program, const char* name, int value) {
    gl.Uniform1i(gl.GetUniformLocation(program, name), value);
}
inline void set_uniform(const Gl& gl, GLuint program, const char* name, double value) {
    gl.Uniform1f(gl.GetUniformLocation(program, name), static_cast<float>(value));
}
inline void set_uniform(const Gl& gl, GLuint program, const char* name, const Eigen::Vector2d& v) {
    gl.Uniform2fv(gl.GetUniformLocation(program, name), 1, v.cast<float>().eval().data());
}
inline void set_uniform(const Gl& gl, GLuint program, const char* name, const Eigen::Vector3d& v) {
    gl.Uniform3fv(gl.GetUniformLocation(program, name), 1, v.cast<float>().eval().data());
}
inline void set_uniform(const Gl& gl, GLuint program, const char* name, const Eigen::Matrix4d& m) {
    gl.UniformMatrix4fv(gl.GetUniformLocation(program, name), 1, GL_FALSE,
                        m.cast<float>().eval().data());
}

/// Enables a float attribute of the bound vertex array, read from the bound GL_ARRAY_BUFFER.
inline void float_attribute(const Gl& gl, GLuint location, GLint components, GLsizei stride,
                            std::size_t offset) {
    gl.EnableVertexAttribArray(location);
    gl.VertexAttribPointer(location, components, GL_FLOAT, GL_FALSE, stride,
                           reinterpret_cast<const void*>(offset));
}

}  // namespace wavefog
