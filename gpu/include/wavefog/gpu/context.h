// Off-screen OpenGL contexts.
#pragma once

#include <memory>
#include <string>

#include "wavefog/gpu/gl.h"

namespace wavefog {

/// A current OpenGL context with its functions. Made current on creation, on the creating thread.
class Context {
  public:
    virtual ~Context() = default;
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
/// driver is found at run time). A usage error for other names, a data error if none can be made.
Result<std::unique_ptr<Context>> create_context(const std::string& name = "osmesa");

}  // namespace wavefog
