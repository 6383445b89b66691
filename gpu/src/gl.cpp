#include "wavefog/gpu/gl.h"

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
    return gl;
}

}  // namespace wavefog
