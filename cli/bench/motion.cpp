#include "bench/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <vector>

#include "bench/progress.h"
#include "bench/table_text.h"
#include "wavefog/fogmap/particles.h"
#include "wavefog/gpu/fog_pass.h"
#include "wavefog/gpu/frame.h"
#include "wavefog/wavelet/interpolate.h"

namespace wavefog::cli {
namespace {

constexpr int kSizes[] = {64, 128, 256, 512, 1024};
constexpr int kCounts[] = {0, 20, 200, 2000, 20000};
constexpr double kRows = std::size(kSizes) + std::size(kCounts);
constexpr double kMedians = 3 * std::size(kSizes) + 2 * std::size(kCounts);
constexpr int kLeastRuns = 3, kMostRuns = 400;

/// Median of milliseconds within about `seconds`, after one run that allocates.
template <class Work>
Result<double> median_ms(double seconds, const Work& work) {
    using Clock = std::chrono::steady_clock;
    std::vector<double> times;
    const auto start = Clock::now();
    for (int run = 0; run <= kMostRuns; ++run) {
        const auto before = Clock::now();
        if (auto ok = work(run); !ok) return tl::unexpected(ok.error());
        const auto now = Clock::now();
        if (run > 0)
            times.push_back(std::chrono::duration<double, std::milli>(now - before).count());
        if (run >= kLeastRuns && std::chrono::duration<double>(now - start).count() > seconds)
            break;
    }
    std::nth_element(times.begin(), times.begin() + std::ptrdiff_t(times.size() / 2), times.end());
    return times[times.size() / 2];
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
        const auto decomposed = median_ms(seconds, [&](int run) {
            return decompose_into(maps[run % 2], like.family, like.levels(), like.form,
                                  like.boundary, made);
        });
        const auto mixed = median_ms(seconds, [&](int run) {
            return interpolate(like, other->decomposition, (run % 64 + 0.5) / 64,
                               fog->decomposition);
        });
        const auto uploaded = median_ms(seconds, [&](int) {
            auto ok = textures->update(gl, *fog);
            gl.Finish();
            return ok;
        });
        for (const auto* time : {&decomposed, &mixed, &uploaded})
            if (!*time) return tl::unexpected(time->error());
        rows.push_back({{"size", size},
                        {"levels", like.levels()},
                        {"decompose_ms", *decomposed},
                        {"mix_ms", *mixed},
                        {"textures_ms", *uploaded}});
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
    for (const int count : kCounts) {
        show_progress_line(double(rows.size()) / kRows, 0, fmt::format("{} particles", count));
        Result<FogPass> pass = FogPass::create(gl, {}, {}, {1, 1, 1}, {}, true);
        if (!pass) return tl::unexpected(pass.error());
        std::vector<ParticleSource> sources;
        if (count > 0) sources.push_back(drifting(count));
        ParticleSystem system(std::move(sources));
        std::vector<Particle> now;
        const auto stepped = median_ms(seconds, [&](int run) -> Result<void> {
            now = system.at(run * kFrame);
            return {};
        });
        const auto drawn = median_ms(seconds, [&](int) -> Result<void> {
            if (auto ok = pass->set_particles(now); !ok) return ok;
            pass->draw_colour(frame, camera, output->name());
            gl.Finish();
            return {};
        });
        for (const auto* time : {&stepped, &drawn})
            if (!*time) return tl::unexpected(time->error());
        rows.push_back({{"particles", now.size()}, {"step_ms", *stepped}, {"draw_ms", *drawn}});
    }
    return {};
}

}  // namespace

Result<void> study_motion(Context& context, double seconds, Results& results) {
    results.motion = Facts::array();
    const double each = seconds / kMedians;
    auto done = study_maps(context.gl(), each, results.motion);
    if (done) done = study_particles(context.gl(), each, results.motion);
    clear_progress_line();
    return done;
}

std::string motion_text(const Facts& rows, bool markdown) {
    const auto cell = [](const Facts& row, const char* key) {
        return fmt::format("{:.3g}", row.at(key).get<double>());
    };
    Table maps({"map", "decompose, ms", "mix two, ms", "textures, ms"});
    Table particles({"particles", "a step, ms", "draw at 800×600, ms"});
    for (const Facts& row : rows)
        if (row.contains("size"))
            maps.add({fmt::format("{}²", row.at("size").get<int>()), cell(row, "decompose_ms"),
                      cell(row, "mix_ms"), cell(row, "textures_ms")});
        else
            particles.add({row.at("particles").dump(), cell(row, "step_ms"), cell(row, "draw_ms")});
    return maps.text(markdown) + "\n" + particles.text(markdown);
}

}  // namespace wavefog::cli
