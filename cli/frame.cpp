#include "frame.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "parallel.h"
#include "wavefog/fogmap/reference.h"
#include "wavefog/gpu/context.h"
#include "wavefog/gpu/fog_pass.h"
#include "wavefog/gpu/frame.h"
#include "wavefog/gpu/obstacles.h"
#include "wavefog/gpu/pixel_rays.h"

namespace wavefog::cli {
namespace {

struct Target {
    Texture texture;
    Framebuffer framebuffer;
};

Result<Target> make_target(const Gl& gl, GLenum internal_format, GLenum format, int width,
                           int height) {
    Target target;
    target.texture = make_texture_2d(gl, internal_format, width, height, format, GL_FLOAT, nullptr);
    GLuint name = 0;
    gl.GenFramebuffers(1, &name);
    target.framebuffer = Framebuffer(gl, name);
    gl.BindFramebuffer(GL_FRAMEBUFFER, name);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D,
                            target.texture.name(), 0);
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return data_error(fmt::format(
            "OpenGL: cannot draw into a {}x{} float texture; use a smaller --size", width, height));
    return target;
}

Image transmittance_of(const Image& optical_depth) {
    Image image = optical_depth;
    for (float& value : image.pixels) value = std::exp(-value);
    return image;
}

/// The first 1 to 4 channels of RGBA.
Image channels_of(const Image& rgba, int channels) {
    Image image{rgba.width, rgba.height, channels, {}};
    image.pixels.reserve(rgba.pixels.size() / 4 * std::size_t(channels));
    for (std::size_t i = 0; i < rgba.pixels.size(); i += 4)
        image.pixels.insert(image.pixels.end(), &rgba.pixels[i], &rgba.pixels[i] + channels);
    return image;
}

/// A texture of a picture, whose first row is the uppermost.
Texture upload(const Gl& gl, const Image& image, GLenum internal_format, GLenum format) {
    const std::size_t row = std::size_t(image.width) * std::size_t(image.channels);
    std::vector<float> rows(image.pixels.size());
    for (std::size_t y = 0; y < std::size_t(image.height); ++y)
        std::copy_n(image.pixels.begin() + std::ptrdiff_t(y * row), row,
                    rows.begin() + std::ptrdiff_t((std::size_t(image.height) - 1 - y) * row));
    return make_texture_2d(gl, internal_format, image.width, image.height, format, GL_FLOAT,
                           rows.data());
}

}  // namespace

struct FrameDrawer::Impl {
    const Scene* scene;
    int supersample;
    std::unique_ptr<Context> context;
    std::optional<SceneRenderer> renderer;  ///< none over surfaces from elsewhere
    FrameTarget target;
    std::vector<FogTextures> textures;
    std::optional<FogPass> pass;  ///< none with method reference
    int channels = 3;             ///< of colour
    Target colour, depth;
    std::vector<Fog> changing;  ///< the maps of scene->sequences
    std::vector<SequencePlayer> players;
    std::optional<ParticleSystem> particles;

    const Gl& gl() const { return context->gl(); }

    Result<void> make_pass() {
        for (const Fog& fog : scene->fogs) {
            Result<FogTextures> made = FogTextures::create(gl(), fog);
            if (!made) return tl::unexpected(made.error());
            textures.push_back(*std::move(made));
        }
        std::vector<const FogTextures*> fogs;
        fogs.reserve(textures.size());
        for (const FogTextures& made : textures) fogs.push_back(&made);
        Result<FogPass> made = FogPass::create(
            gl(), fogs, scene->method, scene->fog_colour, scene->models,
            wavefog::channels_of(scene->particles), renderer ? &*renderer : nullptr);
        if (!made) return tl::unexpected(made.error());
        pass = *std::move(made);
        for (auto [to, internal_format, format] :
             {std::tuple{&colour, GLenum(GL_RGBA32F), GLenum(GL_RGBA)},
              {&depth, GL_R32F, GL_RED}}) {
            const bool coloured = pass->coloured() && to == &depth;
            Result<Target> drawn =
                make_target(gl(), coloured ? GL_RGBA32F : internal_format,
                            coloured ? GL_RGBA : format, target.width, target.height);
            if (!drawn) return tl::unexpected(drawn.error());
            *to = *std::move(drawn);
        }
        return {};
    }

    /// What changes in time, and the pass.
    Result<void> make_fogs() {
        for (const MapSequence& sequence : scene->sequences) {
            players.emplace_back(sequence);
            changing.push_back(scene->fogs[sequence.fog]);
        }
        if (!scene->particles.empty()) {
            auto obstacles = scene_obstacles(scene->terrain, scene->meshes);
            if (!obstacles) return tl::unexpected(obstacles.error());
            particles.emplace(scene->particles, *std::move(obstacles));
        }
        return scene->method.kind == MethodKind::reference ? Result<void>{} : make_pass();
    }

    /// The maps that change, as they are at a time.
    Result<void> show_maps(double seconds) {
        for (std::size_t i = 0; i < players.size(); ++i)
            if (auto ok = players[i].show(seconds, changing[i]); !ok) return ok;
        return {};
    }

    /// Colour and transmittance by the GPU fog pass.
    Result<void> draw_on_gpu(double seconds, Frame& frame) {
        for (std::size_t i = 0; i < players.size(); ++i)
            if (auto ok = textures[scene->sequences[i].fog].update(gl(), changing[i]); !ok)
                return ok;
        if (!players.empty())
            if (auto ok = pass->fogs_changed(); !ok) return ok;
        if (particles)
            if (auto ok = pass->set_particles(particles->at(seconds)); !ok) return ok;
        if (!scene->models.empty())
            if (auto ok = pass->set_models(models_at(scene->models, scene->model_motions, seconds));
                !ok)
                return ok;
        pass->draw_colour(target, scene->camera, colour.framebuffer.name(), seconds);
        pass->draw_optical_depth(target, scene->camera, depth.framebuffer.name(), seconds);
        frame.colour = channels_of(
            read_texture(gl(), colour.texture.name(), target.width, target.height, 4), channels);
        const Image tau = read_texture(gl(), depth.texture.name(), target.width, target.height,
                                       pass->coloured() ? 4 : 1);
        frame.transmittance = transmittance_of(pass->coloured() ? channels_of(tau, 3) : tau);
        return {};
    }

    /// The same by the reference integrator, from the scene's colour and depth.
    void draw_on_cpu(double seconds, Frame& frame) {
        const int width = target.width, height = target.height;
        const Image surfaces = read_texture(gl(), target.depth.name(), width, height, 1, true);
        frame.colour =
            channels_of(read_texture(gl(), target.colour.name(), width, height, 4), channels);
        const bool tinted =
            coloured(scene->fogs, scene->models, wavefog::channels_of(scene->particles));
        const int shown = tinted ? 3 : 1;
        frame.transmittance = {width, height, shown,
                               std::vector<float>(surfaces.pixels.size() * std::size_t(shown))};
        std::vector<Reference> fogs;
        for (std::size_t i = 0; i < scene->fogs.size(); ++i) {
            const Fog* fog = &scene->fogs[i];
            for (std::size_t k = 0; k < changing.size(); ++k)
                if (scene->sequences[k].fog == i) fog = &changing[k];
            fogs.emplace_back(*fog, seconds);
        }
        const std::vector<Particle> points =
            particles ? particles->at(seconds) : std::vector<Particle>{};
        const auto models = models_at(scene->models, scene->model_motions, seconds);
        const PixelRays rays(scene->camera, width, height);
        const auto draw_rows = [&](std::size_t begin, std::size_t end) {
            for (int y = int(begin); y < int(end); ++y)
                for (int x = 0; x < width; ++x) {
                    const PixelRay ray = rays.at(x, y, double(surfaces.at(x, y, 0)));
                    const Eigen::Array3d tau =
                        rays.channel_depths(fogs, ray, scene->method.mu, models, points);
                    for (int c = 0; c < shown; ++c)
                        frame.transmittance.at(x, y, c) = float(std::exp(-tau[c]));
                    for (int c = 0; c < 3; ++c) {
                        float& value = frame.colour.at(x, y, c);
                        value +=
                            float(-std::expm1(-tau[c]) * (scene->fog_colour[c] - double(value)));
                    }
                }
        };
        parallel_chunks("integrating", std::size_t(height), 1, draw_rows);
    }
};

FrameDrawer::FrameDrawer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FrameDrawer::FrameDrawer(FrameDrawer&&) noexcept = default;
FrameDrawer& FrameDrawer::operator=(FrameDrawer&&) noexcept = default;
FrameDrawer::~FrameDrawer() = default;

Result<FrameDrawer> FrameDrawer::create(const Scene& scene, const std::string& context_name,
                                        int supersample) {
    Result<std::unique_ptr<Context>> context = create_context(context_name);
    if (!context) return tl::unexpected(context.error());
    auto impl = std::make_unique<Impl>();
    impl->scene = &scene;
    impl->supersample = supersample;
    impl->context = *std::move(context);
    const int width = scene.width * supersample, height = scene.height * supersample;

    Result<SceneRenderer> renderer = SceneRenderer::create(impl->gl(), scene);
    if (!renderer) return tl::unexpected(renderer.error());
    impl->renderer = *std::move(renderer);
    impl->target = make_frame_target(impl->gl(), width, height);
    if (!impl->target.framebuffer)
        return usage_error(
            fmt::format("--size: this OpenGL cannot draw {}x{} pixels; use less, or "
                        "less --supersample",
                        width, height));
    impl->renderer->draw(impl->target, scene.camera);
    if (auto made = impl->make_fogs(); !made) return tl::unexpected(made.error());
    return FrameDrawer(std::move(impl));
}

Result<FrameDrawer> FrameDrawer::over(const Scene& scene, const Surfaces& surfaces,
                                      const std::string& context_name) {
    Result<std::unique_ptr<Context>> context = create_context(context_name);
    if (!context) return tl::unexpected(context.error());
    auto impl = std::make_unique<Impl>();
    impl->scene = &scene;
    impl->supersample = 1;
    impl->context = *std::move(context);
    const Image& colour = surfaces.colour;
    impl->channels = colour.channels;
    GLint largest = 0;
    impl->gl().GetIntegerv(GL_MAX_TEXTURE_SIZE, &largest);
    if (colour.width > largest || colour.height > largest)
        return data_error(fmt::format("{}x{} pixels: this OpenGL holds {} a side; use smaller ones",
                                      colour.width, colour.height, largest));
    impl->target.width = colour.width;
    impl->target.height = colour.height;
    impl->target.colour =
        upload(impl->gl(), colour, GL_RGBA32F, colour.channels == 4 ? GL_RGBA : GL_RGB);
    impl->target.depth =
        upload(impl->gl(), surfaces.depth, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT);
    if (auto made = impl->make_fogs(); !made) return tl::unexpected(made.error());
    return FrameDrawer(std::move(impl));
}

Surfaces FrameDrawer::surfaces() const {
    const FrameTarget& target = impl_->target;
    return {
        channels_of(read_texture(impl_->gl(), target.colour.name(), target.width, target.height, 4),
                    impl_->channels),
        read_texture(impl_->gl(), target.depth.name(), target.width, target.height, 1, true)};
}

Result<Frame> FrameDrawer::draw(double seconds) {
    Frame frame;
    frame.renderer = impl_->context->renderer();
    if (auto shown = impl_->show_maps(seconds); !shown) return tl::unexpected(shown.error());
    if (!impl_->pass)
        impl_->draw_on_cpu(seconds, frame);
    else if (auto drawn = impl_->draw_on_gpu(seconds, frame); !drawn)
        return tl::unexpected(drawn.error());
    if (impl_->supersample > 1) {
        frame.colour = box_average(frame.colour, impl_->supersample);
        frame.transmittance = box_average(frame.transmittance, impl_->supersample);
    }
    return frame;
}

Image box_average(const Image& image, int factor) {
    Image small{image.width / factor, image.height / factor, image.channels, {}};
    small.pixels.reserve(image.pixels.size() / std::size_t(factor * factor));
    for (int y = 0; y < small.height; ++y)
        for (int x = 0; x < small.width; ++x)
            for (int c = 0; c < small.channels; ++c) {
                double sum = 0;
                for (int j = 0; j < factor; ++j)
                    for (int i = 0; i < factor; ++i)
                        sum += double(image.at(x * factor + i, y * factor + j, c));
                small.pixels.push_back(float(sum / (factor * factor)));
            }
    return small;
}

Result<Frame> draw_frame(const Scene& scene, const std::string& context, int supersample,
                         double seconds) {
    Result<FrameDrawer> drawer = FrameDrawer::create(scene, context, supersample);
    if (!drawer) return tl::unexpected(drawer.error());
    return drawer->draw(seconds);
}

}  // namespace wavefog::cli
