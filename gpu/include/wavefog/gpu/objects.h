// Move-only owners of GL objects.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "wavefog/gpu/gl.h"

namespace wavefog {

/// Owns one GL name; `Release` is called with (gl, name) on destruction.
template <void (*Release)(const Gl&, GLuint)>
class GlObject {
  public:
    GlObject() = default;
    GlObject(const Gl& gl, GLuint name) : gl_(&gl), name_(name) {}
    GlObject(GlObject&& other) noexcept
        : gl_(other.gl_), name_(std::exchange(other.name_, 0)) {}
    GlObject& operator=(GlObject&& other) noexcept {
        std::swap(gl_, other.gl_);
        std::swap(name_, other.name_);
        return *this;
    }
    ~GlObject() {
        if (name_ != 0) Release(*gl_, name_);
    }
    GLuint name() const { return name_; }
    explicit operator bool() const { return name_ != 0; }

  private:
    const Gl* gl_ = nullptr;
    GLuint name_ = 0;
};

namespace detail {
void delete_texture(const Gl&, GLuint);
void delete_buffer(const Gl&, GLuint);
void delete_framebuffer(const Gl&, GLuint);
void delete_vertex_array(const Gl&, GLuint);
void delete_program(const Gl&, GLuint);
void delete_query(const Gl&, GLuint);
}  // namespace detail

using Texture = GlObject<detail::delete_texture>;
using Buffer = GlObject<detail::delete_buffer>;
using Framebuffer = GlObject<detail::delete_framebuffer>;
using VertexArray = GlObject<detail::delete_vertex_array>;
using Program = GlObject<detail::delete_program>;
using Query = GlObject<detail::delete_query>;

/// A 2-D texture with one level. `data` may be null. Nearest filtering, clamped to the edge.
Texture make_texture_2d(const Gl& gl, GLenum internal_format, int width, int height, GLenum format,
                        GLenum type, const void* data);

/// Compiles and links. `defines` ("NAME" or "NAME VALUE") come right after "#version 450 core"; the
/// sources are the names of embedded shader files ("fog_pass.frag"), whose `#include "x.glsl"` lines
/// are resolved among the embedded files. A data error carries the driver's log with file names.
Result<Program> build_program(const Gl& gl, const std::string& vertex_file,
                              const std::string& fragment_file,
                              const std::vector<std::string>& defines = {});

/// The text of an embedded shader file, with its includes resolved; empty if there is none.
std::string shader_source(const std::string& file);

}  // namespace wavefog
