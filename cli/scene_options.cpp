#include "scene_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "files.h"
#include "report.h"
#include "wavefog/fogmap/fog_file.h"

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

/// The fogs of --fog instead of the scene's own.
Result<void> replace_fogs(const std::vector<fs::path>& files, Scene& scene) {
    if (!files.empty()) {
        scene.fogs.clear();
        scene.models.clear();
        scene.model_winds.clear();
        scene.sequences.clear();
        scene.particles.clear();
    }
    for (const fs::path& file : files) {
        if (auto ok = check_input(file); !ok) return ok;
        LoadNotes notes;
        Result<SceneFogs> loaded = load_fogs(file, &notes);
        if (!loaded) return tl::unexpected(loaded.error());
        if (!notes.warning.empty()) warn(notes.warning);
        for (MapSequence& sequence : loaded->sequences) {
            sequence.fog += scene.fogs.size();
            scene.sequences.push_back(std::move(sequence));
        }
        std::move(loaded->particles.begin(), loaded->particles.end(),
                  std::back_inserter(scene.particles));
        std::move(loaded->fogs.begin(), loaded->fogs.end(), std::back_inserter(scene.fogs));
        std::move(loaded->models.begin(), loaded->models.end(), std::back_inserter(scene.models));
        std::move(loaded->model_winds.begin(), loaded->model_winds.end(),
                  std::back_inserter(scene.model_winds));
    }
    return {};
}

}  // namespace

std::vector<fs::path> SceneOptions::inputs() const {
    std::vector<fs::path> files = fogs;
    files.push_back(input);
    return files;
}

void add_scene_options(CLI::App& app, SceneOptions& options) {
    app.add_option("SCENE", options.input, "A scene file (.json)")->required();
    app.add_option("--fog", options.fogs,
                    "Fog file to use instead of the scene's fogs (again for more; they add up)")
        ->type_name("FOG")
        ->allow_extra_args(false);
    add_parsed(app, "--size", options.size, parse_size, "WxH", "Pixels (the scene's size)");
    app.add_option("--camera", options.camera,
                    "One of the scene's \"cameras\" (its main \"camera\")")
        ->type_name("NAME");
    add_parsed(
        app, "--method", options.method, parse_method, "M",
        "exact | radial | paper | paper-scaling | march:N | froxel:XxYxZ | homogeneous | reference "
        "(the scene's)");
    add_parsed(
        app, "--mu", options.mu,
        [](const std::string& text) { return parse_number_in(text, 0, 1); }, "MU",
        "Detail level l counts up to |OP| * mu^l from the eye: 1 keeps all, 0 none (the scene's)");
    add_context(app, options.context);
    add_parsed(
        app, "--supersample", options.supersample,
        [](const std::string& text) { return parse_integer_in(text, 1, 16); }, "K",
        "Draw K x K samples a pixel and average them, 1 to 16 (1)");
}

Result<void> check_scene(const SceneOptions& options) {
    if (auto ok = check_input(options.input); !ok) return ok;
    if (is_fog_file(options.input))
        return usage_error(
            fmt::format("{}: this is a fog, not a scene; give a scene file and the fog as --fog {}",
                        options.input.string(), options.input.string()));
    return {};
}

Result<Scene> load_scene(const SceneOptions& options) {
    Result<Scene> scene = wavefog::load_scene(options.input);
    if (!scene) return scene;
    if (options.size) {
        scene->width = options.size->width;
        scene->height = options.size->height;
    }
    if (options.camera) {
        const Result<Camera> camera = find_camera(*scene, *options.camera);
        if (!camera) return usage_error(options.input.string() + ": " + camera.error().message);
        scene->camera = *camera;
    }
    if (options.method) {
        const double mu = scene->method.mu;
        scene->method = *options.method;
        scene->method.mu = mu;
    }
    if (options.mu) scene->method.mu = *options.mu;

    if (auto ok = replace_fogs(options.fogs, *scene); !ok) return tl::unexpected(ok.error());
    return scene;
}

}  // namespace wavefog::cli
