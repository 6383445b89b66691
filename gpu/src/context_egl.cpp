// EGL without a window system: a GPU where a driver is found, else Mesa's software rasteriser.
#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "context_kinds.h"

namespace wavefog {

namespace {

struct Egl {
    decltype(&eglGetProcAddress) get_proc_address = nullptr;
    decltype(&eglQueryString) query_string = nullptr;
    decltype(&eglInitialize) initialize = nullptr;
    decltype(&eglBindAPI) bind_api = nullptr;
    decltype(&eglChooseConfig) choose_config = nullptr;
    decltype(&eglCreateContext) create_context = nullptr;
    decltype(&eglDestroyContext) destroy_context = nullptr;
    decltype(&eglMakeCurrent) make_current = nullptr;
    decltype(&eglGetError) get_error = nullptr;
    // Extensions, null where the driver lacks them.
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_platform_display = nullptr;
    PFNEGLQUERYDEVICESEXTPROC query_devices = nullptr;
    PFNEGLQUERYDEVICESTRINGEXTPROC query_device_string = nullptr;
};

bool has_extension(const char* list, std::string_view name) {
    std::string_view rest = list ? list : "";
    while (!rest.empty()) {
        const std::size_t end = std::min(rest.find(' '), rest.size());
        if (rest.substr(0, end) == name) return true;
        rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    return false;
}

class EglOffscreenContext final : public LibraryContext {
  public:
    EglOffscreenContext(const Egl& api, EGLDisplay display, EGLContext handle)
        : LibraryContext([get = api.get_proc_address](const char* name) {
              return reinterpret_cast<void*>(get(name));
          }),
          api_(api),
          display_(display),
          handle_(handle) {}
    ~EglOffscreenContext() override {
        api_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        // The display stays initialised: EGL shares it among all users in the process.
        api_.destroy_context(display_, handle_);
    }
    std::string name() const override { return "egl"; }

    Result<void> make_current() override {
        if (!api_.bind_api(EGL_OPENGL_API) ||
            !api_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, handle_))
            return data_error("egl: eglMakeCurrent failed; the driver lacks surfaceless contexts");
        return {};
    }

  private:
    Egl api_;
    EGLDisplay display_;
    EGLContext handle_;
};

Result<Egl> open_egl() {
    const DynamicLibrary library("libEGL.so.1");
    if (!library)
        return data_error("egl: " + library.error() +
                          "; install libegl1 and a driver or choose the osmesa context");
    Egl api;
    if (!library.load(api.get_proc_address, "eglGetProcAddress") ||
        !library.load(api.query_string, "eglQueryString") ||
        !library.load(api.initialize, "eglInitialize") ||
        !library.load(api.bind_api, "eglBindAPI") ||
        !library.load(api.choose_config, "eglChooseConfig") ||
        !library.load(api.create_context, "eglCreateContext") ||
        !library.load(api.destroy_context, "eglDestroyContext") ||
        !library.load(api.make_current, "eglMakeCurrent") ||
        !library.load(api.get_error, "eglGetError"))
        return data_error("egl: libEGL.so.1 lacks a function of EGL 1.4; install a newer driver");

    const char* client = api.query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS);
    if (has_extension(client, "EGL_EXT_platform_base"))
        api.get_platform_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(
            api.get_proc_address("eglGetPlatformDisplayEXT"));
    if (has_extension(client, "EGL_EXT_device_base") ||
        (has_extension(client, "EGL_EXT_device_enumeration") &&
         has_extension(client, "EGL_EXT_device_query"))) {
        api.query_devices =
            reinterpret_cast<PFNEGLQUERYDEVICESEXTPROC>(api.get_proc_address("eglQueryDevicesEXT"));
        api.query_device_string = reinterpret_cast<PFNEGLQUERYDEVICESTRINGEXTPROC>(
            api.get_proc_address("eglQueryDeviceStringEXT"));
    }
    return api;
}

/// Displays to try, best first: hardware devices, the surfaceless platform, software devices.
std::vector<EGLDisplay> candidate_displays(const Egl& api) {
    std::vector<EGLDisplay> hardware, software;
    if (!api.get_platform_display) return {};
    if (api.query_devices) {
        std::array<EGLDeviceEXT, 32> devices{};
        EGLint count = 0;
        if (api.query_devices(EGLint(devices.size()), devices.data(), &count))
            for (EGLint i = 0; i < count; ++i) {
                const char* extensions =
                    api.query_device_string
                        ? api.query_device_string(devices[std::size_t(i)], EGL_EXTENSIONS)
                        : nullptr;
                const bool is_software = has_extension(extensions, "EGL_MESA_device_software");
                (is_software ? software : hardware)
                    .push_back(api.get_platform_display(EGL_PLATFORM_DEVICE_EXT,
                                                        devices[std::size_t(i)], nullptr));
            }
    }
    if (has_extension(api.query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS),
                      "EGL_MESA_platform_surfaceless"))
        hardware.push_back(
            api.get_platform_display(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr));
    hardware.insert(hardware.end(), software.begin(), software.end());
    std::erase(hardware, EGL_NO_DISPLAY);
    return hardware;
}

EGLContext try_display(const Egl& api, EGLDisplay display) {
    EGLint major = 0, minor = 0;
    if (!api.initialize(display, &major, &minor) || !api.bind_api(EGL_OPENGL_API))
        return EGL_NO_CONTEXT;
    const char* extensions = api.query_string(display, EGL_EXTENSIONS);
    if (!has_extension(extensions, "EGL_KHR_surfaceless_context") ||
        !has_extension(extensions, "EGL_KHR_create_context"))
        return EGL_NO_CONTEXT;
    EGLConfig config = EGL_NO_CONFIG_KHR;
    if (!has_extension(extensions, "EGL_KHR_no_config_context")) {
        static constexpr EGLint wanted[] = {EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_SURFACE_TYPE,
                                            EGL_PBUFFER_BIT, EGL_NONE};
        EGLint count = 0;
        if (!api.choose_config(display, wanted, &config, 1, &count) || count == 0)
            return EGL_NO_CONTEXT;
    }
    static constexpr EGLint attributes[] = {
        // clang-format off
        EGL_CONTEXT_MAJOR_VERSION, 4,
        EGL_CONTEXT_MINOR_VERSION, 5,
        EGL_CONTEXT_OPENGL_PROFILE_MASK, EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
        EGL_NONE,
        // clang-format on
    };
    return api.create_context(display, config, EGL_NO_CONTEXT, attributes);
}

}  // namespace

Result<std::unique_ptr<Context>> create_egl_context() {
    const auto api = open_egl();
    if (!api) return tl::unexpected(api.error());
    for (EGLDisplay display : candidate_displays(*api)) {
        EGLContext handle = try_display(*api, display);
        if (handle == EGL_NO_CONTEXT) continue;
        auto context = std::make_unique<EglOffscreenContext>(*api, display, handle);
        if (context->make_current() && context->load_functions()) return context;
    }
    return data_error(
        "egl: no driver gives an off-screen OpenGL 4.5 core context; install the GPU's driver "
        "(Mesa: libegl-mesa0, libgl1-mesa-dri) or choose the osmesa context");
}

}  // namespace wavefog
