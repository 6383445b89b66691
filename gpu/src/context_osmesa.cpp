// OSMesa: Mesa's off-screen interface, llvmpipe in this process. Upstream Mesa has dropped it, so
// nothing outside this file knows of it, and what is needed of GL/osmesa.h (which brings GL/gl.h, a
// rival of GL/glcorearb.h) is declared here.
#include <array>
#include <cstdint>

#include "context_kinds.h"

namespace wavefog {

namespace {

using Handle = struct osmesa_context*;

struct Osmesa {
    Handle (*create)(const int* attributes, Handle share) = nullptr;
    void (*destroy)(Handle) = nullptr;
    GLboolean (*make_current)(Handle, void* buffer, GLenum type, GLsizei width,
                              GLsizei height) = nullptr;
    void (*(*get_proc_address)(const char* name))() = nullptr;
};

// Attributes of OSMesaCreateContextAttribs, from GL/osmesa.h.
enum : int {
    osmesa_format = 0x22,
    osmesa_depth_bits = 0x30,
    osmesa_stencil_bits = 0x31,
    osmesa_accum_bits = 0x32,
    osmesa_profile = 0x33,
    osmesa_core_profile = 0x34,
    osmesa_context_major_version = 0x36,
    osmesa_context_minor_version = 0x37,
};

class OsmesaContext final : public LibraryContext {
  public:
    OsmesaContext(const Osmesa& api, Handle handle)
        : LibraryContext([get = api.get_proc_address](const char* name) {
              return reinterpret_cast<void*>(get(name));
          }),
          api_(api),
          handle_(handle) {}
    ~OsmesaContext() override { api_.destroy(handle_); }
    std::string name() const override { return "osmesa"; }

    Result<void> make_current() override {
        // Pictures are drawn into framebuffer objects; this default buffer is only a formality.
        if (!api_.make_current(handle_, buffer_.data(), GL_UNSIGNED_BYTE, size, size))
            return data_error("osmesa: OSMesaMakeCurrent failed");
        return {};
    }

  private:
    static constexpr int size = 16;
    Osmesa api_;
    Handle handle_;
    std::array<std::uint8_t, std::size_t{4} * size * size> buffer_{};
};

}  // namespace

Result<std::unique_ptr<Context>> create_osmesa_context() {
    const DynamicLibrary library("libOSMesa.so.8");
    if (!library)
        return data_error("osmesa: " + library.error() +
                          "; install libosmesa6 or choose the egl context");
    Osmesa api;
    if (!library.load(api.create, "OSMesaCreateContextAttribs") ||
        !library.load(api.destroy, "OSMesaDestroyContext") ||
        !library.load(api.make_current, "OSMesaMakeCurrent") ||
        !library.load(api.get_proc_address, "OSMesaGetProcAddress"))
        return data_error(
            "osmesa: libOSMesa.so.8 lacks a function; it is too old, install Mesa 13+");

    static constexpr int attributes[] = {
        // clang-format off
        osmesa_format, GL_RGBA,
        osmesa_depth_bits, 0,
        osmesa_stencil_bits, 0,
        osmesa_accum_bits, 0,
        osmesa_profile, osmesa_core_profile,
        osmesa_context_major_version, 4,
        osmesa_context_minor_version, 5,
        0,
        // clang-format on
    };
    Handle handle = api.create(attributes, nullptr);
    if (!handle) return data_error("osmesa: no OpenGL 4.5 core context; Mesa 17 or newer has one");
    auto context = std::make_unique<OsmesaContext>(api, handle);
    if (auto current = context->make_current(); !current) return tl::unexpected(current.error());
    if (auto loaded = context->load_functions(); !loaded) return tl::unexpected(loaded.error());
    return context;
}

}  // namespace wavefog
