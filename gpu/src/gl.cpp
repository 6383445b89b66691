#include "wavefog/gpu/gl.h"

#include <string_view>

namespace wavefog {

Result<Gl> load_gl(const GetProcAddress& get_proc_address) {
    if (!get_proc_address) return usage_error("OpenGL loader: no getProcAddress was given");
    Gl gl;
#define WAVEFOG_GL_LOAD(type, name)                                 \
    gl.name = reinterpret_cast<type>(get_proc_address("gl" #name)); \
    if (!gl.name)                                                   \
        return data_error("OpenGL: the context lacks gl" #name      \
                          "; wavefog needs OpenGL 4.5 core, current on this thread");
    WAVEFOG_GL_FUNCTIONS(WAVEFOG_GL_LOAD)
#undef WAVEFOG_GL_LOAD
#define WAVEFOG_GL_TRY(type, name) gl.name = reinterpret_cast<type>(get_proc_address("gl" #name));
    WAVEFOG_GL_COMPUTE_FUNCTIONS(WAVEFOG_GL_TRY)
#undef WAVEFOG_GL_TRY
    return gl;
}

bool has_compute(const Gl& gl) {
    // Some drivers hand out functions that their context cannot do.
    if (!gl.DispatchCompute || !gl.BindImageTexture || !gl.MemoryBarrier) return false;
    const auto* text = reinterpret_cast<const char*>(gl.GetString(GL_VERSION));
    const bool es = text && std::string_view(text).starts_with("OpenGL ES");
    GLint major = 0, minor = 0;
    gl.GetIntegerv(GL_MAJOR_VERSION, &major);
    gl.GetIntegerv(GL_MINOR_VERSION, &minor);
    return 10 * major + minor >= (es ? 31 : 43);
}

}  // namespace wavefog
