// The kinds of off-screen context, one file each.
#pragma once

#include <dlfcn.h>

#include <string>
#include <utility>

#include "wavefog/gpu/context.h"

namespace wavefog {

Result<std::unique_ptr<Context>> create_osmesa_context();
Result<std::unique_ptr<Context>> create_egl_context();

/// A shared library opened at run time. It stays loaded to the end of the process: drivers keep
/// threads and thread-local storage that do not survive unloading.
class DynamicLibrary {
  public:
    explicit DynamicLibrary(const char* file) : handle_(dlopen(file, RTLD_NOW | RTLD_LOCAL)) {
        if (!handle_)
            if (const char* reason = dlerror()) error_ = reason;
    }
    explicit operator bool() const { return handle_ != nullptr; }
    const std::string& error() const { return error_; }
    template <class Function>
    bool load(Function& function, const char* name) const {
        function = reinterpret_cast<Function>(dlsym(handle_, name));
        return function != nullptr;
    }

  private:
    void* handle_ = nullptr;
    std::string error_;
};

/// What both kinds share: functions come from one look-up of the library's own.
class LibraryContext : public Context {
  public:
    explicit LibraryContext(GetProcAddress loader) : loader_(std::move(loader)) {}
    GetProcAddress loader() const override { return loader_; }
    /// Fills gl(). The context must be current.
    Result<void> load_functions() {
        auto gl = load_gl(loader_);
        if (!gl) return tl::unexpected(gl.error());
        gl_ = *gl;
        return {};
    }

  private:
    GetProcAddress loader_;
};

}  // namespace wavefog
