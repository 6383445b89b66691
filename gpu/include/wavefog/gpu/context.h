// Off-screen OpenGL contexts.
#pragma once

#include <memory>
#include <string>

#include "wavefog/gpu/gl.h"

namespace wavefog {

/// A current OpenGL context with its functions. Made current on creation, on the creating thread.
/// Objects made with gl() must be destroyed before it; they keep a pointer to the table.
class Context {
  public:
    Context() = default;
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;
    virtual ~Context() = default;
    /// Makes it current again on the calling thread, after another context was.
    virtual Result<void> make_current() = 0;
    virtual GetProcAddress loader() const = 0;
    virtual std::string name() const = 0;  ///< "osmesa", "egl"
    const Gl& gl() const { return gl_; }
    /// GL_RENDERER and GL_VERSION, for provenance.
    std::string renderer() const;
    std::string version() const;

  protected:
    Gl gl_;
};

/// "osmesa" (default: 4.5 core on llvmpipe, no display, no GPU) or "egl" (headless GPU, where a
/// driver is found; hardware before software). libOSMesa and libEGL are opened at run time, so
/// neither is needed by a program that brings its own context. A usage error for other names, a
/// data error that names the missing library or driver if no context can be made.
Result<std::unique_ptr<Context>> create_context(const std::string& name = "osmesa");

}  // namespace wavefog
