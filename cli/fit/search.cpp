#include "fit/search.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "wavefog/gpu/timer.h"

namespace wavefog::cli {
namespace {

constexpr int kTimedFrames = 9;
// What takes so much longer in its first frames will not be chosen.
constexpr int kFirstFrames = 3;
constexpr double kHopeless = 2;

constexpr const char* kMethods[] = {"exact",
                                    "radial:256x64",
                                    "radial:512x128",
                                    "radial:1024x256",
                                    "radial",
                                    "radial:512x64:step",
                                    "radial:1024x128:step",
                                    "radial:2048x256:step",
                                    "radial:step",
                                    "march:8",
                                    "march:16",
                                    "march:32",
                                    "march:64"};
// Finer than the default, which fits its table to the view: for errors that it only just misses.
constexpr const char* kFinerTables[] = {"radial:2048x512", "radial:4096x1024"};
constexpr double kJustMissed = 4;
constexpr double kMus[] = {1, 0.95, 0.9, 0.8, 0.6, 0.4, 0.2, 0};

// What else runs on the machine only adds: the choice shall not hang on it.
double least_of(const Samples& ms) {
    return ms.percentile(0);
}

}  // namespace

Result<void> FitSearch::try_methods(double error) {
    settings_.clear();
    misses_.clear();
    textures_.clear();
    for (const FitMaps& maps : maps_) {
        Result<std::vector<FogTextures>> made = make_textures(gl_, maps.fogs);
        if (!made) return tl::unexpected(made.error());
        textures_.push_back(*std::move(made));
    }
    const auto enter = [&](std::size_t maps, const Method& method) -> Result<bool> {
        Result<FogPass> pass = make_pass(gl_, textures_[maps], method, scene_, maps_[maps].models);
        if (!pass) return tl::unexpected(pass.error());
        const Result<Worst> made = largest_error(gl_, *pass, tuning_, error);
        if (!made) return tl::unexpected(made.error());
        if (made->error > error)
            misses_.push_back({maps, method, *made});
        else
            settings_.push_back({maps, method, *std::move(pass), *made});
        return made->error <= error;
    };
    for (std::size_t m = 0; m < maps_.size(); ++m)
        for (const char* name : kMethods) {
            Method method = *parse_method(name);
            const std::vector<Fog>& fogs = maps_[m].fogs;
            const bool formulas_alone = fogs.empty();
            const bool details = std::any_of(fogs.begin(), fogs.end(), [](const Fog& fog) {
                return fog.decomposition.levels() > 0;
            });
            if (formulas_alone && method.kind != MethodKind::exact) continue;
            for (const double mu : kMus) {
                method.mu = mu;
                const Result<bool> fits = enter(m, method);
                if (!fits) return tl::unexpected(fits.error());
                // Errors grow as mu falls, and only level ranges know of mu.
                if (!*fits || method.kind != MethodKind::exact || !details) break;
            }
            if (method.name() != "radial" || misses_.empty()) continue;
            const FitMiss& last = misses_.back();
            if (last.maps != m || last.method.name() != "radial" ||
                last.worst.error > kJustMissed * error)
                continue;
            for (const char* finer : kFinerTables) {
                const Result<bool> fits = enter(m, *parse_method(finer));
                if (!fits) return tl::unexpected(fits.error());
                if (*fits) break;
            }
        }

    Method own = scene_.method;
    if (own.kind == MethodKind::reference) own.kind = MethodKind::exact;
    own.sampling = {};
    Result<FogPass> pass = make_pass(gl_, textures_.front(), own, scene_, scene_.models);
    if (!pass) return tl::unexpected(pass.error());
    const Result<Worst> worst = largest_error(gl_, *pass, tuning_);
    if (!worst) return tl::unexpected(worst.error());
    before_.emplace(FitSetting{0, own, *std::move(pass), *worst});
    return {};
}

Result<void> FitSearch::time(const Size& size, double target) {
    const Result<SceneRenderer> renderer = SceneRenderer::create(gl_, scene_);
    if (!renderer) return tl::unexpected(renderer.error());
    const std::vector<NamedCamera> cameras = cameras_of(scene_);
    std::vector<FrameTarget> frames;
    for (const NamedCamera& named : cameras) {
        frames.push_back(make_frame_target(gl_, size.width, size.height));
        if (!frames.back().framebuffer)
            return usage_error("this OpenGL cannot draw so large a picture; use a smaller --size");
        renderer->draw(frames.back(), named.camera);
    }
    const Texture target_texture =
        make_texture_2d(gl_, GL_RGBA16F, size.width, size.height, GL_RGBA, GL_FLOAT, nullptr);
    const Result<Framebuffer> framebuffer = make_framebuffer(gl_, target_texture.name());
    if (!framebuffer) return tl::unexpected(framebuffer.error());

    FrameTimer timer(gl_);
    const auto draw = [&](FitSetting& setting, std::size_t camera) {
        setting.pass.forget();  // a moving camera keeps no table
        return timer
            .time([&] {
                setting.pass.draw_colour(frames[camera], cameras[camera].camera,
                                         framebuffer->name());
            })
            .wall_ms;
    };
    std::vector<FitSetting*> timed = {&*before_};
    for (FitSetting& setting : settings_) timed.push_back(&setting);
    double least = std::numeric_limits<double>::infinity();
    for (FitSetting* setting : timed) {
        draw(*setting, 0);  // the first compiles and fills caches
        Samples first;
        for (int i = 0; i < kFirstFrames; ++i) first.add(draw(*setting, 0));
        setting->ms = least_of(first);
        least = std::min(least, setting->ms);
    }
    const double hopeless = kHopeless * std::max(least, target);
    const bool slow_before = before_->ms > hopeless;
    timed.erase(std::remove_if(timed.begin() + 1, timed.end(),
                               [&](const FitSetting* s) { return s->ms > hopeless; }),
                timed.end());
    std::vector<std::vector<Samples>> samples(timed.size(), std::vector<Samples>(cameras.size()));
    for (int round = 0; round < kTimedFrames; ++round)
        for (std::size_t i = slow_before && round > 0 ? 1 : 0; i < timed.size(); ++i)
            for (std::size_t c = 0; c < cameras.size(); ++c) samples[i][c].add(draw(*timed[i], c));
    for (std::size_t i = 0; i < timed.size(); ++i) {
        timed[i]->ms = 0;
        for (const Samples& of_camera : samples[i])
            timed[i]->ms = std::max(timed[i]->ms, least_of(of_camera));
    }
    std::stable_sort(settings_.begin(), settings_.end(),
                     [](const auto& a, const auto& b) { return a.ms < b.ms; });
    return {};
}

}  // namespace wavefog::cli
