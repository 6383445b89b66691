// wavefog render: a scene with its fog becomes a picture.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <iterator>
#include <memory>
#include <optional>
#include <vector>

#include "command.h"
#include "files.h"
#include "frame.h"
#include "interrupt.h"
#include "options.h"
#include "report.h"
#include "wavefog/fogmap/fog_file.h"

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

struct RenderOptions {
    fs::path input, output, transmittance;
    std::vector<fs::path> fogs;
    std::optional<Size> size;
    std::optional<Method> method;
    std::optional<double> mu;
    std::optional<std::string> camera;
    std::string context = "osmesa";
    double time = 0;
    int supersample = 1;
    bool json = false;
};

Result<void> check_files(const RenderOptions& options) {
    if (auto ok = check_input(options.input); !ok) return ok;
    if (is_fog_file(options.input))
        return usage_error(
            fmt::format("{}: this is a fog, not a scene; give a scene file and the fog as --fog {}",
                        options.input.string(), options.input.string()));
    std::vector<fs::path> inputs = options.fogs;
    inputs.push_back(options.input);
    if (auto ok = check_output(options.output, inputs, {".png", ".exr"}); !ok) return ok;
    if (options.transmittance.empty()) return {};
    if (fs::absolute(options.transmittance).lexically_normal() ==
        fs::absolute(options.output).lexically_normal())
        return usage_error(options.transmittance.string() +
                           ": --transmittance and --output are the same file; give two names");
    return check_output(options.transmittance, inputs, {".exr"});
}

/// The fogs of --fog instead of the scene's own.
Result<void> replace_fogs(const std::vector<fs::path>& files, Scene& scene) {
    if (!files.empty()) {
        scene.fogs.clear();
        scene.models.clear();
        scene.model_winds.clear();
    }
    for (const fs::path& file : files) {
        if (auto ok = check_input(file); !ok) return ok;
        LoadNotes notes;
        Result<SceneFogs> loaded = load_fogs(file, &notes);
        if (!loaded) return tl::unexpected(loaded.error());
        if (!notes.warning.empty()) warn(notes.warning);
        std::move(loaded->fogs.begin(), loaded->fogs.end(), std::back_inserter(scene.fogs));
        std::move(loaded->models.begin(), loaded->models.end(), std::back_inserter(scene.models));
        std::move(loaded->model_winds.begin(), loaded->model_winds.end(),
                  std::back_inserter(scene.model_winds));
    }
    return {};
}

Result<void> render(const RenderOptions& options) {
    if (auto ok = check_files(options); !ok) return ok;
    Result<Scene> scene = load_scene(options.input);
    if (!scene) return tl::unexpected(scene.error());
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

    if (auto ok = replace_fogs(options.fogs, *scene); !ok) return ok;

    const auto start = std::chrono::steady_clock::now();
    const Result<Frame> frame =
        draw_frame(*scene, options.context, options.supersample, options.time);
    if (!frame) return tl::unexpected(frame.error());
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;

    {
        const HoldInterrupts hold;
        if (!options.transmittance.empty())
            if (auto ok = write_image(options.transmittance, frame->transmittance); !ok) return ok;
        if (auto ok = write_image(options.output, frame->colour); !ok) return ok;
    }
    Facts facts = {{"wrote", options.output.string()},   {"size", {scene->width, scene->height}},
                   {"method", scene->method.name()},     {"mu", scene->method.mu},
                   {"supersample", options.supersample}, {"context", options.context},
                   {"renderer", frame->renderer},        {"seconds", seconds.count()}};
    if (options.time != 0) facts["time"] = options.time;
    if (options.camera) facts["camera"] = *options.camera;
    if (!options.transmittance.empty()) facts["transmittance"] = options.transmittance.string();
    print_facts(facts, options.json);
    return {};
}

}  // namespace

Command add_render(CLI::App& root) {
    auto options = std::make_shared<RenderOptions>();
    CLI::App* app = root.add_subcommand("render", "Draw a scene with its fog");
    app->add_option("SCENE", options->input, "A scene file (.json)")->required();
    app->add_option("-o,--output", options->output,
                    "The picture to write: .png (sRGB, dithered) or .exr (linear)")
        ->required()
        ->type_name("OUT");
    app->add_option("--fog", options->fogs,
                    "Fog file to use instead of the scene's fogs (again for more; they add up)")
        ->type_name("FOG")
        ->allow_extra_args(false);
    add_parsed(*app, "--size", options->size, parse_size, "WxH", "Pixels (the scene's size)");
    app->add_option("--camera", options->camera,
                    "One of the scene's \"cameras\" (its main \"camera\")")
        ->type_name("NAME");
    add_parsed(
        *app, "--method", options->method, parse_method, "M",
        "exact | radial | paper | paper-scaling | march:N | froxel:XxYxZ | homogeneous | reference "
        "(the scene's)");
    add_parsed(
        *app, "--mu", options->mu,
        [](const std::string& text) { return parse_number_in(text, 0, 1); }, "MU",
        "Detail level l counts up to |OP| * mu^l from the eye: 1 keeps all, 0 none (the scene's)");
    add_parsed(*app, "--time", options->time, parse_number, "SECONDS",
               "When: winds have blown for so long (0)");
    app->add_option("--transmittance", options->transmittance,
                    "Also write the transmittance of every pixel as floats")
        ->type_name("T.exr");
    add_context(*app, options->context);
    add_parsed(
        *app, "--supersample", options->supersample,
        [](const std::string& text) { return parse_integer_in(text, 1, 16); }, "K",
        "Draw K x K samples a pixel and average them, 1 to 16 (1)");
    app->add_flag("--json", options->json, "Print what was written as JSON");
    app->footer(
        "The scene's terrain, meshes and sky are drawn first; then the fog pass reads the depth "
        "of\n"
        "every pixel, finds the optical depth of the fog in front of it, and blends\n"
        "L = T L_scene + (1 - T) L_fog with T = exp(-optical depth).\n"
        "Methods: `exact` integrates each cell of the map in closed form (float rounding);\n"
        "`radial` looks them up in a table around the eye, filled once a frame: the fastest;\n"
        "`paper` and `paper-scaling` follow the published algorithm, `march:N` takes N samples a "
        "ray,\n"
        "`froxel:XxYxZ` fills a volume as engines do; `homogeneous` is one constant fog;\n"
        "`reference` integrates in double on the CPU and takes seconds to minutes.\n"
        "\n"
        "Example: half the detail, the transmittance beside the picture\n"
        "  wavefog render data/scenes/valley.json -o valley.png --mu 0.5 --transmittance T.exr");
    return {app, [options] { return render(*options); }};
}

}  // namespace wavefog::cli
