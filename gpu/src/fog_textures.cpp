#include "fog_textures.h"

#include <fmt/format.h>

namespace wavefog {

FogTextures::FogTextures(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FogTextures::FogTextures(FogTextures&&) noexcept = default;
FogTextures& FogTextures::operator=(FogTextures&&) noexcept = default;
FogTextures::~FogTextures() = default;

std::size_t FogTextures::bytes() const {
    return impl_->bytes;
}

Result<FogTextures> FogTextures::create(const Gl& gl, const Fog& fog) {
    if (auto drawable = check_drawable(fog); !drawable) return tl::unexpected(drawable.error());
    const auto pyramid = approximations(fog.decomposition);
    const CellAtlas atlas = build_cell_atlas(pyramid);
    GLint largest = 0;
    gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    if (atlas.width > largest || atlas.height > largest)
        return data_error(fmt::format(
            "fog: a map of {}x{} needs a texture of {}x{}, this context allows {}; use a smaller "
            "map "
            "or a lower degree",
            fog.decomposition.width, fog.decomposition.height, atlas.width, atlas.height, largest));

    auto impl = std::make_unique<Impl>();
    impl->facts = fog_facts(fog, atlas);
    impl->decomposition = fog.decomposition;
    const bool single = atlas.channels == 1;
    impl->cells = make_texture_2d(gl, single ? GL_R32F : GL_RGBA32F, atlas.width, atlas.height,
                                  single ? GL_RED : GL_RGBA, GL_FLOAT, atlas.texels.data());
    const Grid<float> map = pyramid.levels.back().values / static_cast<float>(atlas.density_scale);
    impl->map = make_texture_2d(gl, GL_R32F, impl->facts.width, impl->facts.height, GL_RED,
                                GL_FLOAT, map.data());
    gl.BindTexture(GL_TEXTURE_2D, impl->map.name());
    const GLint wrap =
        fog.decomposition.boundary == Boundary::repeat ? GL_REPEAT : GL_CLAMP_TO_BORDER;
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrap);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrap);
    const GLint filter = fog.degree() == 0 ? GL_NEAREST : GL_LINEAR;
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
    gl.BindTexture(GL_TEXTURE_2D, 0);
    impl->bytes = (atlas.texels.size() + static_cast<std::size_t>(map.size())) * sizeof(float);
    if (const GLenum error = gl.GetError(); error != GL_NO_ERROR)
        return data_error(
            fmt::format("fog: the context refused {} bytes of textures (GL error 0x{:x}); "
                        "use a smaller map",
                        impl->bytes, error));
    return FogTextures(std::move(impl));
}

}  // namespace wavefog
