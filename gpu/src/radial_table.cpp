#include "radial_table.h"

#include <fmt/format.h>

#include <cstring>

#include "program_inputs.h"

namespace wavefog {
namespace {

constexpr GLuint kFogBinding = 0, kRadialBinding = 1;
constexpr GLint kCellsUnit = 0, kImage = 0;
constexpr UnitOf kInputs[] = {{"fog_cells", kCellsUnit}, {"radial_image", kImage}};
constexpr BindingOf kBlocks[] = {{"FogBlock", kFogBinding}, {"RadialBlock", kRadialBinding}};
constexpr int kGroup = 32;  // local_size_x of radial_fill.comp

struct Format {
    GLenum format;
    const char* name;
};
Format format_of(int channels) {
    if (channels == 1) return {GL_R32F, "r32f"};
    return channels == 2 ? Format{GL_RG32F, "rg32f"} : Format{GL_RGBA32F, "rgba32f"};
}

}  // namespace

Result<RadialTable> RadialTable::create(const Gl& gl, const FogFacts& fog, const Method& method) {
    RadialTable table(gl);
    table.shape_ = radial_shape(fog, method);
    const auto& shape = table.shape_;
    const Format format = format_of(shape.channels);
    const int height = shape.rows * shape.layers;
    GLint largest = 0;
    gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    if (std::max(shape.columns, height) > largest)
        return data_error(
            fmt::format("{}: this context's textures have at most {} texels a side; "
                        "use a smaller table",
                        method.name(), largest));
    std::vector<std::string> defines = {fmt::format("FOG_DEGREE {}", fog.degree),
                                        fmt::format("FOG_PROFILE {}", profile_number(fog.profile)),
                                        fmt::format("RADIAL_FORMAT {}", format.name)};
    if (fog.boundary == Boundary::repeat) defines.push_back("FOG_REPEAT");
    auto fill = build_compute_program(gl, "radial_fill.comp", defines);
    if (!fill) return tl::unexpected(fill.error());
    table.fill_ = std::move(*fill);
    connect_inputs(gl, table.fill_, kInputs, kBlocks);

    table.table_ =
        make_texture_2d(gl, format.format, shape.columns, height, GL_RED, GL_FLOAT, nullptr);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        gl.TexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    table.fog_uniforms_ =
        make_buffer(gl, GL_UNIFORM_BUFFER, sizeof(shader::FogBlock), nullptr, GL_DYNAMIC_DRAW);
    table.radial_uniforms_ =
        make_buffer(gl, GL_UNIFORM_BUFFER, sizeof(shader::RadialBlock), nullptr, GL_DYNAMIC_DRAW);
    if (const GLenum error = gl.GetError(); error != GL_NO_ERROR)
        return data_error(fmt::format(
            "{}: the context refused a table of {} bytes (GL error 0x{:x}); use a smaller one",
            method.name(), shape.bytes(), error));
    return table;
}

void RadialTable::update(const shader::FogBlock& fog, const shader::RadialBlock& radial,
                         GLuint cells) {
    // Every member of the blocks is a float or an int, without gaps.
    if (filled_ && std::memcmp(&fog, &fog_, sizeof(fog)) == 0 &&
        std::memcmp(&radial, &radial_, sizeof(radial)) == 0)
        return;
    filled_ = true;
    fog_ = fog;
    radial_ = radial;
    const Gl& gl = *gl_;
    upload_uniforms(gl, fog_uniforms_, kFogBinding, fog);
    upload_uniforms(gl, radial_uniforms_, kRadialBinding, radial);
    gl.ActiveTexture(GL_TEXTURE0 + kCellsUnit);
    gl.BindTexture(GL_TEXTURE_2D, cells);
    gl.BindImageTexture(kImage, table_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY,
                        format_of(shape_.channels).format);
    gl.UseProgram(fill_.name());
    // Stores wait for the look-ups of the frame before.
    gl.MemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    gl.DispatchCompute(static_cast<GLuint>((radial.size.x + kGroup - 1) / kGroup),
                       static_cast<GLuint>(shape_.layers), 1);
    gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    gl.BindImageTexture(kImage, 0, 0, GL_FALSE, 0, GL_READ_ONLY, GL_R32F);
}

}  // namespace wavefog
