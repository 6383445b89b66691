// OpenGL functions, loaded through a getProcAddress that the caller supplies, so that an engine
// uses the library inside its own context.
#pragma once

#include <GL/glcorearb.h>

#include <functional>

#include "wavefog/gpu/gl_functions.h"
#include "wavefog/wavelet/result.h"

namespace wavefog {

using GetProcAddress = std::function<void*(const char*)>;

/// The table of functions that wavefog calls: gl.BindTexture(...) is glBindTexture.
struct Gl {
#define WAVEFOG_GL_MEMBER(type, name) type name = nullptr;
    WAVEFOG_GL_FUNCTIONS(WAVEFOG_GL_MEMBER)
    WAVEFOG_GL_COMPUTE_FUNCTIONS(WAVEFOG_GL_MEMBER)
#undef WAVEFOG_GL_MEMBER
};

/// A data error names the first function that the context lacks; those of compute shaders may be
/// missing.
Result<Gl> load_gl(const GetProcAddress& get_proc_address);

/// Whether the current context has compute shaders and image stores: OpenGL 4.3, OpenGL ES 3.1.
bool has_compute(const Gl& gl);

}  // namespace wavefog
