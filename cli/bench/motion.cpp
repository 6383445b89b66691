#include "bench/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <iterator>
#include <vector>

#include "bench/progress.h"
#include "bench/table_text.h"
#include "wavefog/fogmap/particles.h"
#include "wavefog/gpu/fog_pass.h"
#include "wavefog/gpu/frame.h"
#include "wavefog/gpu/timer.h"
#include "wavefog/wavelet/interpolate.h"

namespace wavefog::cli {
namespace {

constexpr int kSizes[] = {64, 128, 256, 512, 1024};
constexpr int kCounts[] = {0, 20, 200, 2000, 20000};
constexpr double kRows = std::size(kSizes) + std::size(kCounts);
constexpr int kLeastRuns = 3, kMostRuns = 400;

using Work = std::function<Result<void>(int run)>;

/// Milliseconds of works that take turns for about `seconds` in all, after one run each that
/// allocates.
Result<std::vector<Samples>> take_turns(double seconds, const std::vector<Work>& works) {
    using Clock = std::chrono::steady_clock;
    std::vector<Samples> times(works.size());
    const auto start = Clock::now();
    for (int run = 0; run <= kMostRuns; ++run) {
        for (std::size_t i = 0; i < works.size(); ++i) {
            const auto before = Clock::now();
            if (auto ok = works[i](run); !ok) return tl::unexpected(ok.error());
            if (run > 0)
                times[i].add(
                    std::chrono::duration<double, std::milli>(Clock::now() - before).count());
        }
        if (run >= kLeastRuns &&
            std::chrono::duration<double>(Clock::now() - start).count() > seconds)
            break;
    }
    return times;
}

/// Soft banks that differ with the phase.
Grid<float> bank_map(int size, double phase) {
    Grid<float> map(size, size);
    for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i) {
            const double x = 20.0 * i / size, z = 20.0 * j / size;
            map(j, i) = float(std::max(0.0, 0.5 + 0.3 * std::sin(x + phase) * std::cos(z) +
                                                0.2 * std::sin(3.1 * z - 2.3 * x + 2 * phase)));
        }
    return map;
}

Result<void> study_maps(const Gl& gl, double seconds, Facts& rows) {
    for (const int size : kSizes) {
        show_progress_line(double(rows.size()) / kRows, 0, fmt::format("{}²", size));
        const Grid<float> maps[] = {bank_map(size, 0), bank_map(size, 1)};
        Result<Fog> fog = make_fog(maps[0], {});
        const Result<Fog> other = make_fog(maps[1], {});
        if (!fog || !other) return tl::unexpected(fog ? other.error() : fog.error());
        Result<FogTextures> textures = FogTextures::create(gl, *fog);
        if (!textures) return tl::unexpected(textures.error());
        const Fog first = *fog;
        const auto& like = first.decomposition;
        Decomposition<float> made;
        const auto times = take_turns(
            seconds, {[&](int run) {
                          return decompose_into(maps[run % 2], like.family, like.levels(),
                                                like.form, like.boundary, made);
                      },
                      [&](int run) {
                          return interpolate(like, other->decomposition, (run % 64 + 0.5) / 64,
                                             fog->decomposition);
                      },
                      [&](int) {
                          auto ok = textures->update(gl, *fog);
                          gl.Finish();
                          return ok;
                      }});
        if (!times) return tl::unexpected(times.error());
        rows.push_back({{"size", size},
                        {"levels", like.levels()},
                        {"decompose_ms", (*times)[0].median()},
                        {"mix_ms", (*times)[1].median()},
                        {"textures_ms", (*times)[2].median()}});
    }
    return {};
}

/// Small points that drift over a meadow of 100 m, before the sky.
ParticleSource drifting(int count) {
    ParticleSource source;
    source.position = {0, 1, -50};
    source.area = 50;
    source.spread = 1.2;
    source.radius = {0.2, 0.5};
    source.rate = count / (source.step * (source.life[0] + source.life[1]) / 2);
    source.drag = 0.5;
    source.wind = {1, 0};
    return source;
}

Result<void> study_particles(const Gl& gl, double seconds, Facts& rows) {
    constexpr int kWidth = 800, kHeight = 600;
    constexpr double kFrame = 1.0 / 24;
    Camera camera;
    camera.eye = {0, 3, 0};
    camera.target = {0, 2, -20};
    const FrameTarget frame = make_frame_target(gl, kWidth, kHeight);
    if (!frame.framebuffer) return data_error("OpenGL: cannot draw 800x600 pixels");
    gl.BindFramebuffer(GL_FRAMEBUFFER, frame.framebuffer.name());
    gl.ClearDepth(camera_matrices(camera, kWidth, kHeight).sky_depth);
    gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    const Texture picture =
        make_texture_2d(gl, GL_RGBA32F, kWidth, kHeight, GL_RGBA, GL_FLOAT, nullptr);
    const Result<Framebuffer> output = make_framebuffer(gl, picture.name());
    if (!output) return tl::unexpected(output.error());
    struct Drifting {
        FogPass pass;
        ParticleSystem system;
        std::vector<Particle> now = {};
    };
    std::vector<Drifting> all;
    for (const int count : kCounts) {
        Result<FogPass> pass = FogPass::create(gl, {}, {}, {1, 1, 1}, {}, {kAllChannels});
        if (!pass) return tl::unexpected(pass.error());
        std::vector<ParticleSource> sources;
        if (count > 0) sources.push_back(drifting(count));
        all.push_back({std::move(*pass), ParticleSystem(std::move(sources))});
    }
    std::vector<Work> steps, draws;
    for (Drifting& one : all) {
        steps.push_back([&one](int run) -> Result<void> {
            one.now = one.system.at(run * kFrame);
            return {};
        });
        draws.push_back([&](int) -> Result<void> {
            if (auto ok = one.pass.set_particles(one.now); !ok) return ok;
            one.pass.draw_colour(frame, camera, output->name());
            gl.Finish();
            return {};
        });
    }
    show_progress_line(double(rows.size()) / kRows, 0, "particles");
    const auto stepped = take_turns(seconds, steps);
    if (!stepped) return tl::unexpected(stepped.error());
    const auto drawn = take_turns(2 * seconds, draws);
    if (!drawn) return tl::unexpected(drawn.error());
    for (std::size_t i = 0; i < all.size(); ++i) {
        const Samples& ms = (*drawn)[i];
        rows.push_back({{"particles", all[i].now.size()},
                        {"step_ms", (*stepped)[i].median()},
                        {"draw_ms", ms.median()},
                        {"draw_ms_p05", ms.percentile(5)},
                        {"draw_ms_p95", ms.percentile(95)},
                        {"draw_ratio_none", ms.median() / drawn->front().median()}});
    }
    return {};
}

}  // namespace

Result<void> study_motion(Context& context, double seconds, Results& results) {
    results.motion = Facts::array();
    // A third for the maps, a third of what is left for steps of particles, the rest to draw them.
    const double third = seconds / 3;
    auto done = study_maps(context.gl(), third / std::size(kSizes), results.motion);
    if (done) done = study_particles(context.gl(), 2 * third / 3, results.motion);
    clear_progress_line();
    return done;
}

std::string motion_text(const Facts& rows, bool markdown) {
    const auto cell = [](const Facts& row, const char* key) {
        return fmt::format("{:.3g}", row.at(key).get<double>());
    };
    Table maps({"map", "decompose, ms", "mix two, ms", "textures, ms"});
    Table particles({"particles", "a step, ms", "draw at 800×600, ms", "[5 %, 95 %]", "× none"});
    for (const Facts& row : rows)
        if (row.contains("size"))
            maps.add({fmt::format("{}²", row.at("size").get<int>()), cell(row, "decompose_ms"),
                      cell(row, "mix_ms"), cell(row, "textures_ms")});
        else
            particles.add(
                {row.at("particles").dump(), cell(row, "step_ms"), cell(row, "draw_ms"),
                 fmt::format("[{}, {}]", cell(row, "draw_ms_p05"), cell(row, "draw_ms_p95")),
                 cell(row, "draw_ratio_none")});
    return maps.text(markdown) + "\n" + particles.text(markdown);
}

}  // namespace wavefog::cli
