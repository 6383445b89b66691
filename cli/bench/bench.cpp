// wavefog bench: methods against each other, in time, error and memory.
#include <fmt/format.h>

#include <memory>

#include "bench/charts.h"
#include "bench/compression.h"
#include "bench/measure.h"
#include "bench/motion.h"
#include "bench/output.h"
#include "bench/plan.h"
#include "bench/provenance.h"
#include "bench/readme.h"
#include "bench/scale.h"
#include "bench/stability.h"
#include "command.h"
#include "files.h"

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

struct BenchOptions {
    std::vector<fs::path> scenes, maps;
    fs::path output, from, readme;
    PlanOptions plan;
    MeasureOptions measure;
    std::string context = "osmesa";
    bool json = false;
};

Result<void> check_usage(const BenchOptions& options) {
    const bool stored = !options.from.empty() || !options.readme.empty();
    if (stored && !options.scenes.empty())
        return usage_error("bench: --from and --readme take stored results; leave the scenes out");
    if (!options.from.empty() && !options.readme.empty())
        return usage_error("bench: --readme finds its result files itself; leave --from out");
    const bool own_maps =
        options.plan.preset == Preset::stability || options.plan.preset == Preset::motion;
    const bool no_budget = options.plan.preset == Preset::stability;
    if (own_maps &&
        ((no_budget && options.measure.seconds) || options.measure.frames || options.plan.size ||
         !options.plan.methods.empty() || !options.plan.mus.empty() ||
         !options.plan.levels.empty() || !options.scenes.empty()))
        return usage_error(
            fmt::format("bench: preset {} studies maps and sizes of its own; leave out scenes, "
                        "--methods, --mu, --levels, --size{} --frames{}",
                        preset_names[std::size_t(options.plan.preset)], no_budget ? "," : " and",
                        no_budget ? " and --budget" : ""));
    const bool needs_scene = !stored && !own_maps && options.plan.preset != Preset::compression;
    if (needs_scene && options.scenes.empty())
        return usage_error("bench: name a scene file, e.g. data/scenes/bench64.json");
    if (!options.maps.empty() && options.plan.preset != Preset::scale)
        return usage_error("bench: --map is for --preset scale; name the picture in the scene");
    if (options.maps.size() > options.scenes.size())
        return usage_error(fmt::format("bench: {} --map for {} scenes; give one a scene, in order",
                                       options.maps.size(), options.scenes.size()));
    return {};
}

/// Warns of what is missing; the whole lists stand in results.json.
void tell_omissions(const Results& results) {
    const auto tell = [](const std::vector<std::string>& list, const char* what) {
        if (!list.empty())
            warn(fmt::format("{} {}, the first: {}", list.size(), what, list.front()));
    };
    tell(results.cut, "left out for want of time");
    tell(results.skipped, "could not be measured");
}

Result<Results> measure_compression(const BenchOptions& options) {
    for (const fs::path& file : options.scenes)
        if (auto ok = check_input(file); !ok) return tl::unexpected(ok.error());
    Results results;
    if (auto ok = study_compression(options.scenes, results); !ok)
        return tl::unexpected(ok.error());
    const Result<std::unique_ptr<Context>> context = create_context(options.context);
    if (!context) return tl::unexpected(context.error());
    results.provenance =
        provenance(**context, preset_names[std::size_t(options.plan.preset)], options.scenes);
    results.provenance["clock"] = "wall time, of programs with their start and their files";
    return results;
}

Result<Results> measure(const BenchOptions& options) {
    if (options.plan.preset == Preset::compression) return measure_compression(options);
    Results results;
    std::vector<BenchScene> scenes;
    std::vector<fs::path> files;
    for (const fs::path& file : options.scenes) {
        if (auto ok = check_input(file); !ok) return tl::unexpected(ok.error());
        Result<BenchScene> scene = load_bench_scene(file);
        if (!scene) return tl::unexpected(scene.error());
        const bool formulas_will_do =
            options.plan.preset == Preset::resolution || options.plan.preset == Preset::models;
        if (scene->scene.fogs.empty() &&
            (!formulas_will_do || (scene->scene.models.empty() && scene->particles.empty()))) {
            results.skipped.push_back(file.string() + ": the scene has no wavelet fog to measure");
            continue;
        }
        for (fs::path& named : files_of_scene(file)) files.push_back(std::move(named));
        const auto number = std::size_t(&file - options.scenes.data());
        if (number < options.maps.size()) {
            if (auto ok = put_map(*scene, options.maps[number]); !ok)
                return tl::unexpected(ok.error());
            files.push_back(options.maps[number]);
        }
        scenes.push_back(*std::move(scene));
    }
    if (scenes.empty() && !results.skipped.empty())
        return data_error(results.skipped.front() + "; add one");
    if (options.plan.preset == Preset::scale) scenes = scale_scenes(scenes);
    const Result<std::unique_ptr<Context>> context = create_context(options.context);
    if (!context) return tl::unexpected(context.error());
    if (options.plan.preset == Preset::stability) {
        if (auto ok = study_stability(**context, results); !ok) return tl::unexpected(ok.error());
    } else if (options.plan.preset == Preset::motion) {
        if (auto ok = study_motion(**context, options.measure.seconds.value_or(25), results); !ok)
            return tl::unexpected(ok.error());
    } else {
        const Result<std::vector<Group>> groups = plan(scenes, options.plan, results.cut);
        if (!groups) return tl::unexpected(groups.error());
        Measurement measurement(**context, scenes, options.measure);
        if (auto ok = measurement.run(*groups, results); !ok) return tl::unexpected(ok.error());
    }
    results.provenance =
        provenance(**context, preset_names[std::size_t(options.plan.preset)], files);
    return results;
}

Result<void> run_readme(const fs::path& file) {
    if (auto ok = check_input(file); !ok) return ok;
    const Result<std::string> filled = fill_readme(read_text(file), file.parent_path());
    if (!filled)
        return tl::unexpected(
            Error{filled.error().kind, file.string() + ": " + filled.error().message});
    return write_text(file, *filled);
}

Result<void> bench(BenchOptions& options) {
    if (auto ok = check_usage(options); !ok) return ok;
    if (!options.readme.empty()) return run_readme(options.readme);
    if (!options.output.empty())
        if (auto ok = check_output_directory(options.output); !ok) return ok;
    if (!options.measure.seconds && preset_seconds(options.plan.preset) > 0)
        options.measure.seconds = preset_seconds(options.plan.preset);

    const Result<Results> results =
        options.from.empty() ? measure(options) : read_results(options.from);
    if (!results) return tl::unexpected(results.error());
    if (options.from.empty()) tell_omissions(*results);
    if (options.json)
        fmt::print("{}\n", to_json(*results).dump(2));
    else
        fmt::print("{}", report_text(*results, false));
    if (options.output.empty()) return {};
    return write_results(*results, figures_of(*results), options.output);
}

}  // namespace

Command add_bench(CLI::App& root) {
    auto options = std::make_shared<BenchOptions>();
    CLI::App* app =
        root.add_subcommand("bench", "Measure methods against each other: time, error, memory");
    app->add_option("SCENE", options->scenes,
                    "Scene files (.json); of --preset compression pictures");
    app->add_option(
           "-o,--output", options->output,
           "Folder for results.json, results.csv and charts (.svg, .png); none: print only")
        ->type_name("DIR");
    add_choice(*app, "--preset", options->plan.preset, preset_names, "What to measure (none)");
    add_parsed(*app, "--methods", options->plan.methods, parse_methods, "M,M,...",
               "Methods (the preset's, or radial,radial:step,exact,march:32,march:256); "
               "homogeneous is always "
               "there");
    add_parsed(*app, "--mu", options->plan.mus, parse_mus, "MU,MU,...",
               "Each method that has a mu is measured at all of these (1)");
    add_parsed(*app, "--levels", options->plan.levels, parse_level_list, "N,N,...",
               "Decompose the scenes' fogs into each of these numbers of levels (the scenes')");
    add_parsed(*app, "--size", options->plan.size, parse_size, "WxH",
               "Pixels (the scene's; chart and paper-tables: 800x600)");
    add_parsed(
        *app, "--frames", options->measure.frames,
        [](const std::string& text) { return parse_integer_in(text, 1, 10000); }, "N",
        "Timed frames of each method (40, fewer where a frame is slow)");
    add_parsed(
        *app, "--budget", options->measure.seconds,
        [](const std::string& text) { return parse_number_in(text, 0.001, 1e6); }, "SECONDS",
        "Take about this long and tell what was left out (chart and paper-tables: 780, motion: "
        "25)");
    app->add_flag("--reuse", options->measure.reuse,
                  "Let method radial keep its table, as a camera at rest does (it is filled anew "
                  "each frame)");
    app->add_option("--map", options->maps,
                    "scale: the picture of the first scene's first map, again for the second "
                    "scene's, and so on (the scenes')")
        ->type_name("IMAGE")
        ->allow_extra_args(false);
    add_context(*app, options->context);
    app->add_option("--from", options->from, "Print and draw stored results instead of measuring")
        ->type_name("results.json");
    app->add_option("--readme", options->readme,
                    "Fill what stands between <!-- bench FILE --> and <!-- /bench --> with the "
                    "tables of that results file")
        ->type_name("README.md");
    app->add_flag("--json", options->json, "Print the results as JSON");
    app->footer(
        R"(All methods of a scene take turns frame by frame, beside `homogeneous`, the least that a
fog pass costs; times are of the fog pass alone, as medians with the 5th and 95th
percentile. Errors are against the reference integrator in double, in every pixel, with
all details (mu = 1): |T - T_true|, optical depth, and PSNR and SSIM (11x11 Gaussian,
sigma 1.5) of the sRGB picture.
Presets: speed (few methods, one table), chart (every method over its knob: cost against
error), paper-tables (tables 1 to 3 of paper 004 beside ours; the first scene with its map
averaged to 16x16, 32x32 and 64x64), stability (where methods fail; needs no scene), scale
(the first map of each scene, or a --map in its place, at 64x64 to 4096x4096, mirrored where
it is smaller, from five cameras, at --size and 1920x1080), compression (.wfog files beside
image codecs that are installed, on pictures), motion (what maps that change and particles
cost a frame; needs no scene), resolution (fog in reduced pictures and at vertices), models
(each scene's fogs beside constant fog).
Charts need gnuplot.

Example:
  wavefog bench data/scenes/bench64.json --preset speed -o out/speed)");
    return {app, [options] { return bench(*options); }};
}

}  // namespace wavefog::cli
