#include "fog_textures.h"

#include <fmt/format.h>

namespace wavefog {

namespace {

/// Into textures of the right size.
void upload(const Gl& gl, const FogTextures::Impl& to, const Pyramid<float>& pyramid,
            const CellAtlas& atlas) {
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl.BindTexture(GL_TEXTURE_2D, to.cells.name());
    gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, atlas.width, atlas.height,
                     atlas.channels == 1 ? GL_RED : GL_RGBA, GL_FLOAT, atlas.texels.data());
    const Grid<float> map = pyramid.levels.back().values / static_cast<float>(atlas.density_scale);
    gl.BindTexture(GL_TEXTURE_2D, to.map.name());
    gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, to.facts.width, to.facts.height, GL_RED, GL_FLOAT,
                     map.data());
    gl.BindTexture(GL_TEXTURE_2D, 0);
}

}  // namespace

FogTextures::FogTextures(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FogTextures::FogTextures(FogTextures&&) noexcept = default;
FogTextures& FogTextures::operator=(FogTextures&&) noexcept = default;
FogTextures::~FogTextures() = default;

std::size_t FogTextures::bytes() const {
    return impl_->bytes;
}

Result<FogTextures> FogTextures::create(const Gl& gl, const Fog& fog) {
    if (auto drawable = check_drawable(fog); !drawable) return tl::unexpected(drawable.error());
    auto impl = std::make_unique<Impl>();
    impl->decomposition = fog.decomposition;
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

    impl->facts = fog_facts(fog, atlas);
    const bool single = atlas.channels == 1;
    impl->cells = make_texture_2d(gl, single ? GL_R32F : GL_RGBA32F, atlas.width, atlas.height,
                                  single ? GL_RED : GL_RGBA, GL_FLOAT, nullptr);
    impl->map = make_texture_2d(gl, GL_R32F, impl->facts.width, impl->facts.height, GL_RED,
                                GL_FLOAT, nullptr);
    const GLint wrap =
        fog.decomposition.boundary == Boundary::repeat ? GL_REPEAT : GL_CLAMP_TO_BORDER;
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, wrap);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, wrap);
    const GLint filter = fog.degree() == 0 ? GL_NEAREST : GL_LINEAR;
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
    upload(gl, *impl, pyramid, atlas);
    impl->bytes =
        (atlas.texels.size() + static_cast<std::size_t>(pyramid.levels.back().values.size())) *
        sizeof(float);
    if (const GLenum error = gl.GetError(); error != GL_NO_ERROR)
        return data_error(
            fmt::format("fog: the context refused {} bytes of textures (GL error 0x{:x}); "
                        "use a smaller map",
                        impl->bytes, error));
    return FogTextures(std::move(impl));
}

Result<void> FogTextures::update(const Gl& gl, const Fog& fog) {
    const Decomposition<float>&was = impl_->decomposition, &is = fog.decomposition;
    if (was.width != is.width || was.height != is.height || was.degree() != is.degree() ||
        was.boundary != is.boundary || was.levels() != is.levels())
        return data_error(
            "fog: the new map differs in size, basis, wrap or levels; make new textures for it");
    const auto pyramid = approximations(is);
    const CellAtlas atlas = build_cell_atlas(pyramid);
    impl_->decomposition = is;
    impl_->facts.density_scale = atlas.density_scale;
    impl_->facts.mean_density = atlas.mean_density;
    upload(gl, *impl_, pyramid, atlas);
    return {};
}

}  // namespace wavefog
