#include "radial_fill.h"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "program_inputs.h"

namespace wavefog {
namespace {

constexpr GLuint kFogBinding = 0, kRadialBinding = 1;
constexpr GLint kCellsUnit = 0, kSumsUnit = 1, kImage = 0;
constexpr UnitOf kInputs[] = {
    {"fog_cells", kCellsUnit}, {"radial_sums", kSumsUnit}, {"radial_image", kImage}};
constexpr BindingOf kBlocks[] = {{"FogBlock", kFogBinding}, {"RadialBlock", kRadialBinding}};
constexpr int kGroup = 32;  // local_size_x of radial_fill.comp
// Groups that a scan joins: 512 rows take three scans of 8 reads a texel, as many reads as nine
// scans of 2, and a third of the writes.
constexpr int kJoined = 8;

struct Format {
    GLenum stored, given;
    const char* name;
};
Format format_of(int channels) {
    if (channels == 1) return {GL_R32F, GL_RED, "r32f"};
    return channels == 2 ? Format{GL_RG32F, GL_RG, "rg32f"}
                         : Format{GL_RGBA32F, GL_RGBA, "rgba32f"};
}

}  // namespace

Result<RadialFill> RadialFill::create(const Gl& gl, const FogFacts& fog, const RadialShape& shape) {
    RadialFill fill(gl);
    std::vector<std::string> defines = {
        fmt::format("FOG_DEGREE {}", fog.degree),
        fmt::format("FOG_PROFILE {}", profile_number(fog.profile)),
        fmt::format("RADIAL_FORMAT {}", format_of(shape.channels).name),
        fmt::format("RADIAL_JOINED {}", kJoined)};
    if (fog.boundary == Boundary::repeat) defines.push_back("FOG_REPEAT");
    const auto add = [&](Program& program, Result<Program> built) -> Result<void> {
        if (!built) return tl::unexpected(built.error());
        program = std::move(*built);
        connect_inputs(gl, program, kInputs, kBlocks);
        return {};
    };
    if (has_compute(gl)) {
        auto built = add(fill.compute_, build_compute_program(gl, "radial_fill.comp", defines));
        if (!built) return tl::unexpected(built.error());
    } else {
        for (const auto& [program, file] : {std::pair(&fill.segments_, "radial_segments.frag"),
                                            std::pair(&fill.scan_, "radial_scan.frag")}) {
            auto built = add(*program, build_program(gl, "post_fullscreen.vert", file, defines));
            if (!built) return tl::unexpected(built.error());
        }
        fill.scan_at_ = gl.GetUniformLocation(fill.scan_.name(), "radial_scan");
        fill.scratch_shape_ = shape;
        fill.scratch_ = fill.make_table(shape);
        auto framebuffer = make_framebuffer(gl, fill.scratch_.name());
        if (!framebuffer) return tl::unexpected(framebuffer.error());
        fill.framebuffer_ = std::move(*framebuffer);
        fill.vertices_ = make_vertex_array(gl);
    }
    fill.fog_uniforms_ =
        make_buffer(gl, GL_UNIFORM_BUFFER, sizeof(shader::FogBlock), nullptr, GL_DYNAMIC_DRAW);
    fill.radial_uniforms_ =
        make_buffer(gl, GL_UNIFORM_BUFFER, sizeof(shader::RadialBlock), nullptr, GL_DYNAMIC_DRAW);
    return fill;
}

Texture RadialFill::make_table(const RadialShape& shape) const {
    const Format format = format_of(shape.channels);
    // The look-up's filter touches, with weight 0, texels that were never filled.
    const std::vector<float> zeros(shape.bytes() / sizeof(float));
    Texture table = make_texture_2d(*gl_, format.stored, shape.columns, shape.rows * shape.layers,
                                    format.given, GL_FLOAT, zeros.data());
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        gl_->TexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    return table;
}

void RadialFill::fill(GLuint table, const RadialShape& shape, const shader::FogBlock& fog,
                      const shader::RadialBlock& radial, GLuint cells) {
    const Gl& gl = *gl_;
    upload_uniforms(gl, fog_uniforms_, kFogBinding, fog);
    upload_uniforms(gl, radial_uniforms_, kRadialBinding, radial);
    gl.ActiveTexture(GL_TEXTURE0 + kCellsUnit);
    gl.BindTexture(GL_TEXTURE_2D, cells);
    if (compute_)
        dispatch(table, shape, radial);
    else
        draw(table, shape, radial);
}

void RadialFill::dispatch(GLuint table, const RadialShape& shape,
                          const shader::RadialBlock& radial) {
    const Gl& gl = *gl_;
    gl.BindImageTexture(kImage, table, 0, GL_FALSE, 0, GL_WRITE_ONLY,
                        format_of(shape.channels).stored);
    gl.UseProgram(compute_.name());
    // Stores wait for the look-ups of the frame before.
    gl.MemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    gl.DispatchCompute(static_cast<GLuint>((radial.size.x + kGroup - 1) / kGroup),
                       static_cast<GLuint>(shape.layers), 1);
    gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    gl.BindImageTexture(kImage, 0, 0, GL_FALSE, 0, GL_READ_ONLY, GL_R32F);
}

void RadialFill::draw(GLuint table, const RadialShape& shape, const shader::RadialBlock& radial) {
    const Gl& gl = *gl_;
    if (shape.columns > scratch_shape_.columns) {
        scratch_shape_ = shape;
        scratch_ = make_table(shape);
    }
    // Rows of further layers lie a whole layer on.
    const int height = shape.rows * (shape.layers - 1) + radial.size.y;
    gl.Viewport(0, 0, radial.size.x, height);
    gl.Disable(GL_DEPTH_TEST);
    gl.Disable(GL_BLEND);
    gl.BindVertexArray(vertices_.name());
    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer_.name());
    int scans = 1;
    for (int group = kJoined; group < radial.size.y; group *= kJoined) ++scans;
    GLuint from = 0;
    for (int step = 0; step <= scans; ++step) {
        // The last step ends in the table.
        const GLuint to = (scans - step) % 2 == 0 ? table : scratch_.name();
        gl.ActiveTexture(GL_TEXTURE0 + kSumsUnit);
        gl.BindTexture(GL_TEXTURE_2D, from);
        gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, to, 0);
        gl.UseProgram(step == 0 ? segments_.name() : scan_.name());
        if (step > 0) {
            int group = 1;
            for (int i = 1; i < step; ++i) group *= kJoined;
            gl.Uniform2i(scan_at_, group, step == scans);
        }
        gl.DrawArrays(GL_TRIANGLES, 0, 3);
        from = to;
    }
    gl.BindTexture(GL_TEXTURE_2D, 0);
    gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
    gl.BindVertexArray(0);
}

}  // namespace wavefog
