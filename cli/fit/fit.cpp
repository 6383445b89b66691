// wavefog fit: model no more than a scene needs.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "bench/output.h"
#include "bench/provenance.h"
#include "bench/variant.h"
#include "command.h"
#include "files.h"
#include "fit/search.h"
#include "interrupt.h"
#include "options.h"
#include "report.h"
#include "wavefog/fogmap/fog_file.h"
#include "wavefog/gpu/context.h"

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

// Pixels of a view: the truth takes microseconds a pixel.
constexpr double kViewPixels = 30000;
// Dropped details may use this share of the error, the method the rest.
constexpr double kMapShare = 0.7;
// If unseen views err more than allowed, the goal is tightened by this, so often.
constexpr double kTighten = 0.6;
constexpr int kTries = 4;
constexpr double kClose = 1.25;

struct FitOptions {
    fs::path input, output;
    double max_error = 0;
    std::optional<double> target_ms;
    std::optional<Size> size;
    std::string context = "osmesa";
    bool json = false;
};

/// What was chosen, and what it does on views that it was not chosen on.
struct Verified {
    FitMaps maps;
    Method method;
    double tuning_error = 0, held_out_error = 0;
    double ms = 0, before_ms = 0;
    std::size_t gpu_bytes = 0, before_gpu_bytes = 0;
    Facts tried = Facts::array();
};

Size view_size(const Size& size) {
    const double scale =
        std::min(1.0, std::sqrt(kViewPixels / (double(size.width) * double(size.height))));
    return {std::max(int(size.width * scale), 1), std::max(int(size.height * scale), 1)};
}

Facts row_of(const FitSearch& search, const FitSetting& setting) {
    const FitMaps& maps = search.maps()[setting.maps];
    const Decomposition<float>& d = maps.fogs.front().decomposition;
    return {{"method", setting.method.name()},
            {"mu", setting.method.mu},
            {"map", fmt::format("{}x{} {}", d.width, d.height, basis_name(d.degree()))},
            {"ms", setting.ms.value_or(0)},
            {"max_dT", setting.error},
            {"gpu_bytes", setting.pass.bytes()}};
}

/// The settings in the order in which they are to be chosen.
std::vector<FitSetting*> by_preference(FitSearch& search, const std::optional<double>& target_ms) {
    std::vector<FitSetting*> order;
    for (FitSetting& setting : search.settings()) order.push_back(&setting);
    // Times this close are noise: the least memory decides.
    const double least = order.empty() ? 0 : *order.front()->ms;
    const auto close = std::stable_partition(
        order.begin(), order.end(), [&](const auto* s) { return *s->ms <= kClose * least; });
    std::stable_sort(order.begin(), close, [](const auto* a, const auto* b) {
        return a->pass.bytes() < b->pass.bytes();
    });
    if (target_ms)
        std::stable_sort(order.begin(), order.end(), [&](const auto* a, const auto* b) {
            const bool a_fits = *a->ms <= *target_ms, b_fits = *b->ms <= *target_ms;
            if (a_fits != b_fits) return a_fits;
            return a_fits ? a->error < b->error : *a->ms < *b->ms;
        });
    return order;
}

/// Settings are tuned on the first views and checked on the second.
struct Views {
    std::vector<View> tuning, held_out;
};

Result<Views> views_of(const Gl& gl, const Scene& scene, const Size& size) {
    const Result<std::vector<Fog>> truth = undecomposed(scene.fogs);
    if (!truth) return tl::unexpected(truth.error());
    const Size small = view_size(size);
    auto tuning = make_views(gl, scene, *truth, tuning_cameras(scene.camera), small);
    if (!tuning) return tl::unexpected(tuning.error());
    auto held_out = make_views(gl, scene, *truth, held_out_cameras(scene.camera), small);
    if (!held_out) return tl::unexpected(held_out.error());
    return Views{*std::move(tuning), *std::move(held_out)};
}

Result<Verified> search_scene(const Gl& gl, const Scene& scene, const Views& views,
                              const FitOptions& options, const Size& size) {
    double goal = options.max_error;
    for (int attempt = 0; attempt < kTries; ++attempt, goal *= kTighten) {
        FitSearch search(gl, scene, views.tuning);
        if (auto ok = search.simplify(goal * kMapShare); !ok) return tl::unexpected(ok.error());
        if (auto ok = search.try_methods(goal); !ok) return tl::unexpected(ok.error());
        if (auto ok = search.time(size); !ok) return tl::unexpected(ok.error());
        Verified verified;
        for (const FitSetting& setting : search.settings()) {
            verified.tried.push_back(row_of(search, setting));
            if (setting.maps != 0 || setting.method.kind != MethodKind::exact ||
                setting.method.mu < 1)
                continue;
            verified.before_ms = *setting.ms;
            verified.before_gpu_bytes = setting.pass.bytes();
        }
        for (FitSetting* setting : by_preference(search, options.target_ms)) {
            const Result<double> unseen = largest_error(gl, setting->pass, views.held_out);
            if (!unseen) return tl::unexpected(unseen.error());
            if (*unseen > options.max_error) continue;
            verified.maps = search.maps()[setting->maps];
            verified.method = setting->method;
            verified.tuning_error = setting->error;
            verified.held_out_error = *unseen;
            verified.ms = *setting->ms;
            verified.gpu_bytes = setting->pass.bytes();
            return verified;
        }
    }
    return data_error(fmt::format(
        "no setting keeps |dT| below {}: float32 itself errs up to 2e-6; allow a larger "
        "--max-error",
        options.max_error));
}

fs::path fog_name(const fs::path& output, std::size_t index) {
    return output.parent_path() / fmt::format("{}.fog{}.exr", output.stem().string(), index);
}

/// Half floats if they keep the promise too, else floats.
Result<bool> save_maps(const Gl& gl, const Scene& scene, const Views& views, const Verified& chosen,
                       const FitOptions& options) {
    for (const bool half : {true, false}) {
        std::vector<Fog> saved;
        for (std::size_t i = 0; i < chosen.maps.fogs.size(); ++i) {
            Fog fog = chosen.maps.fogs[i];
            if (half) fog.decomposition = to_scaling_form(fog.decomposition);
            SaveOptions save;
            save.half = half;
            const fs::path file = fog_name(options.output, i);
            if (auto ok = save_fog(file, fog, save); !ok) return tl::unexpected(ok.error());
            Result<Fog> loaded = load_fog(file);
            if (!loaded) return tl::unexpected(loaded.error());
            saved.push_back(*std::move(loaded));
        }
        if (!half) return false;
        bool keeps = true;
        for (const std::vector<View>* seen : {&views.tuning, &views.held_out}) {
            const Result<double> error = largest_error(gl, scene, saved, chosen.method, *seen);
            if (!error) return tl::unexpected(error.error());
            keeps = keeps && *error <= options.max_error;
        }
        if (keeps) return true;
    }
    return false;
}

/// The scene's JSON with other fogs and method; its files named from where it now lies.
Facts rewritten(const fs::path& input, const FitOptions& options, const Verified& chosen) {
    Facts json = Facts::parse(read_text(input));
    const auto rebase = [&](Facts& value) {
        const fs::path file = input.parent_path() / value.get<std::string>();
        const fs::path base = fs::absolute(options.output).parent_path();
        value = fs::absolute(file).lexically_normal().lexically_proximate(base).string();
    };
    if (json.contains("terrain")) rebase(json["terrain"]["heightmap"]);
    if (json.contains("meshes"))
        for (Facts& mesh : json["meshes"]) rebase(mesh["file"]);
    Facts models = Facts::array();  // formulas stay as they are
    for (const Facts& fog : json["fog"])
        if (fog.value("model", "wavelet") != "wavelet") models.push_back(fog);
    json["fog"] = Facts::array();
    for (std::size_t i = 0; i < chosen.maps.fogs.size(); ++i) {
        Facts fog = {{"model", "wavelet"}, {"file", fog_name(options.output, i).filename()}};
        const auto& wind = chosen.maps.fogs[i].wind;
        if (wind[0] != 0 || wind[1] != 0) fog["wind"] = wind;
        json["fog"].push_back(fog);
    }
    for (Facts& model : models) json["fog"].push_back(std::move(model));
    json["method"] = {{"name", chosen.method.name()}, {"mu", chosen.method.mu}};
    return json;
}

std::uintmax_t bytes_of_maps(const Scene& scene) {
    std::uintmax_t bytes = 0;
    for (const Fog& fog : scene.fogs)
        bytes += sizeof(float) * std::uintmax_t(fog.decomposition.width) *
                 std::uintmax_t(fog.decomposition.height);
    return bytes;
}

Facts kept_rows(const Scene& scene, const Verified& chosen) {
    Facts rows = Facts::array();
    for (std::size_t i = 0; i < scene.fogs.size(); ++i) {
        const Decomposition<float>& before = scene.fogs[i].decomposition;
        const Decomposition<float>& after = chosen.maps.fogs[i].decomposition;
        rows.push_back({{"fog", i},
                        {"size", fmt::format("{}x{}", before.width, before.height)},
                        {"kept", fmt::format("{}x{}", after.width, after.height)},
                        {"finest_levels_dropped", chosen.maps.dropped[i]},
                        {"basis", basis_name(before.degree())},
                        {"kept_basis", basis_name(after.degree())}});
    }
    return rows;
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
    const Result<Scene> scene = load_scene(options.input);
    if (!scene) return tl::unexpected(scene.error());
    if (scene->fogs.empty())
        return data_error(options.input.string() +
                          ": the scene has no wavelet fog to fit; add one");
    if (auto ok = check_files(options, *scene); !ok) return ok;
    const Size size = options.size.value_or(Size{scene->width, scene->height});
    const Result<std::unique_ptr<Context>> context = create_context(options.context);
    if (!context) return tl::unexpected(context.error());
    const Gl& gl = (*context)->gl();

    const Result<Views> views = views_of(gl, *scene, size);
    if (!views) return tl::unexpected(views.error());
    const Result<Verified> chosen = search_scene(gl, *scene, *views, options, size);
    if (!chosen) return tl::unexpected(chosen.error());

    const HoldInterrupts hold;
    const Result<bool> half = save_maps(gl, *scene, *views, *chosen, options);
    if (!half) return tl::unexpected(half.error());
    const std::string text = rewritten(options.input, options, *chosen).dump(2) + "\n";
    if (auto ok = write_text(options.output, text); !ok) return ok;

    std::uintmax_t bytes = 0;
    for (std::size_t i = 0; i < scene->fogs.size(); ++i)
        for (const fs::path& file : fog_files(fog_name(options.output, i)))
            bytes += file_bytes(file);
    const bool homogeneous = chosen->method.kind == MethodKind::homogeneous;
    Facts facts = {{"wrote", options.output.string()},
                   {"max_error", options.max_error},
                   {"max_dT_tuning", chosen->tuning_error},
                   {"max_dT_held_out", chosen->held_out_error},
                   {"method", chosen->method.name()},
                   {"mu", chosen->method.mu},
                   {"precision", *half ? "half" : "float"},
                   {"ms", chosen->ms},
                   {"ms_before", chosen->before_ms},
                   {"gpu_bytes", chosen->gpu_bytes},
                   {"gpu_bytes_before", chosen->before_gpu_bytes},
                   {"file_bytes", bytes},
                   {"map_bytes_before", bytes_of_maps(*scene)},
                   {"fogs", kept_rows(*scene, *chosen)},
                   {"tried", chosen->tried}};
    if (homogeneous)
        facts["advice"] =
            "plain homogeneous fog draws these views as well: this scene needs no map";
    if (options.target_ms && chosen->ms > *options.target_ms)
        warn(fmt::format("--target {}: the fastest setting within the error takes {:.3g} ms here",
                         *options.target_ms, chosen->ms));
    print_facts(facts, options.json);
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
        [](const std::string& text) { return parse_number_in(text, 1e-7, 1); }, "E",
        "The largest |dT| allowed, e.g. 0.002: half a step of an 8-bit picture")
        ->required();
    add_parsed(
        *app, "--target", options->target_ms,
        [](const std::string& text) { return parse_number_in(text, 1e-3, 1e6); }, "MS",
        "The least error within this time a frame, rather than the least time");
    add_parsed(*app, "--size", options->size, parse_size, "WxH",
               "Pixels of the timed frames (the scene's)");
    add_context(*app, options->context);
    app->add_flag("--json", options->json, "Print the report as JSON");
    app->footer(
        "Leaves out levels of detail, lowers the basis, drops detail with distance (mu) and\n"
        "changes the method as far as the error allows, on the scene's camera and two beside it;\n"
        "times what is left; checks the choice on three views that it has not seen against the\n"
        "reference; and writes a scene with it. The report says what was kept, and what it cost\n"
        "before and after.\n"
        "\n"
        "Example:\n"
        "  wavefog fit data/scenes/bench64.json --max-error 0.002 -o out/small.json");
    return {app, [options] { return fit(*options); }};
}

}  // namespace wavefog::cli
