#include "wavefog/gpu/fog_pass.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <tuple>

#include "fog_textures.h"
#include "froxel_volume.h"
#include "model_pass.h"
#include "paper_data.h"
#include "program_inputs.h"
#include "radial_tables.h"
#include "sampled_fog.h"
#include "wavefog/gpu/pixel_rays.h"

namespace wavefog {
namespace {

// FOG_METHOD of fog_pass.frag.
int method_number(const Method& method, bool any_fog) {
    if (!any_fog) return 3;
    switch (method.kind) {
        case MethodKind::march:
            return 1;
        case MethodKind::homogeneous:
            return 2;
        case MethodKind::paper:
        case MethodKind::paper_scaling:
            return 4;
        case MethodKind::radial:
            return 5;
        default:
            return 0;
    }
}

// Texture units of the samplers of fog_pass.frag.
constexpr UnitOf kSamplers[] = {{"fog_cells", 0},    {"fog_map", 1},        {"scene_depth", 2},
                                {"scene_colour", 3}, {"previous_tau", 4},   {"paper_bands", 5},
                                {"paper_paths", 6},  {"paper_partials", 7}, {"radial_table", 8}};
constexpr GLint kUnits = 9;
constexpr GLuint kFogBinding = 0, kViewBinding = 1, kPaperBinding = 2, kRadialBinding = 3;
constexpr BindingOf kBlocks[] = {{"FogBlock", kFogBinding},
                                 {"ViewBlock", kViewBinding},
                                 {"PaperBlock", kPaperBinding},
                                 {"RadialBlock", kRadialBinding}};

/// What the colours see alike is drawn together: particles of these channels, and models.
std::vector<ModelGroup> groups_of(std::vector<FogModel> models,
                                  const std::vector<Channels>& particles) {
    std::vector<ModelGroup> groups;
    for (const Channels& channels : particles) groups.push_back({channels, {}, true});
    for (std::vector<FogModel>& alike : by_channels(std::move(models))) {
        const Channels channels = alike.front().channels;
        auto same = std::find_if(groups.begin(), groups.end(), [&](const ModelGroup& group) {
            return group.channels == channels;
        });
        if (same == groups.end()) same = groups.insert(same, {channels, {}, false});
        same->models = std::move(alike);
    }
    return groups;
}

struct Target {
    Texture texture;
    Framebuffer framebuffer;
};

/// Coefficients and path-integral tables of one fog for the paper's methods.
struct PaperTextures {
    Texture bands, paths, partials;
    shader::PaperBlock block;
    std::size_t bytes = 0;
};

Result<PaperTextures> make_paper_textures(const Gl& gl, const FogTextures::Impl& fog,
                                          const Method& method) {
    auto data = make_paper_data(fog.decomposition, method, fog.facts.density_scale);
    if (!data) return tl::unexpected(data.error());
    GLint largest = 0;
    gl.GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    for (const auto& [what, width, height] :
         {std::tuple{"packed coefficients", data->bands.width, data->bands.height},
          std::tuple{"path-integral table", data->table.whole.width, data->table.whole.height}})
        if (width > largest || height > largest)
            return data_error(
                fmt::format("method {}: the {} take a texture of {}x{}, this context "
                            "allows {}; use a smaller map or table",
                            method.name(), what, width, height, largest));
    const auto texture = [&](int width, int height, const std::vector<float>& rgba) {
        return make_texture_2d(gl, GL_RGBA32F, width, height, GL_RGBA, GL_FLOAT, rgba.data());
    };
    PaperTextures textures;
    textures.bands = texture(data->bands.width, data->bands.height, data->bands.rgba);
    textures.paths =
        texture(data->table.whole.width, data->table.whole.height, data->table.whole.rgba);
    textures.partials =
        texture(data->table.partial.width, data->table.partial.height, data->table.partial.rgba);
    textures.block = data->block;
    textures.bytes = data->bytes();
    return textures;
}

}  // namespace

struct FogPass::Impl {
    const Gl& gl;
    std::vector<const FogTextures*> fogs;
    Method method;
    Eigen::Vector3d fog_colour;
    // Fog i adds its optical depth to that of the fogs before it; the last one ends in the output.
    struct Programs {
        std::vector<Program> add_tau;
        Program last_colour;
        std::vector<VertexPrograms> at_vertices;  ///< one a fog if the method samples vertices
    };
    Programs programs;
    Programs orthographic;                ///< method radial: exact, where rays do not share the eye
    std::vector<PaperTextures> paper;     ///< one a fog with the paper's methods, else none
    std::optional<RadialTables> radial;   ///< with method radial
    std::optional<FroxelVolume> froxels;  ///< draws instead of all this
    std::vector<ModelPass> models;        ///< draw last; one for each set of channels
    std::vector<Channels> particles;      ///< of those to come
    bool coloured = false;
    std::optional<SampledFog> sampled;        ///< unless every pixel has its own fog
    const SceneRenderer* vertices = nullptr;  ///< of the scene, where fog is computed at them
    Buffer fog_uniforms, view_uniforms, paper_uniforms, radial_uniforms;
    VertexArray no_attributes;
    Target partial[2];  ///< optical depth of the fogs drawn so far, in turns
    int width = 0, height = 0;

    Impl(const Gl& functions, std::vector<const FogTextures*> drawn, const Method& with,
         const Eigen::Vector3d& colour)
        : gl(functions), fogs(std::move(drawn)), method(with), fog_colour(colour) {}

    Result<void> make_paper() {
        paper.clear();
        if (method.kind != MethodKind::paper && method.kind != MethodKind::paper_scaling) return {};
        for (const FogTextures* fog : fogs) {
            auto textures = make_paper_textures(gl, *fog->impl_, method);
            if (!textures) return tl::unexpected(textures.error());
            paper.push_back(std::move(*textures));
        }
        return {};
    }

    std::vector<std::string> defines_of(const Method& with, std::size_t fog) const {
        std::vector<std::string> defines = {
            fmt::format("FOG_METHOD {}", method_number(with, !fogs.empty()))};
        int degree = 0, profile = 0;
        if (!fogs.empty()) {
            const auto& facts = fogs[fog]->impl_->facts;
            degree = facts.degree;
            profile = profile_number(facts.profile);
            if (facts.boundary == Boundary::repeat) defines.push_back("FOG_REPEAT");
            if (facts.skip) defines.push_back("FOG_SKIP");
        }
        if (with.kind == MethodKind::radial && with.radial_step) defines.push_back("RADIAL_STEP");
        if (with.kind == MethodKind::paper_scaling) defines.push_back("FOG_PAPER_SCALING");
        if (radial && radial->layered(fog)) defines.push_back("RADIAL_LAYERED");
        defines.push_back(fmt::format("FOG_DEGREE {}", degree));
        defines.push_back(fmt::format("FOG_PROFILE {}", profile));
        if (coloured) defines.push_back("FOG_CHANNELS");
        if (fog > 0) defines.push_back("FOG_PREVIOUS_TAU");
        return defines;
    }

    Result<Program> build(const Method& with, std::size_t fog, bool colour) const {
        std::vector<std::string> defines = defines_of(with, fog);
        if (!colour) defines.push_back("FOG_OUTPUT_TAU");
        if (vertices) defines.push_back("FOG_SKY_ONLY");
        auto program = build_program(gl, "post_fullscreen.vert", "fog_pass.frag", defines);
        if (program) connect_inputs(gl, *program, kSamplers, kBlocks);
        return program;
    }

    Result<Programs> build_all(const Method& with) const {
        const std::size_t count = std::max<std::size_t>(fogs.size(), 1);
        Programs made;
        for (std::size_t i = 0; i < count; ++i) {
            auto program = build(with, i, false);
            if (!program) return tl::unexpected(program.error());
            made.add_tau.push_back(std::move(*program));
            if (!vertices) continue;
            auto both = build_vertex_programs(gl, defines_of(with, i), kSamplers, kBlocks);
            if (!both) return tl::unexpected(both.error());
            made.at_vertices.push_back(std::move(*both));
        }
        auto colour = build(with, count - 1, true);
        if (!colour) return tl::unexpected(colour.error());
        made.last_colour = std::move(*colour);
        return made;
    }

    void bind_texture(GLint unit, GLuint texture) const {
        gl.ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
        gl.BindTexture(GL_TEXTURE_2D, texture);
    }

    void make_partial_targets(int w, int h) {
        if (w == width && h == height) return;
        width = w;
        height = h;
        for (auto& target : partial) {
            target.texture = make_texture_2d(gl, coloured ? GL_RGBA32F : GL_R32F, w, h,
                                             coloured ? GL_RGBA : GL_RED, GL_FLOAT, nullptr);
            if (auto framebuffer = make_framebuffer(gl, target.texture.name(), vertex_depth()))
                target.framebuffer = std::move(*framebuffer);
        }
    }

    GLuint vertex_depth() const { return sampled ? sampled->depth() : 0; }

    void draw(const FrameTarget& frame, const Camera& camera, GLuint output, double seconds,
              bool colour) {
        if (!sampled || !sampled->applies(frame.width, frame.height))
            return draw_all(frame, camera, output, seconds, colour);
        const FrameTarget& reduced = sampled->begin(frame, camera);
        draw_all(reduced, sampled->view({camera, frame.width, frame.height}).camera,
                 sampled->target(), seconds, false);
        sampled->finish(frame, camera, output, colour);
    }

    void draw_all(const FrameTarget& frame, const Camera& camera, GLuint output, double seconds,
                  bool colour) {
        if (models.empty()) return draw_maps(frame, camera, output, seconds, colour);
        const auto before = [&](ModelPass& pass) {
            return pass.maps_target(frame, vertex_depth());
        };
        if (!fogs.empty()) draw_maps(frame, camera, before(models.front()), seconds, false);
        for (std::size_t i = 0; i < models.size(); ++i) {
            const bool last = i + 1 == models.size();
            models[i].draw(frame, camera, last ? output : before(models[i + 1]), last && colour);
        }
    }

    void draw_maps(const FrameTarget& frame, const Camera& camera, GLuint output, double seconds,
                   bool colour) {
        if (froxels) return froxels->draw(frame, camera, output, seconds, colour);
        const bool shared_eye = camera.projection == Camera::Projection::perspective;
        const std::vector<RadialTable>* tables =
            radial && shared_eye ? &radial->update({camera, frame.width, frame.height}, seconds)
                                 : nullptr;
        const std::size_t count = std::max<std::size_t>(fogs.size(), 1);
        if (count > 1) make_partial_targets(frame.width, frame.height);
        const auto matrices = camera_matrices(camera, frame.width, frame.height);
        gl.Viewport(0, 0, frame.width, frame.height);
        gl.Disable(GL_DEPTH_TEST);
        gl.Disable(GL_BLEND);
        gl.BindVertexArray(no_attributes.name());
        bind_texture(2, frame.depth.name());
        bind_texture(3, frame.colour.name());
        for (std::size_t i = 0; i < count; ++i) {
            const bool last = i + 1 == count;
            gl.BindFramebuffer(GL_FRAMEBUFFER, last ? output : partial[i % 2].framebuffer.name());
            const Programs& used = radial && !shared_eye ? orthographic : programs;
            gl.UseProgram(last && colour ? used.last_colour.name() : used.add_tau[i].name());
            upload_uniforms(
                gl, view_uniforms, kViewBinding,
                view_block(matrices, camera, frame.width, frame.height, fog_colour, method.samples,
                           fogs.empty() ? kAllChannels : fogs[i]->impl_->facts.channels));
            if (!fogs.empty()) {
                const auto& fog = *fogs[i]->impl_;
                upload_uniforms(
                    gl, fog_uniforms, kFogBinding,
                    fog_block(fog.facts, camera.eye, method.mu, seconds, sky_limit(camera)));
                bind_texture(0, fog.cells.name());
                bind_texture(1, fog.map.name());
            }
            if (i < paper.size()) {
                upload_uniforms(gl, paper_uniforms, kPaperBinding, paper[i].block);
                bind_texture(5, paper[i].bands.name());
                bind_texture(6, paper[i].paths.name());
                bind_texture(7, paper[i].partials.name());
            }
            if (tables) {
                upload_uniforms(gl, radial_uniforms, kRadialBinding, (*tables)[i].block());
                bind_texture(8, (*tables)[i].texture());
            }
            if (i > 0) bind_texture(4, partial[(i - 1) % 2].texture.name());
            gl.DrawArrays(GL_TRIANGLES, 0, 3);
            if (vertices) {
                const VertexPrograms& at = used.at_vertices[i];
                vertices->draw_vertices(camera, frame.width, frame.height, at.terrain.name(),
                                        at.meshes.name());
                gl.BindVertexArray(no_attributes.name());
            }
        }
        for (GLint unit = kUnits - 1; unit >= 0; --unit) bind_texture(unit, 0);
        gl.BindVertexArray(0);
        gl.UseProgram(0);
    }
};

FogPass::FogPass(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FogPass::FogPass(FogPass&&) noexcept = default;
FogPass& FogPass::operator=(FogPass&&) noexcept = default;
FogPass::~FogPass() = default;

Result<FogPass> FogPass::create(const Gl& gl, std::vector<const FogTextures*> fogs,
                                const Method& method, const Eigen::Vector3d& fog_colour,
                                std::vector<FogModel> models,
                                const std::vector<Channels>& particles,
                                const SceneRenderer* scene) {
    if (method.kind == MethodKind::reference)
        return usage_error(
            "method reference runs on the CPU (class Reference); the fog pass draws "
            "exact, radial, paper, paper-scaling, march:N, froxel:XxYxZ or homogeneous");
    auto impl = std::make_unique<Impl>(gl, std::move(fogs), method, fog_colour);
    impl->particles = particles;
    const std::vector<ModelGroup> groups = groups_of(std::move(models), particles);
    for (const ModelGroup& group : groups)
        impl->coloured = impl->coloured || group.channels != kAllChannels;
    for (const FogTextures* fog : impl->fogs)
        impl->coloured = impl->coloured || fog->impl_->facts.channels != kAllChannels;
    if (auto ok = check_sampling(method); !ok) return tl::unexpected(ok.error());
    if (method.sampling.vertices) {
        if (!particles.empty())
            return usage_error(
                fmt::format("method {}: particles are listed by pixels of the screen; use a "
                            "reduced picture such "
                            "as exact@256x256",
                            method.name()));
        if (!scene)
            return usage_error(fmt::format(
                "method {}: there are no vertices, only a picture; use a reduced one such as "
                "exact@256x256",
                method.name()));
        impl->vertices = scene;
    }
    if (!method.sampling.every_pixel()) {
        auto sampled = SampledFog::create(gl, method.sampling, impl->coloured, fog_colour);
        if (!sampled) return tl::unexpected(sampled.error());
        impl->sampled.emplace(std::move(*sampled));
    }
    for (const ModelGroup& group : groups) {
        const bool first = impl->models.empty();
        auto pass = ModelPass::create(gl, group, !impl->fogs.empty() || !first, impl->coloured,
                                      fog_colour, impl->vertices);
        if (!pass) return tl::unexpected(pass.error());
        impl->models.push_back(std::move(*pass));
    }
    if (method.kind == MethodKind::froxel && !impl->fogs.empty()) {
        std::vector<FroxelFog> maps;
        for (const FogTextures* fog : impl->fogs)
            maps.push_back({&fog->impl_->facts, fog->impl_->map.name()});
        auto volume = FroxelVolume::create(gl, std::move(maps), method, fog_colour, impl->coloured);
        if (!volume) return tl::unexpected(volume.error());
        impl->froxels.emplace(std::move(*volume));
        return FogPass(std::move(impl));
    }
    if (auto made = impl->make_paper(); !made) return tl::unexpected(made.error());
    if (method.kind == MethodKind::radial && !impl->fogs.empty()) {
        std::vector<RadialFog> maps;
        for (const FogTextures* fog : impl->fogs)
            maps.push_back({&fog->impl_->facts, fog->impl_->cells.name()});
        auto tables = RadialTables::create(gl, std::move(maps), method);
        if (!tables) return tl::unexpected(tables.error());
        impl->radial.emplace(std::move(*tables));
    }
    auto programs = impl->build_all(method);
    if (!programs) return tl::unexpected(programs.error());
    impl->programs = std::move(*programs);
    if (impl->radial) {
        Method exact = method;
        exact.kind = MethodKind::exact;
        programs = impl->build_all(exact);
        if (!programs) return tl::unexpected(programs.error());
        impl->orthographic = std::move(*programs);
    }
    impl->fog_uniforms =
        make_buffer(gl, GL_UNIFORM_BUFFER, sizeof(shader::FogBlock), nullptr, GL_DYNAMIC_DRAW);
    impl->view_uniforms =
        make_buffer(gl, GL_UNIFORM_BUFFER, sizeof(shader::ViewBlock), nullptr, GL_DYNAMIC_DRAW);
    impl->paper_uniforms =
        make_buffer(gl, GL_UNIFORM_BUFFER, sizeof(shader::PaperBlock), nullptr, GL_DYNAMIC_DRAW);
    impl->radial_uniforms =
        make_buffer(gl, GL_UNIFORM_BUFFER, sizeof(shader::RadialBlock), nullptr, GL_DYNAMIC_DRAW);
    impl->no_attributes = make_vertex_array(gl);
    return FogPass(std::move(impl));
}

std::size_t FogPass::bytes() const {
    std::size_t sum = impl_->froxels ? impl_->froxels->bytes() : 0;
    for (const auto& textures : impl_->paper) sum += textures.bytes;
    if (impl_->radial) sum += impl_->radial->bytes();
    if (impl_->sampled) sum += impl_->sampled->bytes();
    for (const FogTextures* fog : impl_->fogs) {
        const auto& facts = fog->impl_->facts;
        const std::size_t map = sizeof(float) * static_cast<std::size_t>(facts.width) *
                                static_cast<std::size_t>(facts.height);
        if (impl_->method.kind == MethodKind::exact || impl_->method.kind == MethodKind::radial)
            sum += fog->bytes() - map;
        if (impl_->method.kind == MethodKind::march || impl_->method.kind == MethodKind::froxel)
            sum += map;
    }
    return sum;
}

Result<void> FogPass::set_views(const std::vector<FogView>& views) {
    if (!impl_->radial) return {};
    std::vector<FogView> drawn = views;
    if (impl_->sampled)
        for (FogView& view : drawn) view = impl_->sampled->view(view);
    return impl_->radial->set_views(drawn);
}

Result<void> FogPass::set_models(std::vector<FogModel> models) {
    std::vector<ModelGroup> groups = groups_of(std::move(models), impl_->particles);
    std::vector<ModelPass>& passes = impl_->models;
    const auto other = [&] {
        return usage_error(
            "the fog pass was made with formulas of other channels or without; make a new one");
    };
    if (groups.size() != passes.size()) return other();
    for (ModelGroup& group : groups) {
        const auto pass = std::find_if(passes.begin(), passes.end(), [&](const ModelPass& made) {
            return made.channels() == group.channels;
        });
        if (pass == passes.end()) return other();
        if (auto ok = pass->set_models(std::move(group.models)); !ok) return ok;
    }
    return {};
}

Result<void> FogPass::set_particles(std::vector<Particle> particles) {
    const std::vector<std::vector<Particle>> groups = by_channels(std::move(particles));
    for (const auto& group : groups)
        if (std::find(impl_->particles.begin(), impl_->particles.end(), group.front().channels) ==
            impl_->particles.end())
            return usage_error(
                "the fog pass was made without particles, or for those of other channels; make a "
                "new one");
    for (ModelPass& pass : impl_->models) {
        if (!pass.with_particles()) continue;
        const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& alike) {
            return alike.front().channels == pass.channels();
        });
        // Those of a source may all have died.
        auto ok = pass.set_particles(group == groups.end() ? std::vector<Particle>{} : *group);
        if (!ok) return ok;
    }
    return {};
}

Result<void> FogPass::fogs_changed() {
    forget();
    return impl_->make_paper();
}

bool FogPass::coloured() const {
    return impl_->coloured;
}

std::size_t FogPass::table_fills() const {
    return impl_->radial ? impl_->radial->fills() : 0;
}

void FogPass::forget() {
    if (impl_->radial) impl_->radial->forget();
}

void FogPass::draw_colour(const FrameTarget& frame, const Camera& camera, GLuint output_framebuffer,
                          double seconds) {
    impl_->draw(frame, camera, output_framebuffer, seconds, true);
}

void FogPass::draw_optical_depth(const FrameTarget& frame, const Camera& camera,
                                 GLuint output_framebuffer, double seconds) {
    impl_->draw(frame, camera, output_framebuffer, seconds, false);
}

}  // namespace wavefog
