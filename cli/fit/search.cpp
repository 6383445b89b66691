#include "fit/search.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "wavefog/fogmap/coarsen.h"
#include "wavefog/gpu/timer.h"

namespace wavefog::cli {
namespace {

// Levels to choose from: 1024 fine cells become one.
constexpr int kLevels = 10;
constexpr int kTimedFrames = 9;

constexpr const char* kMethods[] = {"radial",   "exact",    "march:8",
                                    "march:16", "march:32", "march:64"};
constexpr double kMus[] = {1, 0.95, 0.9, 0.8, 0.6, 0.4, 0.2, 0};

}  // namespace

Result<FitMaps> FitSearch::drop_levels(const std::vector<Fog>& whole, double error) const {
    FitMaps maps{whole, std::vector<int>(whole.size(), 0), 0};
    const Result<double> none = largest_error(gl_, scene_, whole, Method{}, tuning_);
    if (!none) return tl::unexpected(none.error());
    maps.error = *none;
    if (maps.error > error) return maps;
    for (;;) {
        // Of the fogs that can lose a level more, the one that shows it least.
        std::optional<FitMaps> best;
        for (std::size_t i = 0; i < whole.size(); ++i) {
            if (maps.dropped[i] == whole[i].decomposition.levels()) continue;
            FitMaps next = maps;
            Result<Fog> coarser = without_finest(whole[i], ++next.dropped[i]);
            if (!coarser) return tl::unexpected(coarser.error());
            next.fogs[i] = *std::move(coarser);
            const Result<double> made = largest_error(gl_, scene_, next.fogs, Method{}, tuning_);
            if (!made) return tl::unexpected(made.error());
            next.error = *made;
            if (next.error <= error && (!best || next.error < best->error)) best = std::move(next);
        }
        if (!best) return maps;
        maps = *std::move(best);
    }
}

Result<void> FitSearch::simplify(double error) {
    maps_.clear();
    maps_.push_back({scene_.fogs, std::vector<int>(scene_.fogs.size(), 0), 0});
    int highest = 0;
    for (const Fog& fog : scene_.fogs) highest = std::max(highest, fog.degree());
    for (int degree = highest; degree >= 0; --degree) {
        std::vector<Fog> whole;
        for (const Fog& fog : scene_.fogs) {
            Result<Fog> made = decomposed_as(fog, std::min(degree, fog.degree()), kLevels);
            if (!made) return tl::unexpected(made.error());
            whole.push_back(*std::move(made));
        }
        Result<FitMaps> maps = drop_levels(whole, error);
        if (!maps) return tl::unexpected(maps.error());
        const bool simpler =
            degree < highest ||
            std::any_of(maps->dropped.begin(), maps->dropped.end(), [](int n) { return n > 0; });
        if (simpler && maps->error <= error) maps_.push_back(*std::move(maps));
    }
    return {};
}

Result<void> FitSearch::try_methods(double error) {
    settings_.clear();
    textures_.clear();
    for (const FitMaps& maps : maps_) {
        Result<std::vector<FogTextures>> made = make_textures(gl_, maps.fogs);
        if (!made) return tl::unexpected(made.error());
        textures_.push_back(*std::move(made));
    }
    const auto enter = [&](std::size_t maps, const Method& method) -> Result<bool> {
        Result<FogPass> pass = make_pass(gl_, textures_[maps], method, scene_);
        if (!pass) return tl::unexpected(pass.error());
        const Result<double> made = largest_error(gl_, *pass, tuning_);
        if (!made) return tl::unexpected(made.error());
        if (*made > error) return false;
        settings_.push_back({maps, method, *std::move(pass), *made, std::nullopt});
        return true;
    };
    Method homogeneous;
    homogeneous.kind = MethodKind::homogeneous;
    if (const auto ok = enter(0, homogeneous); !ok) return tl::unexpected(ok.error());
    for (std::size_t m = 0; m < maps_.size(); ++m)
        for (const char* name : kMethods) {
            Method method = *parse_method(name);
            for (const double mu : kMus) {
                method.mu = mu;
                const Result<bool> fits = enter(m, method);
                if (!fits) return tl::unexpected(fits.error());
                // Errors grow as mu falls, and only level ranges know of mu.
                if (!*fits || method.kind != MethodKind::exact) break;
            }
        }
    return {};
}

Result<void> FitSearch::time(const Size& size) {
    const Result<SceneRenderer> renderer = SceneRenderer::create(gl_, scene_);
    if (!renderer) return tl::unexpected(renderer.error());
    const FrameTarget frame = make_frame_target(gl_, size.width, size.height);
    if (!frame.framebuffer)
        return usage_error("this OpenGL cannot draw so large a picture; use a smaller --size");
    renderer->draw(frame, scene_.camera);
    const Texture target =
        make_texture_2d(gl_, GL_RGBA16F, size.width, size.height, GL_RGBA, GL_FLOAT, nullptr);
    const Result<Framebuffer> framebuffer = make_framebuffer(gl_, target.name());
    if (!framebuffer) return tl::unexpected(framebuffer.error());

    FrameTimer timer(gl_);
    std::vector<Samples> samples(settings_.size());
    for (int round = 0; round <= kTimedFrames; ++round)
        for (std::size_t i = 0; i < settings_.size(); ++i) {
            settings_[i].pass.forget();  // a moving camera keeps no table
            const FrameTime spent = timer.time(
                [&] { settings_[i].pass.draw_colour(frame, scene_.camera, framebuffer->name()); });
            if (round > 0) samples[i].add(spent.wall_ms);  // the first compiles and fills caches
        }
    for (std::size_t i = 0; i < settings_.size(); ++i) settings_[i].ms = samples[i].median();
    std::stable_sort(settings_.begin(), settings_.end(),
                     [](const auto& a, const auto& b) { return *a.ms < *b.ms; });
    return {};
}

}  // namespace wavefog::cli
