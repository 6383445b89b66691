#include "wavefog/gpu/objects.h"

#include <fmt/format.h>

namespace wavefog {

namespace detail {
void delete_texture(const Gl& gl, GLuint name) {
    gl.DeleteTextures(1, &name);
}
void delete_buffer(const Gl& gl, GLuint name) {
    gl.DeleteBuffers(1, &name);
}
void delete_framebuffer(const Gl& gl, GLuint name) {
    gl.DeleteFramebuffers(1, &name);
}
void delete_vertex_array(const Gl& gl, GLuint name) {
    gl.DeleteVertexArrays(1, &name);
}
void delete_program(const Gl& gl, GLuint name) {
    gl.DeleteProgram(name);
}
void delete_query(const Gl& gl, GLuint name) {
    gl.DeleteQueries(1, &name);
}
}  // namespace detail

Texture make_texture_2d(const Gl& gl, GLenum internal_format, int width, int height, GLenum format,
                        GLenum type, const void* data) {
    GLuint name = 0;
    gl.GenTextures(1, &name);
    Texture texture(gl, name);
    gl.BindTexture(GL_TEXTURE_2D, name);
    gl.TexStorage2D(GL_TEXTURE_2D, 1, internal_format, width, height);
    if (data) {
        gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
        gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, width, height, format, type, data);
    }
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
    return texture;
}

Buffer make_buffer(const Gl& gl, GLenum target, std::size_t bytes, const void* data, GLenum usage) {
    GLuint name = 0;
    gl.GenBuffers(1, &name);
    Buffer buffer(gl, name);
    gl.BindBuffer(target, name);
    gl.BufferData(target, static_cast<GLsizeiptr>(bytes), data, usage);
    return buffer;
}

VertexArray make_vertex_array(const Gl& gl) {
    GLuint name = 0;
    gl.GenVertexArrays(1, &name);
    return {gl, name};
}

Query make_query(const Gl& gl) {
    GLuint name = 0;
    gl.GenQueries(1, &name);
    return {gl, name};
}

Result<Framebuffer> make_framebuffer(const Gl& gl, GLuint colour, GLuint depth) {
    GLuint name = 0;
    gl.GenFramebuffers(1, &name);
    Framebuffer framebuffer(gl, name);
    gl.BindFramebuffer(GL_FRAMEBUFFER, name);
    if (colour != 0)
        gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, colour, 0);
    else
        gl.DrawBuffer(GL_NONE);
    if (depth != 0)
        gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth, 0);
    const GLenum status = gl.CheckFramebufferStatus(GL_FRAMEBUFFER);
    gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
    if (status != GL_FRAMEBUFFER_COMPLETE)
        return data_error(fmt::format(
            "OpenGL: framebuffer is incomplete (status 0x{:04x}); the driver lacks its formats",
            status));
    return framebuffer;
}

}  // namespace wavefog
