#include "model_pass.h"

#include <fmt/format.h>

#include "fog_uniforms.h"
#include "model_block.h"
#include "program_inputs.h"
#include "wavefog/gpu/pixel_rays.h"

namespace wavefog {
namespace {

constexpr GLuint kModelBinding = 0, kViewBinding = 1;
// Texture units of the samplers of fog_pass.frag that this pass reads.
constexpr UnitOf kSamplers[] = {{"scene_depth", 0},  {"scene_colour", 1},   {"previous_tau", 2},
                                {"model_tables", 3}, {"particle_tiles", 4}, {"particle_list", 5}};
constexpr BindingOf kBlocks[] = {{"ModelBlock", kModelBinding}, {"ViewBlock", kViewBinding}};

Result<Program> make_program(const Gl& gl, std::vector<std::string> defines, bool sky_only,
                             bool colour) {
    if (!colour) defines.push_back("FOG_OUTPUT_TAU");
    if (sky_only) defines.push_back("FOG_SKY_ONLY");
    auto program = build_program(gl, "post_fullscreen.vert", "fog_pass.frag", defines);
    if (program) connect_inputs(gl, *program, kSamplers, kBlocks);
    return program;
}

}  // namespace

ModelPass::ModelPass(const Gl& gl, const Channels& channels, bool after_maps, bool coloured,
                     const Eigen::Vector3d& fog_colour)
    : gl_(&gl),
      channels_(channels),
      after_maps_(after_maps),
      coloured_(coloured),
      fog_colour_(fog_colour),
      model_uniforms_(
          make_buffer(gl, GL_UNIFORM_BUFFER, sizeof(shader::ModelBlock), nullptr, GL_DYNAMIC_DRAW)),
      view_uniforms_(
          make_buffer(gl, GL_UNIFORM_BUFFER, sizeof(shader::ViewBlock), nullptr, GL_DYNAMIC_DRAW)),
      no_attributes_(make_vertex_array(gl)) {}

Result<ModelPass> ModelPass::create(const Gl& gl, ModelGroup group, bool after_maps, bool coloured,
                                    const Eigen::Vector3d& fog_colour,
                                    const SceneRenderer* vertices) {
    ModelPass pass(gl, group.channels, after_maps, coloured, fog_colour);
    pass.vertices_ = vertices;
    if (group.with_particles) pass.particles_.emplace(gl);
    pass.kinds_ = model_kinds(group.models);
    if (auto ok = pass.set_models(std::move(group.models)); !ok) return tl::unexpected(ok.error());
    if (auto ok = pass.build(); !ok) return tl::unexpected(ok.error());
    return pass;
}

Result<void> ModelPass::build() {
    // FOG_METHOD_MODELS of fog_optical_depth.glsl.
    std::vector<std::string> defines = {"FOG_METHOD 6", "FOG_DEGREE 0", "FOG_PROFILE 0",
                                        fmt::format("FOG_MODEL_KINDS {}", kinds_)};
    if (particles_) defines.push_back("FOG_PARTICLES");
    if (coloured_) defines.push_back("FOG_CHANNELS");
    if (after_maps_) defines.push_back("FOG_PREVIOUS_TAU");
    if (vertices_) {
        auto made = build_vertex_programs(*gl_, defines, kSamplers, kBlocks);
        if (!made) return tl::unexpected(made.error());
        at_vertices_ = *std::move(made);
    }
    for (auto [program, colour] : {std::pair{&colour_, true}, {&optical_depth_, false}}) {
        auto made = make_program(*gl_, defines, vertices_ != nullptr, colour);
        if (!made) return tl::unexpected(made.error());
        *program = *std::move(made);
    }
    return {};
}

Result<void> ModelPass::set_models(std::vector<FogModel> models) {
    if (auto ok = check_models(models); !ok) return ok;
    if (const int kinds = kinds_ | model_kinds(models); kinds != kinds_) {
        kinds_ = kinds;
        if (auto ok = build(); !ok) return ok;
    }
    models_ = std::move(models);
    const ModelTables made = model_tables(models_);
    tables_ = make_texture_2d(*gl_, GL_RGBA32F, made.width, made.height, GL_RGBA, GL_FLOAT,
                              made.rgba.data());
    return {};
}

Result<void> ModelPass::set_particles(std::vector<Particle> particles) {
    if (!particles_)
        return usage_error("the fog pass was made without particles; make one with them");
    particles_->set(std::move(particles));
    return {};
}

GLuint ModelPass::maps_target(const FrameTarget& frame, GLuint depth) {
    if (frame.width != width_ || frame.height != height_) {
        width_ = frame.width;
        height_ = frame.height;
        maps_ = make_texture_2d(*gl_, coloured_ ? GL_RGBA32F : GL_R32F, width_, height_,
                                coloured_ ? GL_RGBA : GL_RED, GL_FLOAT, nullptr);
        if (auto framebuffer = make_framebuffer(*gl_, maps_.name(), depth))
            maps_framebuffer_ = *std::move(framebuffer);
    }
    return maps_framebuffer_.name();
}

void ModelPass::draw(const FrameTarget& frame, const Camera& camera, GLuint output, bool colour) {
    const Gl& gl = *gl_;
    const auto matrices = camera_matrices(camera, frame.width, frame.height);
    const Eigen::Matrix3d directions = pixel_directions(matrices, frame.width, frame.height);
    const auto split = [&](const Eigen::Vector3d& normal) {
        return split_sum(directions.transpose() * normal, frame.width, frame.height);
    };
    auto block = model_block(models_, channels_, camera.eye, sky_limit(camera), split);
    if (particles_)
        block.count_more.w = particles_->upload(camera, matrices, frame.width, frame.height);
    upload_uniforms(gl, model_uniforms_, kModelBinding, block);
    upload_uniforms(
        gl, view_uniforms_, kViewBinding,
        view_block(matrices, camera, frame.width, frame.height, fog_colour_, 0, channels_));
    gl.BindFramebuffer(GL_FRAMEBUFFER, output);
    gl.Viewport(0, 0, frame.width, frame.height);
    gl.Disable(GL_DEPTH_TEST);
    gl.Disable(GL_BLEND);
    gl.BindVertexArray(no_attributes_.name());
    gl.UseProgram(colour ? colour_.name() : optical_depth_.name());
    const auto bind_texture = [&](GLuint unit, GLuint texture) {
        gl.ActiveTexture(GL_TEXTURE0 + unit);
        gl.BindTexture(GL_TEXTURE_2D, texture);
    };
    if (particles_) {
        bind_texture(5, particles_->list());
        bind_texture(4, particles_->tiles());
    }
    bind_texture(3, tables_.name());
    if (after_maps_) bind_texture(2, maps_.name());
    bind_texture(1, frame.colour.name());
    bind_texture(0, frame.depth.name());
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    if (vertices_)
        vertices_->draw_vertices(camera, frame.width, frame.height, at_vertices_.terrain.name(),
                                 at_vertices_.meshes.name());
    for (const GLuint unit : {5u, 4u, 3u, 2u, 1u, 0u}) bind_texture(unit, 0);
    gl.BindVertexArray(0);
    gl.UseProgram(0);
}

}  // namespace wavefog
