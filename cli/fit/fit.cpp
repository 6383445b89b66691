// wavefog fit: model no more than a scene needs.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>

#include "bench/output.h"
#include "bench/provenance.h"
#include "command.h"
#include "files.h"
#include "fit/choose.h"
#include "fogs.h"
#include "interrupt.h"
#include "options.h"
#include "report.h"
#include "wavefog/fogmap/fog_file.h"
#include "wavefog/gpu/context.h"

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

constexpr double kLeastError = 1e-7;  ///< float32 rounds T to as much

struct FitOptions {
    fs::path input, output;
    double max_error = 0;
    std::optional<double> target_ms;
    std::optional<Size> size;
    std::string context = "osmesa";
    bool json = false;
};

fs::path fog_name(const fs::path& output, std::size_t index) {
    return output.parent_path() / fmt::format("{}.fog{}.exr", output.stem().string(), index);
}

/// The maps as they lie in their files, and what they err.
struct Saved {
    bool half = false;
    Worst tuning, held_out, whole;

    double error() const { return std::max({tuning.error, held_out.error, whole.error}); }
};

Result<Saved> save_maps(const Gl& gl, const Scene& scene, const FitViews& views,
                        const FitChoice& chosen, const FitOptions& options, bool half) {
    std::vector<Fog> saved;
    for (std::size_t i = 0; i < chosen.maps.fogs.size(); ++i) {
        Fog fog = chosen.maps.fogs[i];
        if (half) fog.decomposition = to_scaling_form(fog.decomposition);
        SaveOptions save;
        save.half = half;
        const fs::path file = fog_name(options.output, chosen.maps.which[i]);
        if (auto ok = save_fog(file, fog, save); !ok) return tl::unexpected(ok.error());
        Result<Fog> loaded = load_fog(file);
        if (!loaded) return tl::unexpected(loaded.error());
        saved.push_back(*std::move(loaded));
    }
    const auto textures = make_textures(gl, saved);
    if (!textures) return tl::unexpected(textures.error());
    Result<FogPass> pass = make_pass(gl, *textures, chosen.method, scene, chosen.maps.models);
    if (!pass) return tl::unexpected(pass.error());
    Saved result;
    result.half = half;
    for (const auto& [seen, worst] :
         {std::pair(&views.tuning, &result.tuning), std::pair(&views.held_out, &result.held_out),
          std::pair(&views.whole, &result.whole)}) {
        Result<Worst> made = largest_error(gl, *pass, *seen);
        if (!made) return tl::unexpected(made.error());
        *worst = *std::move(made);
    }
    return result;
}

/// Half floats if they keep the promise too, else floats.
Result<Saved> save_maps(const Gl& gl, const Scene& scene, const FitViews& views,
                        const FitChoice& chosen, const FitOptions& options) {
    const Result<Saved> half = save_maps(gl, scene, views, chosen, options, true);
    if (!half || half->error() <= options.max_error) return half;
    return save_maps(gl, scene, views, chosen, options, false);
}

/// The scene's JSON with other fogs and method; its files named from where it now lies.
Facts rewritten(const fs::path& input, const FitOptions& options, const FitChoice& chosen) {
    Facts json = Facts::parse(read_text(input));
    const auto rebase = [&](Facts& value) {
        const fs::path file = input.parent_path() / value.get<std::string>();
        const fs::path base = fs::absolute(options.output).parent_path();
        value = fs::absolute(file).lexically_normal().lexically_proximate(base).string();
    };
    if (json.contains("terrain")) rebase(json["terrain"]["heightmap"]);
    if (json.contains("meshes"))
        for (Facts& mesh : json["meshes"]) rebase(mesh["file"]);
    std::size_t map = 0;
    Facts kept = Facts::array();
    for (Facts& fog : json["fog"]) {
        bool none = false;
        if (fog.value("model", "wavelet") == "wavelet") {
            for (const Formula& formula : chosen.maps.formulas) {
                if (formula.fog != map) continue;
                none = formula.name == kNoFog;
                fog = formula_json(formula.model);
            }
            for (const std::size_t which : chosen.maps.which)
                if (which == map)
                    fog = {{"model", "wavelet"},
                           {"file", fog_name(options.output, map).filename()}};
            ++map;
        }
        if (!none) kept.push_back(std::move(fog));
    }
    json["fog"] = std::move(kept);
    json["method"] = {{"name", chosen.method.name()}, {"mu", chosen.method.mu}};
    return json;
}

Facts fog_rows(const Scene& scene, const FitMaps& maps) {
    Facts rows = Facts::array();
    for (std::size_t fog = 0; fog < scene.fogs.size(); ++fog) {
        const Decomposition<float>& before = scene.fogs[fog].decomposition;
        Facts row = {{"fog", fog},
                     {"size", fmt::format("{}x{}", before.width, before.height)},
                     {"basis", basis_name(before.degree())},
                     {"kept", "none: a formula"},
                     {"kept_basis", "-"},
                     {"kept_family", "-"},
                     {"finest_levels_dropped", "all"}};
        for (const Formula& formula : maps.formulas)
            if (formula.fog == fog && formula.name == kNoFog) row["kept"] = "none: no fog";
        for (std::size_t i = 0; i < maps.fogs.size(); ++i) {
            if (maps.which[i] != fog) continue;
            const Decomposition<float>& after = maps.fogs[i].decomposition;
            row["kept"] = fmt::format("{}x{}", after.width, after.height);
            row["kept_basis"] = basis_name(after.degree());
            row["kept_family"] = after.family.name();
            row["finest_levels_dropped"] = maps.dropped[i];
        }
        rows.push_back(std::move(row));
    }
    return rows;
}

template <class Number>
Facts before_after(Number before, Number after) {
    Facts facts = {{"before", before}, {"after", after}};
    if (after > 0) facts["ratio"] = double(before) / double(after);
    return facts;
}

/// What a formula saves is said in words.
std::string advice(const Scene& scene, const std::vector<Formula>& formulas) {
    std::string text;
    for (const Formula& formula : formulas) {
        if (scene.fogs.size() == 1)
            return formula.words + " already satisfies this scene: it needs no map";
        text += fmt::format("{}{} already does for fog {}: it needs no map",
                            text.empty() ? "" : "; ", formula.words, formula.fog);
    }
    return text;
}

/// "every pixel of 2 cameras at 800x600"
std::string checked_words(const Scene& scene, const Size& size) {
    const std::size_t cameras = cameras_of(scene).size();
    return fmt::format("{} of {} camera{} at {}x{}", whole_words(size), cameras,
                       cameras == 1 ? "" : "s", size.width, size.height);
}

Facts facts_of(const Scene& scene, const FitChoice& chosen, const FitOptions& options,
               const Saved& saved, const Size& size) {
    FitMaps before;
    before.fogs = scene.fogs;
    const std::size_t bytes_each = saved.half ? 2 : 4;
    std::uintmax_t file_bytes_after = 0;
    for (const std::size_t fog : chosen.maps.which)
        for (const fs::path& file : fog_files(fog_name(options.output, fog)))
            file_bytes_after += file_bytes(file);
    Facts facts = {{"wrote", options.output.string()}};
    if (const std::string words = advice(scene, chosen.formulas); !words.empty())
        facts["advice"] = words;
    facts.update({{"method", chosen.method.name()},
                  {"mu", chosen.method.mu},
                  {"max_error", options.max_error},
                  {"max_dT_tuning", saved.tuning.error},
                  {"max_dT_held_out", saved.held_out.error},
                  {"max_dT_own_cameras", saved.whole.error},
                  {"own_cameras_checked", checked_words(scene, size)},
                  {"cameras", 1 + scene.cameras.size()},
                  {"ms", before_after(chosen.before_ms, chosen.ms)},
                  {"gpu_bytes", before_after(chosen.before_gpu_bytes, chosen.gpu_bytes)},
                  {"coefficient_bytes", before_after(4 * before.coefficients(),
                                                     bytes_each * chosen.maps.coefficients())}});
    if (!chosen.maps.fogs.empty()) {
        facts["precision"] = saved.half ? "half" : "float";
        facts["file_bytes"] = file_bytes_after;
    }
    facts["fogs"] = fog_rows(scene, chosen.maps);
    facts["why"] = chosen.why;
    facts["kept_the_error"] = chosen.kept;
    if (options.json) facts["missed_the_error"] = chosen.missed;
    return facts;
}

Result<void> check_files(const FitOptions& options, const Scene& scene) {
    if (auto ok = check_output(options.output, {options.input}, {".json"}); !ok) return ok;
    std::vector<fs::path> inputs = files_of_scene(options.input);
    for (std::size_t i = 0; i < scene.fogs.size(); ++i)
        if (auto ok = check_output(fog_name(options.output, i), inputs, {".exr"}); !ok) return ok;
    return {};
}

Result<void> fit(const FitOptions& options) {
    if (auto ok = check_input(options.input); !ok) return ok;
    const Result<Scene> scene = load_grey_scene(options.input);
    if (!scene) return tl::unexpected(scene.error());
    if (scene->fogs.empty())
        return data_error(options.input.string() +
                          (scene->models.empty()
                               ? ": the scene has no map of fog (\"fog\" with an \"image\" or "
                                 "\"file\") to fit; add one"
                               : ": all fogs are formulas, which are exact and cost least as they "
                                 "are: there is nothing to fit; use the scene itself"));
    if (!scene->sequences.empty())
        return data_error(scene->sequences.front().place +
                          ": a map that changes cannot be fitted; give one \"image\"");
    if (!scene->particles.empty())
        warn(options.input.string() +
             ": particles stay in the scene and are left out of the fit; they only dim what lies "
             "behind, so that no |dT| grows by them");
    if (auto ok = check_files(options, *scene); !ok) return ok;
    const Size size = options.size.value_or(Size{scene->width, scene->height});
    const Result<std::unique_ptr<Context>> context = create_context(options.context);
    if (!context) return tl::unexpected(context.error());
    const Gl& gl = (*context)->gl();

    const Result<FitViews> views = fit_views(gl, *scene, size);
    if (!views) return tl::unexpected(views.error());
    const Result<FitChoice> chosen =
        choose(gl, *scene, *views, {options.max_error, options.target_ms, size});
    if (!chosen) return tl::unexpected(chosen.error());

    const HoldInterrupts hold;
    const Result<Saved> saved = save_maps(gl, *scene, *views, *chosen, options);
    if (!saved) return tl::unexpected(saved.error());
    const std::string text = rewritten(options.input, options, *chosen).dump(2) + "\n";
    if (auto ok = write_text(options.output, text); !ok) return ok;
    if (options.target_ms && chosen->ms > *options.target_ms)
        warn(fmt::format("--target {}: the fastest setting within the error takes {:.3g} ms here",
                         *options.target_ms, chosen->ms));
    print_facts(facts_of(*scene, *chosen, options, *saved, size), options.json);
    return {};
}

}  // namespace

Command add_fit(CLI::App& root) {
    auto options = std::make_shared<FitOptions>();
    CLI::App* app = root.add_subcommand("fit", "Find the cheapest settings that keep an error");
    app->add_option("SCENE", options->input, "A scene file (.json)")->required();
    app->add_option("-o,--output", options->output,
                    "The scene to write; its fogs come beside it as OUT.fogN.exr")
        ->required()
        ->type_name("OUT.json");
    add_parsed(
        *app, "--max-error", options->max_error,
        [](const std::string& text) -> Result<double> {
            const Result<double> value = parse_fraction(text);
            if (value && (*value < kLeastError || *value > 1))
                return usage_error(
                    fmt::format("{} is out of range; use {} to 1", text, kLeastError));
            return value;
        },
        "E", "The largest |dT| allowed, e.g. 1/510: half a step of an 8-bit picture")
        ->required();
    add_parsed(
        *app, "--target", options->target_ms,
        [](const std::string& text) { return parse_number_in(text, 1e-3, 1e6); }, "MS",
        "The least error within this time a frame, rather than the least time");
    add_parsed(*app, "--size", options->size, parse_size, "WxH",
               "Pixels of the frames that are timed and checked in full (the scene's)");
    add_context(*app, options->context);
    app->add_flag("--json", options->json, "Print the report as JSON");
    app->footer(
        R"(Puts a formula (none at all, homogeneous, halfspace, layers) in place of a map where that
will do, leaves out levels of detail, changes basis and family, drops detail with distance
(mu) and changes the method as far as the error allows, on the scene's cameras and two
views beside each, all drawn small; times what is left at --size (a frame is that of the
slowest camera); checks the choice on three more small views a camera that it has not
seen, and in every pixel that the scene's own cameras have at --size (up to 3840x2160; of
larger pictures in one pixel of each 2x2, 3x3 ... as the report says), against the
reference of the scene as it was; searches again for less if one errs too much; and
writes a scene with it. The report says what was kept and why, and what it cost before
and after.

Example:
  wavefog fit data/scenes/bench64.json --max-error 0.002 -o out/small.json)");
    return {app, [options] { return fit(*options); }};
}

}  // namespace wavefog::cli
