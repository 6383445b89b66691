#include "bench/measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "bench/progress.h"
#include "bench/provenance.h"
#include "wavefog/gpu/fog_pass.h"
#include "wavefog/gpu/frame.h"
#include "wavefog/gpu/timer.h"

namespace wavefog::cli {
namespace {

constexpr int kLeastFrames = 5;       // of a slow case, if the time allows
constexpr double kCaseSeconds = 8;    // for a slow case, if nothing else bounds it
constexpr double kPlanned = 0.8;      // of a group's time: one pilot frame says little
constexpr double kWarmUpSeconds = 2;  // dearer frames are timed without a warm-up at full size

struct Output {
    Texture texture;
    Framebuffer framebuffer;
};

Result<Output> make_output(const Gl& gl, GLenum internal_format, const Size& size) {
    Output output;
    output.texture =
        make_texture_2d(gl, internal_format, size.width, size.height, GL_RGBA, GL_FLOAT, nullptr);
    Result<Framebuffer> framebuffer = make_framebuffer(gl, output.texture.name());
    if (!framebuffer) return tl::unexpected(framebuffer.error());
    output.framebuffer = *std::move(framebuffer);
    return output;
}

std::string label(const Row& row) {
    return fmt::format("{} {}x{} {}, {} levels, {}, mu {}", row.scene, row.map_width,
                       row.map_height, row.basis, row.levels, row.method, row.mu);
}

/// Formulas alone are drawn by every method: beside them `homogeneous` is a fog of its own.
bool is_constant_fog(const Method& method, const Variant& variant) {
    return method.kind == MethodKind::homogeneous && variant.fogs.empty();
}

}  // namespace

Method homogeneous_method() {
    Method method;
    method.kind = MethodKind::homogeneous;
    return method;
}

/// A scene drawn once: colour and depth that every method reads, and targets to draw into.
struct Measurement::Stage {
    Size size, pilot_size;
    std::optional<SceneRenderer> renderer;
    FrameTarget frame, pilot;     ///< pilot: 1/64 of the pixels, to see what a frame will cost
    Output fogged, pilot_fogged;  ///< RGBA16F, what is timed
    Output fine;                  ///< RGBA32F, what accuracy is measured on
    Image scene_colour, depth;
    RayLimits limits;

    static Result<Stage> create(const Gl& gl, const Scene& scene, const Size& size) {
        Stage stage;
        stage.size = size;
        stage.pilot_size = {std::max(size.width / 8, 1), std::max(size.height / 8, 1)};
        Result<SceneRenderer> renderer = SceneRenderer::create(gl, scene);
        if (!renderer) return tl::unexpected(renderer.error());
        stage.renderer = *std::move(renderer);
        for (auto [target, target_size] :
             {std::pair{&stage.frame, &stage.size}, {&stage.pilot, &stage.pilot_size}}) {
            *target = make_frame_target(gl, target_size->width, target_size->height);
            if (!target->framebuffer)
                return usage_error(fmt::format("--size: this OpenGL cannot draw {}x{}; use less",
                                               size.width, size.height));
            stage.renderer->draw(*target, scene.camera);
        }
        stage.scene_colour =
            read_texture(gl, stage.frame.colour.name(), size.width, size.height, 4);
        stage.depth = read_texture(gl, stage.frame.depth.name(), size.width, size.height, 1, true);
        for (auto [output, format, output_size] :
             {std::tuple{&stage.fogged, GLenum{GL_RGBA16F}, &stage.size},
              {&stage.pilot_fogged, GLenum{GL_RGBA16F}, &stage.pilot_size},
              {&stage.fine, GLenum{GL_RGBA32F}, &stage.size}}) {
            Result<Output> made = make_output(gl, format, *output_size);
            if (!made) return tl::unexpected(made.error());
            *output = *std::move(made);
        }
        return stage;
    }
};

struct Measurement::Contender {
    std::size_t variant = 0;
    Method method;
    bool reuse = false;
    FogPass pass;
    Row row;
    double estimate = 0;  ///< seconds of a frame
    int frames = 0;       ///< planned
    Samples gpu_ms, wall_ms;
};

Measurement::Measurement(Context& context, const std::vector<BenchScene>& scenes,
                         const MeasureOptions& options)
    : context_(context),
      scenes_(scenes),
      options_(options),
      start_(std::chrono::steady_clock::now()) {}

double Measurement::remaining_seconds() const {
    const std::chrono::duration<double> used = std::chrono::steady_clock::now() - start_;
    return options_.seconds.value_or(1e9) - used.count();
}

void Measurement::show_progress(const std::string& doing) const {
    const std::chrono::duration<double> used = std::chrono::steady_clock::now() - start_;
    show_progress_line(done_, used.count(), doing);
}

Result<const Truth*> Measurement::truth(const Group& group, const Variant& variant,
                                        const Stage& stage) {
    const std::string key =
        fmt::format("{}:{}x{}/{}/{}:{}", group.scene, group.size.width, group.size.height,
                    group.stride, group.pixel_means, variant.truth_key);
    if (const auto found = truths_.find(key); found != truths_.end()) return &found->second;
    const Result<std::vector<Fog>> fogs = undecomposed(variant.fogs);
    if (!fogs) return tl::unexpected(fogs.error());
    const Scene& scene = scenes_[group.scene].scene;
    Truth made = compute_truth(*fogs, scene.models, scene.camera, stage.depth, group.stride,
                               group.pixel_means, scenes_[group.scene].particles);
    return &truths_.emplace(key, std::move(made)).first->second;
}

Result<void> Measurement::run(const std::vector<Group>& groups, Results& results) {
    for (std::size_t i = 0; i < groups.size(); ++i) {
        group_share_ = 1 / double(groups.size());
        done_ = double(i) * group_share_;
        show_progress(groups[i].name);
        const double left = remaining_seconds();
        if (left <= 0) {
            results.cut.push_back(fmt::format("{}: all of it, the time was up", groups[i].name));
            continue;
        }
        if (auto ok = run_group(groups[i], left / double(groups.size() - i), results); !ok) {
            clear_progress_line();
            return ok;
        }
    }
    clear_progress_line();
    return {};
}

Result<void> Measurement::run_group(const Group& group, double seconds, Results& results) {
    const auto begin = std::chrono::steady_clock::now();
    const auto seconds_left = [&] {
        const std::chrono::duration<double> used = std::chrono::steady_clock::now() - begin;
        return seconds - used.count();
    };
    const Scene& scene = scenes_[group.scene].scene;
    Result<Stage> stage = Stage::create(context_.gl(), scene, group.size);
    if (!stage) return tl::unexpected(stage.error());

    prepare(group);
    if (!group.variants.empty())
        stage->limits = ray_limits(group.variants.front()->fogs, scene.camera, stage->depth);
    // Truths come first: they do not disturb the timing.
    std::vector<const Truth*> truths;
    for (const auto& variant : group.variants) {
        const Result<const Truth*> made = truth(group, *variant, *stage);
        if (!made) return tl::unexpected(made.error());
        truths.push_back(*made);
    }

    std::vector<Contender> contenders;
    const auto enter = [&](const Case& one) {
        Row row = empty_row(group, one);
        Result<FogPass> pass = make_pass(group, one, *stage->renderer);
        if (!pass) {
            results.skipped.push_back(label(row) + ": " + pass.error().message);
            return;
        }
        row.bytes = pass->bytes();
        contenders.push_back({one.variant,
                              one.method,
                              one.reuse || options_.reuse,
                              *std::move(pass),
                              std::move(row),
                              0,
                              0,
                              {},
                              {}});
    };
    enter({0, homogeneous_method()});
    for (const Case& one : group.cases)
        if (one.method.kind != MethodKind::homogeneous) enter(one);

    estimate(contenders, *stage, scene.camera);
    plan_frames(contenders, seconds_left(), results);
    take_turns(group, contenders, *stage, seconds_left());
    std::optional<double> homogeneous_ms;
    // A table that is kept has the bound of one that is filled anew.
    std::map<std::tuple<std::size_t, std::string, double>, double> bounds;
    for (Contender& contender : contenders) {
        if (contender.wall_ms.size() > 0) {
            show_progress(label(contender.row));
            fill_times(contender, homogeneous_ms);
            const Variant& variant = *group.variants[contender.variant];
            if (!is_constant_fog(contender.method, variant))
                fill_accuracy(contender, *truths[contender.variant], *stage, scene);
            // Of maps; formulas alone have none.
            if (!variant.fogs.empty()) {
                const auto [found, is_new] = bounds.try_emplace(
                    {contender.variant, contender.method.name(), contender.method.mu});
                if (is_new)
                    found->second = certified_bound(
                        prepared_[contender.variant]->bounds, contender.method, scene.camera,
                        group.size.width, group.size.height, stage->limits);
                contender.row.bound_dT = found->second;
            }
        }
        results.rows.push_back(std::move(contender.row));
    }
    return {};
}

Row Measurement::empty_row(const Group& group, const Case& one) const {
    const Variant& variant = *group.variants[one.variant];
    Row row;
    row.scene = scenes_[group.scene].name;
    row.map = variant.map;
    row.map_width = variant.map_width;
    row.map_height = variant.map_height;
    row.basis = variant.basis;
    row.family = variant.family;
    row.levels = variant.levels;
    row.mu = one.method.mu;
    row.method = one.method.name();
    row.reused = one.reuse || options_.reuse;
    row.width = group.size.width;
    row.height = group.size.height;
    row.group = group.name;
    row.form = variant.form;
    return row;
}

void Measurement::prepare(const Group& group) {
    std::vector<std::unique_ptr<Prepared>> kept = std::move(prepared_);
    prepared_.clear();
    for (const auto& variant : group.variants) {
        const auto same = std::find_if(kept.begin(), kept.end(), [&](const auto& one) {
            return one && one->variant == variant;
        });
        prepared_.push_back(same == kept.end() ? std::make_unique<Prepared>() : std::move(*same));
        if (prepared_.back()->variant) continue;
        prepared_.back()->variant = variant;
        for (const Fog& fog : variant->fogs) prepared_.back()->bounds.emplace_back(fog);
    }
}

Result<FogPass> Measurement::make_pass(const Group& group, const Case& one,
                                       const SceneRenderer& renderer) {
    const Variant& variant = *group.variants[one.variant];
    std::vector<FogTextures>& textures = prepared_[one.variant]->textures;
    // The passes of a variant keep pointers to its textures: made once, never moved.
    if (textures.empty()) {
        textures.reserve(variant.fogs.size());
        for (const Fog& fog : variant.fogs) {
            Result<FogTextures> made = FogTextures::create(context_.gl(), fog);
            if (!made) {
                textures.clear();
                return tl::unexpected(made.error());
            }
            textures.push_back(*std::move(made));
        }
    }
    std::vector<const FogTextures*> fogs;
    for (const FogTextures& made : textures) fogs.push_back(&made);
    const BenchScene& drawn = scenes_[group.scene];
    if (is_constant_fog(one.method, variant)) {
        if (!constant_fog_) {
            const Result<Fog> fog = make_fog(Grid<float>::Ones(1, 1), {});
            if (!fog) return tl::unexpected(fog.error());
            Result<FogTextures> made = FogTextures::create(context_.gl(), *fog);
            if (!made) return tl::unexpected(made.error());
            constant_fog_ = *std::move(made);
        }
        return FogPass::create(context_.gl(), {&*constant_fog_}, one.method,
                               drawn.scene.fog_colour);
    }
    const bool with_particles = !drawn.particles.empty();
    Result<FogPass> pass =
        FogPass::create(context_.gl(), fogs, one.method, drawn.scene.fog_colour, drawn.scene.models,
                        channels_of(drawn.particles), &renderer);
    if (pass && with_particles)
        if (auto ok = pass->set_particles(drawn.particles); !ok) return tl::unexpected(ok.error());
    return pass;
}

void Measurement::estimate(std::vector<Contender>& contenders, const Stage& stage,
                           const Camera& camera) const {
    FrameTimer timer(context_.gl());
    const double pixels = double(stage.size.width) * stage.size.height;
    const double pilot_pixels = double(stage.pilot_size.width) * stage.pilot_size.height;
    for (Contender& contender : contenders) {
        show_progress(label(contender.row));
        const auto seconds_of = [&](const FrameTarget& frame, const Output& output) {
            if (!contender.reuse) contender.pass.forget();
            const auto draw = [&] {
                contender.pass.draw_colour(frame, camera, output.framebuffer.name());
            };
            return timer.time(draw).wall_ms * 1e-3;
        };
        double pilot = seconds_of(stage.pilot, stage.pilot_fogged);  // compiles
        if (pilot < kWarmUpSeconds) pilot = seconds_of(stage.pilot, stage.pilot_fogged);
        // Froxels and vertices cost the same at any picture size, all others by the pixel.
        const bool by_pixel =
            contender.method.kind != MethodKind::froxel && !contender.method.sampling.vertices;
        contender.estimate = by_pixel ? pilot * pixels / pilot_pixels : pilot;
        if (contender.estimate < kWarmUpSeconds)
            contender.estimate = seconds_of(stage.frame, stage.fogged);
    }
}

void Measurement::fill_times(Contender& contender, std::optional<double>& homogeneous_ms) const {
    const bool software = is_software(context_.renderer());
    const Samples& samples = software ? contender.wall_ms : contender.gpu_ms;
    Row& row = contender.row;
    row.frames = int(samples.size());
    row.ms_median = samples.median();
    row.ms_p05 = samples.percentile(5);
    row.ms_p95 = samples.percentile(95);
    row.fps = 1000 / *row.ms_median;
    row.gpu_ms_median = contender.gpu_ms.median();
    row.wall_ms_median = contender.wall_ms.median();
    if (row.method == homogeneous_method().name()) homogeneous_ms = row.ms_median;
    if (homogeneous_ms) row.ratio_homogeneous = *row.ms_median / *homogeneous_ms;
}

void Measurement::fill_accuracy(Contender& contender, const Truth& truth, const Stage& stage,
                                const Scene& scene) const {
    const Gl& gl = context_.gl();
    const GLuint target = stage.fine.framebuffer.name();
    contender.pass.draw_optical_depth(stage.frame, scene.camera, target);
    const Image tau = every_nth(
        read_texture(gl, stage.fine.texture.name(), stage.size.width, stage.size.height, 4),
        truth.stride);
    const Accuracy accuracy =
        measure_accuracy(truth, tau, every_nth(stage.scene_colour, truth.stride), scene.fog_colour);
    Row& row = contender.row;
    row.max_dT = accuracy.max_dT;
    row.p99_dT = accuracy.p99_dT;
    row.max_mean_dT = accuracy.max_mean_dT;
    row.p99_mean_dT = accuracy.p99_mean_dT;
    row.rmse_tau = accuracy.rmse_tau;
    row.psnr = accuracy.psnr;
    row.ssim = accuracy.ssim;
}

void Measurement::plan_frames(std::vector<Contender>& contenders, double seconds,
                              Results& results) const {
    std::vector<Contender*> by_cost;
    for (Contender& contender : contenders) by_cost.push_back(&contender);
    std::stable_sort(by_cost.begin(), by_cost.end(),
                     [](auto* a, auto* b) { return a->estimate < b->estimate; });
    // First a timed frame and one for the errors of as many cases as fit, the cheapest before all.
    double left = kPlanned * seconds;
    std::vector<Contender*> fitting;
    for (Contender* contender : by_cost)
        if (2 * contender->estimate <= left) {
            contender->frames = 1;
            left -= 2 * contender->estimate;
            fitting.push_back(contender);
        } else {
            results.cut.push_back(fmt::format("{}: a frame takes about {:.2g} s",
                                              label(contender->row), contender->estimate));
        }
    // Then more frames: what the cheap ones do not need is shared among the dearer ones.
    for (std::size_t i = 0; i < fitting.size(); ++i) {
        const double cost = std::max(fitting[i]->estimate, 1e-6);
        const int wanted = options_.frames.value_or(
            std::clamp(int(std::min(kCaseSeconds / cost, 1e6)), kLeastFrames, kFrames));
        const double share = left / double(fitting.size() - i);
        const int more = std::min(wanted - 1, int(std::min(share / cost, 1e6)));
        fitting[i]->frames += more;
        left -= more * cost;
    }
}

void Measurement::take_turns(const Group& group, std::vector<Contender>& contenders,
                             const Stage& stage, double seconds) {
    const auto begin = std::chrono::steady_clock::now();
    const Camera& camera = scenes_[group.scene].scene.camera;
    const GLuint target = stage.fogged.framebuffer.name();
    FrameTimer timer(context_.gl());
    const auto draw = [&](Contender& contender) {
        if (!contender.reuse) contender.pass.forget();
        return timer.time([&] { contender.pass.draw_colour(stage.frame, camera, target); });
    };
    int rounds = 0;
    for (const Contender& contender : contenders) rounds = std::max(rounds, contender.frames);
    const double done_before = done_;
    for (int round = 0; round < rounds; ++round)
        for (std::size_t k = 0; k < contenders.size(); ++k) {
            // Whoever comes first in a round may meet other caches and clocks than the last.
            Contender& contender = contenders[(k + std::size_t(round)) % contenders.size()];
            const auto due = [&](int r) {
                return std::int64_t(r) * contender.frames / std::max(rounds, 1);
            };
            if (due(round + 1) == due(round)) continue;
            done_ = done_before + group_share_ * round / rounds;
            const std::chrono::duration<double> used = std::chrono::steady_clock::now() - begin;
            // Estimates can be wrong; a case that has a frame waits for those that have none.
            if (used.count() > seconds && contender.wall_ms.size() > 0) continue;
            show_progress(
                fmt::format("{}, frame {} of {}", label(contender.row), round + 1, rounds));
            const FrameTime time = draw(contender);
            contender.gpu_ms.add(time.gpu_ms);
            contender.wall_ms.add(time.wall_ms);
        }
    done_ = done_before;
}

}  // namespace wavefog::cli
