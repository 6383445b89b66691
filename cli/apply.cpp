// wavefog apply: fog over a picture that has a depth.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "command.h"
#include "files.h"
#include "fogs.h"
#include "frame.h"
#include "interrupt.h"
#include "options.h"
#include "report.h"
#include "wavefog/fogmap/camera_file.h"
#include "wavefog/fogmap/fog_file.h"
#include "wavefog/gpu/depth_picture.h"

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

struct ApplyOptions {
    std::vector<fs::path> fogs;
    fs::path colour, depth, camera, output, transmittance;
    std::optional<std::vector<double>> fog_colour;
    std::optional<Method> method;
    std::optional<double> mu;
    std::string context = "osmesa";
    double time = 0;
    bool json = false;
};

Result<void> check_files(const ApplyOptions& options) {
    std::vector<fs::path> inputs = options.fogs;
    inputs.insert(inputs.end(), {options.colour, options.depth, options.camera});
    for (const fs::path& file : inputs)
        // A fog of --layout levels is found by the name it was saved under, which is no file's.
        if (auto ok = check_input(file); !ok && !is_fog_file(file)) return ok;
    if (auto ok = check_output(options.output, inputs, {".png", ".exr"}); !ok) return ok;
    if (options.transmittance.empty()) return {};
    if (fs::absolute(options.transmittance).lexically_normal() ==
        fs::absolute(options.output).lexically_normal())
        return usage_error(options.transmittance.string() +
                           ": --transmittance and --output are the same file; give two names");
    return check_output(options.transmittance, inputs, {".exr"});
}

double srgb_to_linear(double value) {
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

/// As linear RGB, or RGBA if it has alpha: pictures of floats are linear, others sRGB.
Result<Image> read_colour(const fs::path& file) {
    const Result<Image> stored = read_image(file);
    if (!stored) return stored;
    if (stored->channels > 4)
        return data_error(fmt::format("{}: has {} channels; give grey, RGB or RGBA", file.string(),
                                      stored->channels));
    const std::string extension = extension_of(file);
    const bool linear = extension == ".exr" || extension == ".hdr" || extension == ".pfm";
    const bool grey = stored->channels < 3, alpha = stored->channels % 2 == 0;
    Image image{stored->width, stored->height, alpha ? 4 : 3, {}};
    image.pixels.reserve(std::size_t(image.width) * std::size_t(image.height) *
                         std::size_t(image.channels));
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                const float value = stored->at(x, y, grey ? 0 : c);
                image.pixels.push_back(linear ? value : float(srgb_to_linear(double(value))));
            }
            if (alpha) image.pixels.push_back(stored->at(x, y, stored->channels - 1));
        }
    return image;
}

/// Fogs, their colour, ground and the method of the first scene among --fog, changed as the flags
/// say.
Result<Scene> fogs_of(const ApplyOptions& options) {
    Scene scene;
    for (auto file = options.fogs.rbegin(); file != options.fogs.rend(); ++file)
        if (extension_of(*file) == ".json" && !is_fog_file(*file)) {
            const Result<Scene> loaded = load_scene(*file);
            if (!loaded) return loaded;
            scene.fog_colour = loaded->fog_colour;
            scene.method = loaded->method;
            // What its particles meet: where the picture is of that scene, they lie as in it.
            scene.terrain = loaded->terrain;
            scene.meshes = loaded->meshes;
        }
    if (auto ok = replace_fogs(options.fogs, scene); !ok) return tl::unexpected(ok.error());
    if (options.fog_colour) scene.fog_colour = Eigen::Vector3d(options.fog_colour->data());
    if (options.method) {
        const double mu = scene.method.mu;
        scene.method = *options.method;
        scene.method.mu = mu;
    }
    if (options.mu) scene.method.mu = *options.mu;
    return scene;
}

Result<void> apply(const ApplyOptions& options) {
    if (auto ok = check_files(options); !ok) return ok;
    const Result<CameraFile> camera = load_camera(options.camera);
    if (!camera) return tl::unexpected(camera.error());
    Result<Scene> scene = fogs_of(options);
    if (!scene) return tl::unexpected(scene.error());

    Result<Image> colour = read_colour(options.colour);
    if (!colour) return tl::unexpected(colour.error());
    const Result<Image> values = read_image(options.depth);
    if (!values) return tl::unexpected(values.error());
    if (colour->width != values->width || colour->height != values->height)
        return data_error(
            fmt::format("{}: is {}x{}, {} is {}x{}; colour and depth must be of one size",
                        options.depth.string(), values->width, values->height,
                        options.colour.string(), colour->width, colour->height));
    Result<DepthPicture> depth = depth_for_fog(*values, *camera);
    if (!depth)
        return data_error(fmt::format("{}: {}", options.depth.string(), depth.error().message));
    if (depth->unmeasured > 0)
        warn(fmt::format("{}: {} of {} pixels are NaN or not measured and count as {}",
                         options.depth.string(), depth->unmeasured, depth->depth.pixels.size(),
                         camera->depth.unmeasured == DepthValues::Unmeasured::background
                             ? "background"
                             : "their neighbours do"));

    scene->camera = depth->camera;
    scene->width = colour->width;
    scene->height = colour->height;
    const Surfaces surfaces{*std::move(colour), std::move(depth->depth)};
    Result<FrameDrawer> drawer = FrameDrawer::over(*scene, surfaces, options.context);
    if (!drawer) return tl::unexpected(drawer.error());
    const Result<Frame> frame = drawer->draw(options.time);
    if (!frame) return tl::unexpected(frame.error());
    {
        const HoldInterrupts hold;
        if (!options.transmittance.empty())
            if (auto ok = write_image(options.transmittance, frame->transmittance); !ok) return ok;
        if (auto ok = write_image(options.output, frame->colour); !ok) return ok;
    }
    Facts facts = {{"wrote", options.output.string()}, {"size", {scene->width, scene->height}},
                   {"method", scene->method.name()},   {"mu", scene->method.mu},
                   {"background", depth->background},  {"unmeasured", depth->unmeasured},
                   {"renderer", frame->renderer}};
    if (!options.transmittance.empty()) facts["transmittance"] = options.transmittance.string();
    print_facts(facts, options.json);
    return {};
}

}  // namespace

Command add_apply(CLI::App& root) {
    auto options = std::make_shared<ApplyOptions>();
    CLI::App* app = root.add_subcommand("apply", "Put fog over a picture with depth");
    app->add_option("--fog", options->fogs, "A fog file or a scene; again for more, they add up")
        ->required()
        ->type_name("FOG")
        ->allow_extra_args(false);
    app->add_option("--color", options->colour,
                    "The picture: .exr and .hdr are linear, .png and others sRGB")
        ->required()
        ->type_name("C");
    app->add_option("--depth", options->depth, "Its depth, of the same size")
        ->required()
        ->type_name("D");
    app->add_option("--camera", options->camera, "Its camera, and what its depth means")
        ->required()
        ->type_name("CAM.json");
    app->add_option("-o,--output", options->output,
                    "The picture to write: .png (sRGB, dithered) or .exr (linear)")
        ->required()
        ->type_name("OUT");
    add_parsed(
        *app, "--fog-color", options->fog_colour,
        [](const std::string& text) { return parse_numbers(text, 3); }, "R,G,B",
        "The fog's linear colour (the scene's, or 0.8,0.82,0.85)");
    add_parsed(*app, "--method", options->method, parse_method, "M",
               "exact | radial[:AxR][:step] | paper | paper-scaling | march:N | froxel:XxYxZ | "
               "homogeneous | reference; M@WxH in a reduced picture, looking at depth, "
               "M@WxH:average at its mean (the scene's, or exact)");
    add_parsed(
        *app, "--mu", options->mu,
        [](const std::string& text) { return parse_number_in(text, 0, 1); }, "MU",
        "Detail level l counts up to |OP| * mu^l from the eye: 1 keeps all, 0 none (the scene's)");
    add_parsed(*app, "--time", options->time, parse_number, "SECONDS",
               "Where the fogs' wind has taken them (0)");
    app->add_option("--transmittance", options->transmittance,
                    "Also write the transmittance of every pixel as floats")
        ->type_name("T.exr");
    add_context(*app, options->context);
    app->add_flag("--json", options->json, "Print what was written as JSON");
    app->footer(
        R"(The fog is drawn by the same pass as in `render`. The camera file has the keys of a scene's
"camera" (eye, target, fov_y_deg, near, far, ...; metres, y up), and "depth_values":
  "gl"       the depth buffer's values, 0 to 1, by near, far and "depth": "standard" or
             "reversed"
  "metres"   with "measured": "axis" (along the view axis, as z) or "distance" (from
             the eye); "depth_scale": metres a unit (1; 16-bit PNG of mm: 65.535)
  "inverse"  depth_scale / metres, measured likewise
Infinite depth, and depth at or beyond "far", is background: it is fogged as the sky is, by
all that lies before "far". NaN, 0 metres and infinite inverse depth were not measured:
background too, and counted; with "unmeasured": "neighbours" as far as the farther one of
the nearest pixels to the left and right. "depth_offset" is added to every value before.

Example: a photograph with estimated depth
  echo '{"eye": [0, 1.6, 0], "target": [0, 1.6, -1], "fov_y_deg": 55, "far": 2000,
         "depth_values": "metres", "measured": "axis"}' > cam.json
  wavefog apply --fog data/scenes/layers.json --color photo.png --depth depth.exr \
                --camera cam.json -o foggy.png)");
    return {app, [options] { return apply(*options); }};
}

}  // namespace wavefog::cli
