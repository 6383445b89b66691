// wavefog render: a scene with its fog becomes a picture.
#include <fmt/format.h>

#include <chrono>
#include <memory>
#include <tuple>
#include <vector>

#include "command.h"
#include "files.h"
#include "fogs.h"
#include "frame.h"
#include "interrupt.h"
#include "options.h"
#include "report.h"
#include "scene_options.h"

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

struct RenderOptions {
    SceneOptions scene;
    fs::path output, transmittance, colour, depth;
    double time = 0;
    bool json = false;
};

Result<void> check_files(const RenderOptions& options) {
    if (auto ok = check_scene(options.scene); !ok) return ok;
    const std::vector<fs::path> inputs = options.scene.inputs();
    if (auto ok = check_output(options.output, inputs, {".png", ".exr"}); !ok) return ok;
    if (!options.depth.empty() && options.scene.supersample > 1)
        return usage_error("--depth: depths cannot be averaged; leave out --supersample");
    std::vector<fs::path> outputs = {options.output};
    for (const auto& [flag, file, extensions] :
         {std::tuple{"--transmittance", &options.transmittance, std::vector<std::string>{".exr"}},
          {"--color", &options.colour, {".png", ".exr"}},
          {"--depth", &options.depth, {".exr"}}}) {
        if (file->empty()) continue;
        const fs::path place = fs::absolute(*file).lexically_normal();
        for (const fs::path& other : outputs)
            if (place == fs::absolute(other).lexically_normal())
                return usage_error(
                    fmt::format("{}: {} and another output are the same file; give two names",
                                file->string(), flag));
        outputs.push_back(*file);
        if (auto ok = check_output(*file, inputs, extensions); !ok) return ok;
    }
    return {};
}

Result<void> render(const RenderOptions& options) {
    if (auto ok = check_files(options); !ok) return ok;
    const Result<Scene> scene = load_scene(options.scene);
    if (!scene) return tl::unexpected(scene.error());

    const auto start = std::chrono::steady_clock::now();
    Result<FrameDrawer> drawer =
        FrameDrawer::create(*scene, options.scene.context, options.scene.supersample);
    if (!drawer) return tl::unexpected(drawer.error());
    const Result<Frame> frame = drawer->draw(options.time);
    if (!frame) return tl::unexpected(frame.error());
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;

    Surfaces surfaces;
    if (!options.colour.empty() || !options.depth.empty()) surfaces = drawer->surfaces();
    {
        const HoldInterrupts hold;
        if (!options.colour.empty())
            if (auto ok = write_image(options.colour,
                                      box_average(surfaces.colour, options.scene.supersample));
                !ok)
                return ok;
        if (!options.depth.empty())
            if (auto ok = write_image(options.depth, surfaces.depth); !ok) return ok;
        if (!options.transmittance.empty())
            if (auto ok = write_image(options.transmittance, frame->transmittance); !ok) return ok;
        if (auto ok = write_image(options.output, frame->colour); !ok) return ok;
    }
    Facts facts = {{"wrote", options.output.string()},
                   {"size", {scene->width, scene->height}},
                   {"method", scene->method.name()},
                   {"mu", scene->method.mu},
                   {"supersample", options.scene.supersample},
                   {"context", options.scene.context},
                   {"renderer", frame->renderer},
                   {"seconds", seconds.count()}};
    if (options.time != 0) facts["time"] = options.time;
    if (options.scene.camera) facts["camera"] = *options.scene.camera;
    if (!options.transmittance.empty()) facts["transmittance"] = options.transmittance.string();
    if (!options.colour.empty()) facts["color"] = options.colour.string();
    if (!options.depth.empty()) facts["depth"] = options.depth.string();
    print_facts(facts, options.json);
    return {};
}

}  // namespace

Command add_render(CLI::App& root) {
    auto options = std::make_shared<RenderOptions>();
    CLI::App* app = root.add_subcommand("render", "Draw a scene with its fog");
    add_scene_options(*app, options->scene);
    app->add_option("-o,--output", options->output,
                    "The picture to write: .png (sRGB, dithered) or .exr (linear)")
        ->required()
        ->type_name("OUT");
    add_parsed(*app, "--time", options->time, parse_number, "SECONDS",
               "When: winds have blown for so long (0)");
    app->add_option("--transmittance", options->transmittance,
                    "Also write the transmittance of every pixel as floats")
        ->type_name("T.exr");
    app->add_option("--color", options->colour, "Also write the scene without fog: .png or .exr")
        ->type_name("C");
    app->add_option("--depth", options->depth,
                    "Also write the depth buffer as floats, for `apply` (\"depth_values\": \"gl\")")
        ->type_name("D.exr");
    app->add_flag("--json", options->json, "Print what was written as JSON");
    app->footer(
        R"(The scene's terrain, meshes and sky are drawn first; then the fog pass reads the depth of
every pixel, finds the optical depth of the fog in front of it, and blends
L = T L_scene + (1 - T) L_fog with T = exp(-optical depth).
Methods: `exact` integrates each cell of the map in closed form (float rounding);
`radial` looks them up in a table around the eye, filled once a frame: the fastest;
`paper` and `paper-scaling` follow the published algorithm, `march:N` takes N samples a ray,
`froxel:XxYxZ` fills a volume as engines do; `homogeneous` is one constant fog;
`reference` integrates in double on the CPU and takes seconds to minutes.

Example: half the detail, the transmittance beside the picture
  wavefog render data/scenes/valley.json -o valley.png --mu 0.5 --transmittance T.exr)");
    return {app, [options] { return render(*options); }};
}

}  // namespace wavefog::cli
