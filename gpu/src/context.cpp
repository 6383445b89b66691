#include "wavefog/gpu/context.h"

#include "context_kinds.h"

namespace wavefog {

namespace {

std::string gl_string(const Gl& gl, GLenum what) {
    const GLubyte* text = gl.GetString(what);
    return text ? reinterpret_cast<const char*>(text) : "";
}

}  // namespace

std::string Context::renderer() const {
    return gl_string(gl_, GL_RENDERER);
}
std::string Context::version() const {
    return gl_string(gl_, GL_VERSION);
}

Result<std::unique_ptr<Context>> create_context(const std::string& name) {
    if (name == "osmesa") return create_osmesa_context();
    if (name == "egl") return create_egl_context();
    return usage_error("context \"" + name + "\" is unknown; choose osmesa or egl");
}

}  // namespace wavefog
