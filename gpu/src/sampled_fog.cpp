#include "sampled_fog.h"

#include <algorithm>

#include "wavefog/gpu/uniforms.h"

namespace wavefog {
namespace {

// Texture units of the samplers of fog_reduce_depth.frag and fog_upsample.frag.
constexpr UnitOf kSamplers[] = {
    {"scene_depth", 0}, {"scene_colour", 1}, {"reduced_tau", 2}, {"reduced_depth", 3}};

// FOG_UPSAMPLE of fog_upsample.frag.
int upsample_number(const FogSampling& sampling) {
    if (sampling.vertices) return 0;
    return sampling.upsample == FogSampling::Upsample::average ? 1 : 2;
}

/// The uniforms that both shaders have; the program is in use.
void set_depths(const Gl& gl, const Program& program, const Camera& camera,
                const FrameTarget& frame, int width, int height) {
    const auto matrices = camera_matrices(camera, frame.width, frame.height);
    const double a = matrices.projection(2, 2), b = matrices.projection(2, 3);
    const bool perspective = camera.projection == Camera::Projection::perspective;
    set_uniform(gl, program.name(), "nearness_at",
                perspective ? Eigen::Vector3d(a / b, (1 + a) / b, 1)
                            : Eigen::Vector3d(b / a, (b - 1) / a, 0));
    set_uniform(gl, program.name(), "sky_depth", matrices.sky_depth);
    set_uniform(gl, program.name(), "reduced_pixel",
                Eigen::Vector2d(double(frame.width) / width, double(frame.height) / height));
}

}  // namespace

SampledFog::SampledFog(const Gl& gl, const FogSampling& sampling, bool coloured,
                       const Eigen::Vector3d& fog_colour)
    : gl_(&gl),
      sampling_(sampling),
      coloured_(coloured),
      fog_colour_(fog_colour),
      vertices_(make_vertex_array(gl)) {}

Result<SampledFog> SampledFog::create(const Gl& gl, const FogSampling& sampling, bool coloured,
                                      const Eigen::Vector3d& fog_colour) {
    SampledFog fog(gl, sampling, coloured, fog_colour);
    const auto build = [&](Program& program, const char* file, std::vector<std::string> defines) {
        auto built = build_program(gl, "post_fullscreen.vert", file, defines);
        if (built) {
            connect_inputs(gl, *built, kSamplers, {});
            program = std::move(*built);
        }
        return built.map([](const Program&) {});
    };
    if (!sampling.vertices)
        if (auto ok = build(fog.reduce_, "fog_reduce_depth.frag",
                            sampling.upsample == FogSampling::Upsample::average
                                ? std::vector<std::string>{"FOG_AVERAGE"}
                                : std::vector<std::string>{});
            !ok)
            return tl::unexpected(ok.error());
    std::vector<std::string> defines = {"FOG_UPSAMPLE " +
                                        std::to_string(upsample_number(sampling))};
    if (coloured) defines.push_back("FOG_CHANNELS");
    if (auto ok = build(fog.colour_, "fog_upsample.frag", defines); !ok)
        return tl::unexpected(ok.error());
    defines.push_back("FOG_OUTPUT_TAU");
    if (auto ok = build(fog.optical_depth_, "fog_upsample.frag", defines); !ok)
        return tl::unexpected(ok.error());
    return fog;
}

bool SampledFog::applies(int width, int height) const {
    return sampling_.vertices || sampling_.width < width || sampling_.height < height;
}

FogView SampledFog::view(const FogView& frame) const {
    FogView reduced = frame;
    if (sampling_.vertices) return reduced;
    reduced.width = std::min(sampling_.width, frame.width);
    reduced.height = std::min(sampling_.height, frame.height);
    // The picture keeps its shape, so that its pixels change theirs.
    reduced.camera.pixel_aspect *=
        double(frame.width) / reduced.width * reduced.height / frame.height;
    return reduced;
}

void SampledFog::make_targets(int width, int height) {
    if (width == width_ && height == height_) return;
    const Gl& gl = *gl_;
    width_ = width;
    height_ = height;
    tau_ = make_texture_2d(gl, coloured_ ? GL_RGBA32F : GL_R32F, width, height,
                           coloured_ ? GL_RGBA : GL_RED, GL_FLOAT, nullptr);
    if (sampling_.vertices) {
        depth_ = make_texture_2d(gl, GL_DEPTH_COMPONENT32F, width, height, GL_DEPTH_COMPONENT,
                                 GL_FLOAT, nullptr);
    } else {
        gl.BindTexture(GL_TEXTURE_2D, tau_.name());
        gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
        reduced_.width = width;
        reduced_.height = height;
        reduced_.depth = make_texture_2d(gl, GL_R32F, width, height, GL_RED, GL_FLOAT, nullptr);
        if (auto made = make_framebuffer(gl, reduced_.depth.name()))
            reduced_.framebuffer = *std::move(made);
    }
    if (auto made = make_framebuffer(gl, tau_.name(), depth_.name()))
        tau_framebuffer_ = *std::move(made);
}

void SampledFog::draw_full_screen(const Program& program) const {
    const Gl& gl = *gl_;
    gl.Disable(GL_DEPTH_TEST);
    gl.Disable(GL_BLEND);
    gl.BindVertexArray(vertices_.name());
    gl.UseProgram(program.name());
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    gl.BindVertexArray(0);
    gl.UseProgram(0);
}

const FrameTarget& SampledFog::begin(const FrameTarget& frame, const Camera& camera) {
    const Gl& gl = *gl_;
    const FogView drawn = view({camera, frame.width, frame.height});
    make_targets(drawn.width, drawn.height);
    if (sampling_.vertices) return frame;
    gl.BindFramebuffer(GL_FRAMEBUFFER, reduced_.framebuffer.name());
    gl.Viewport(0, 0, reduced_.width, reduced_.height);
    gl.ActiveTexture(GL_TEXTURE0);
    gl.BindTexture(GL_TEXTURE_2D, frame.depth.name());
    gl.UseProgram(reduce_.name());
    set_depths(gl, reduce_, camera, frame, width_, height_);
    draw_full_screen(reduce_);
    gl.BindTexture(GL_TEXTURE_2D, 0);
    return reduced_;
}

void SampledFog::finish(const FrameTarget& frame, const Camera& camera, GLuint output,
                        bool colour) const {
    const Gl& gl = *gl_;
    const Program& program = colour ? colour_ : optical_depth_;
    const GLuint textures[] = {frame.depth.name(), frame.colour.name(), tau_.name(),
                               reduced_.depth.name()};
    const auto bind = [&](GLuint unit, GLuint texture) {
        gl.ActiveTexture(GL_TEXTURE0 + unit);
        gl.BindTexture(GL_TEXTURE_2D, texture);
    };
    gl.BindFramebuffer(GL_FRAMEBUFFER, output);
    gl.Viewport(0, 0, frame.width, frame.height);
    for (GLuint unit = 4; unit-- > 0;) bind(unit, textures[unit]);
    gl.UseProgram(program.name());
    set_depths(gl, program, camera, frame, width_, height_);
    set_uniform(gl, program.name(), "fog_colour", fog_colour_);
    draw_full_screen(program);
    for (GLuint unit = 4; unit-- > 0;) bind(unit, 0);
}

std::size_t SampledFog::bytes() const {
    const std::size_t floats = (coloured_ ? 4 : 1) + 1;
    return floats * sizeof(float) * static_cast<std::size_t>(width_) *
           static_cast<std::size_t>(height_);
}

Result<VertexPrograms> build_vertex_programs(const Gl& gl, std::vector<std::string> defines,
                                             std::span<const UnitOf> units,
                                             std::span<const BindingOf> blocks) {
    auto terrain = build_program(gl, "fog_vertex.vert", "fog_vertex.frag", defines);
    if (!terrain) return tl::unexpected(terrain.error());
    defines.push_back("SCENE_MESH");
    auto meshes = build_program(gl, "fog_vertex.vert", "fog_vertex.frag", defines);
    if (!meshes) return tl::unexpected(meshes.error());
    connect_inputs(gl, *terrain, units, blocks);
    connect_inputs(gl, *meshes, units, blocks);
    return VertexPrograms{*std::move(terrain), *std::move(meshes)};
}

}  // namespace wavefog
