// Move-only owners of GL objects.
#pragma once

#include <cstddef>
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
    GlObject(GlObject&& other) noexcept : gl_(other.gl_), name_(std::exchange(other.name_, 0)) {}
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

Buffer make_buffer(const Gl& gl, GLenum target, std::size_t bytes, const void* data, GLenum usage);
VertexArray make_vertex_array(const Gl& gl);
Query make_query(const Gl& gl);

/// A framebuffer with one colour attachment and, if `depth` is not 0, one depth attachment. A data
/// error names the status of an incomplete one.
Result<Framebuffer> make_framebuffer(const Gl& gl, GLuint colour, GLuint depth = 0);

/// Compiles and links. `defines` ("NAME" or "NAME VALUE") come right after "#version 450 core"; the
/// sources are the names of embedded shader files ("fog_pass.frag"), whose `#include "x.glsl"`
/// lines are resolved among the embedded files. A data error carries the driver's log with file
/// names.
Result<Program> build_program(const Gl& gl, const std::string& vertex_file,
                              const std::string& fragment_file,
                              const std::vector<std::string>& defines = {});

/// The same for a compute shader.
Result<Program> build_compute_program(const Gl& gl, const std::string& compute_file,
                                      const std::vector<std::string>& defines = {});

/// The same from texts instead of embedded files; `name` stands for the text in error messages.
struct ShaderText {
    GLenum stage = 0;  ///< GL_VERTEX_SHADER, GL_FRAGMENT_SHADER, GL_COMPUTE_SHADER
    std::string name;
    std::string text;  ///< without "#version"; may include embedded files
};
Result<Program> build_program_from_text(const Gl& gl, const std::vector<ShaderText>& shaders,
                                        const std::vector<std::string>& defines = {});

/// The text of an embedded shader file, with its includes resolved (each file once, at its first
/// mention); empty if there is none.
std::string shader_source(const std::string& file);

/// Names of all embedded shader files, sorted.
std::vector<std::string> shader_files();

}  // namespace wavefog
