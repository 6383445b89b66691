#include "scene_options.h"

#include <fmt/format.h>

#include "files.h"
#include "fogs.h"
#include "wavefog/fogmap/fog_file.h"

namespace wavefog::cli {

namespace fs = std::filesystem;

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
    add_parsed(app, "--method", options.method, parse_method, "M",
               "exact | radial[:AxR][:step] | paper | paper-scaling | march:N | froxel:XxYxZ | "
               "homogeneous | reference; M@WxH in a reduced picture, looking at depth, "
               "M@WxH:average at its mean, M@vertices at the scene's vertices (the scene's)");
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
