// wavefog apply, end to end: what render draws comes out of its own colour and depth.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "run.h"

using namespace wavefog::test;
using nlohmann::json;

namespace {

const char* const kCamera = R"("eye": [0, 12, 30], "target": [0, 4, 0], "near": 0.1, "far": 400)";

/// A hill under a map of fog and a layer; `camera` adds keys to its camera.
void write_scene(const Workspace& work, const std::string& camera = "") {
    work.write_ramp_png("map.png", 32, 32);
    work.write_ramp_png("hill.png", 16, 16);
    work.write_text("scene.json",
                    std::string(R"({"size": [48, 32], "camera": {)") + kCamera + camera + R"(},
        "terrain": {"heightmap": "hill.png", "rect": [-40, -40, 40, 40], "height": [0, 6]},
        "fog_colour": [0.5, 0.6, 0.7],
        "fog": [{"model": "wavelet", "image": "map.png", "rect": [-32, -32, 32, 32],
                 "extinction": 0.08, "height": {"profile": "exponential", "base": 0, "scale": 8},
                 "wind": [1, 2], "channels": [1, 0.6, 0.3]},
                {"model": "layers", "profile": "exponential", "extinction": 0.01, "base": 2,
                 "scale": 4}]})");
}

void write_camera(const Workspace& work, const std::string& more) {
    work.write_text("cam.json", std::string("{") + kCamera + ", " + more + "}");
}

/// Runs render with its inputs kept: fogged.EXT, colour.EXT, depth.exr.
void render(const Workspace& work, const std::string& extension) {
    const RunResult result = work.run({"render", "scene.json", "-o", "fogged" + extension,
                                       "--color", "colour" + extension, "--depth", "depth.exr",
                                       "--time", "3", "--transmittance", "T.exr"});
    REQUIRE_MESSAGE(result.status == 0, result.err);
}

RunResult apply(const Workspace& work, const std::string& extension,
                std::vector<std::string> more = {}) {
    more.insert(more.begin(),
                {"apply", "--fog", "scene.json", "--color", "colour" + extension, "--depth",
                 "depth.exr", "--camera", "cam.json", "-o", "applied" + extension, "--time", "3"});
    return work.run(more);
}

void require_ok(const RunResult& result) {
    REQUIRE_MESSAGE(result.status == 0, result.err);
}

}  // namespace

TEST_CASE("apply: render's own colour and depth give render's picture") {
    for (const char* depth : {"", R"(, "depth": "reversed")"}) {
        const Workspace work;
        write_scene(work, depth);
        write_camera(work, std::string(R"("depth_values": "gl")") + depth);
        render(work, ".exr");
        require_ok(apply(work, ".exr", {"--transmittance", "applied_T.exr"}));
        // The same pass on the same numbers.
        CHECK(largest_difference(read_picture(work.path("fogged.exr")),
                                 read_picture(work.path("applied.exr"))) == 0);
        CHECK(largest_difference(read_picture(work.path("T.exr")),
                                 read_picture(work.path("applied_T.exr"))) == 0);
        CHECK(read_picture(work.path("T.exr")).channels == 3);
        CHECK(largest_difference(read_picture(work.path("fogged.exr")),
                                 read_picture(work.path("colour.exr"))) > 0.1);

        render(work, ".png");
        require_ok(apply(work, ".png"));
        // The colour was rounded to 8 bits with dither, and is so again: a step each.
        CHECK(largest_difference(read_picture(work.path("fogged.png")),
                                 read_picture(work.path("applied.png"))) <= 2.01 / 255);
    }
}

TEST_CASE(
    "apply: what changes in time is as in the scene: maps, and particles that meet its ground") {
    const Workspace work;
    write_scene(work);
    work.write_floats("flat.exr", 32, 32, std::vector<float>(32 * 32, 0.5f));
    std::string scene = work.read_text("scene.json");
    const auto add = [&](const std::string& fog) {
        scene.insert(scene.find("\"fog\": [") + 8, fog + ", ");
        work.write_text("scene.json", scene);
        render(work, ".exr");
        require_ok(apply(work, ".exr"));
        CHECK(largest_difference(read_picture(work.path("fogged.exr")),
                                 read_picture(work.path("applied.exr"))) == 0);
        return read_picture(work.path("fogged.exr"));
    };
    write_camera(work, R"("depth_values": "gl")");
    const Picture particles =
        add(R"({"model": "particles", "source": "fog", "position": [0, 4, 0], "area": 15,
        "rate": 30, "radius": [2, 4], "lift": -0.5, "drag": 0.2, "wind": [1, 0]})");
    const Picture both = add(R"({"images": [{"time": 0, "image": "flat.exr"},
        {"time": 4, "image": "map.png"}], "rect": [-32, -32, 32, 32], "extinction": 0.05})");
    CHECK(largest_difference(particles, both) > 0.01);
    require_ok(apply(work, ".exr", {"--method", "froxel:16x12x8"}));
    CHECK(largest_difference(both, read_picture(work.path("applied.exr"))) < 0.2);
}

TEST_CASE("apply: fog in a reduced picture as render draws it; a picture has no vertices") {
    const Workspace work;
    write_scene(work);
    write_camera(work, R"("depth_values": "gl")");
    render(work, ".exr");
    const std::vector<std::string> reduced = {"--method", "exact@12x8"};
    require_ok(apply(work, ".exr", reduced));
    const RunResult drawn = work.run(
        {"render", "scene.json", "-o", "reduced.exr", "--time", "3", "--method", "exact@12x8"});
    require_ok(drawn);
    const Picture applied = read_picture(work.path("applied.exr"));
    CHECK(largest_difference(read_picture(work.path("reduced.exr")), applied) == 0);
    CHECK(largest_difference(read_picture(work.path("fogged.exr")), applied) > 0);
    const RunResult vertices = apply(work, ".exr", {"--method", "exact@vertices"});
    CHECK(vertices.status == 2);
    CHECK(vertices.err.find("no vertices") != std::string::npos);
}

TEST_CASE("apply: the same depth in metres and inverse metres, by axis and by distance") {
    const Workspace work;
    write_scene(work);
    render(work, ".exr");
    const Picture depth = read_picture(work.path("depth.exr"));
    const Picture fogged = read_picture(work.path("fogged.exr"));
    // eye, target and far of kCamera; 50 degrees high, 48 x 32 pixels.
    const double high = std::tan(25 * 3.14159265358979 / 180), near = 0.1, far = 400;
    for (const bool inverse : {false, true})
        for (const bool axis : {false, true}) {
            std::vector<float> values;
            for (int y = 0; y < 32; ++y)
                for (int x = 0; x < 48; ++x) {
                    const double d = double(depth.at(x, y));
                    const double z = near * far / (far - d * (far - near));
                    const double u = high * 1.5 * (2 * (x + 0.5) / 48 - 1);
                    const double v = high * (2 * (y + 0.5) / 32 - 1);
                    const double m = axis ? z : z * std::sqrt(1 + u * u + v * v);
                    const bool sky = d == 1;
                    values.push_back(inverse ? (sky ? 0.0f : float(2 / m))
                                             : (sky ? INFINITY : float(m / 2)));
                }
            work.write_floats("depth.exr", 48, 32, values);
            write_camera(work, std::string(R"("depth_scale": 2, "depth_values": )") +
                                   (inverse ? R"("inverse")" : R"("metres")") +
                                   R"(, "measured": )" + (axis ? R"("axis")" : R"("distance")"));
            const RunResult result = apply(work, ".exr", {"--json"});
            require_ok(result);
            CHECK(json::parse(result.out)["background"] > 100);
            // A standard depth buffer of 0.1 to 400 m holds 60 m to 2 mm: 1e-4 of tau.
            CHECK(largest_difference(fogged, read_picture(work.path("applied.exr"))) < 2e-4);
        }
}

TEST_CASE("apply: every flag, methods on GPU and CPU, alpha and grey stay what they are") {
    const Workspace work;
    write_scene(work);
    write_camera(work, R"("depth_values": "gl")");
    render(work, ".exr");
    require_ok(apply(work, ".exr"));
    const Picture exact = read_picture(work.path("applied.exr"));
    require_ok(apply(work, ".exr", {"--method", "reference"}));
    CHECK(largest_difference(exact, read_picture(work.path("applied.exr"))) < 4e-6);
    const RunResult mu = apply(work, ".exr", {"--mu", "0", "--json"});
    require_ok(mu);
    CHECK(json::parse(mu.out)["mu"] == 0);
    require_ok(apply(work, ".exr", {"--fog-color", "1,0,0"}));
    CHECK(largest_difference(exact, read_picture(work.path("applied.exr"))) > 0.1);
    // A fog file instead of a scene, of the default colour.
    require_ok(work.run({"convert", "map.png", "-o", "fog.exr", "--rect", "-32,-32,32,32"}));
    require_ok(work.run({"apply", "--fog", "fog.exr", "--color", "colour.exr", "--depth",
                         "depth.exr", "--camera", "cam.json", "-o", "other.png"}));
    // Grey becomes RGB, alpha is handed on.
    work.write_ramp_png("grey.png", 48, 32);
    require_ok(work.run({"apply", "--fog", "scene.json", "--color", "grey.png", "--depth",
                         "depth.exr", "--camera", "cam.json", "-o", "rgb.png"}));
    CHECK(read_picture(work.path("rgb.png")).channels == 3);
}

TEST_CASE("apply: mistakes name file and key, and leave nothing") {
    const Workspace work;
    write_scene(work);
    write_camera(work, R"("depth_values": "gl")");
    render(work, ".exr");
    work.write_floats("small.exr", 4, 4, std::vector<float>(16, 0.5f));
    work.write_floats("bad.exr", 48, 32, std::vector<float>(48 * 32, 3.0f));
    work.write_floats("nan.exr", 48, 32, std::vector<float>(48 * 32, NAN));
    work.write_text("nokey.json", R"({"eye": [0, 1, 0], "target": [0, 1, -1]})");
    const auto files = work.files();
    const auto refused = [&](const std::string& colour, const std::string& depth,
                             const std::string& camera, std::vector<std::string> more, int status,
                             const std::string& what) {
        more.insert(more.begin(), {"apply", "--color", colour, "--depth", depth, "--camera", camera,
                                   "-o", "out.png"});
        const RunResult result = work.run(more);
        CHECK(result.status == status);
        CHECK_MESSAGE(result.err.find(what) != std::string::npos, result.err);
        CHECK(work.files() == files);
    };
    const std::vector<std::string> fog = {"--fog", "scene.json"};
    refused("colour.exr", "small.exr", "cam.json", fog, 1,
            "small.exr: is 4x4, colour.exr is 48x32");
    refused("colour.exr", "bad.exr", "cam.json", fog, 1, "bad.exr: pixel (0, 0) is 3");
    refused("colour.exr", "depth.exr", "nokey.json", fog, 1,
            "nokey.json: depth_values: is missing");
    refused("colour.exr", "depth.exr", "none.json", fog, 1, "none.json");
    refused("none.png", "depth.exr", "cam.json", fog, 1, "none.png");
    refused("colour.exr", "depth.exr", "cam.json", {}, 2, "--fog");
    refused("colour.exr", "depth.exr", "cam.json", {"--fog", "scene.json", "--fog-color", "1,2"}, 2,
            "--fog-color");
    // Not measured at all: all background, with a warning.
    const RunResult result =
        work.run({"apply", "--fog", "scene.json", "--color", "colour.exr", "--depth", "nan.exr",
                  "--camera", "cam.json", "-o", "out.png"});
    CHECK(result.status == 0);
    CHECK(result.err.find("nan.exr: 1536 of 1536 pixels are NaN") != std::string::npos);
    const RunResult twice = work.run({"render", "scene.json", "-o", "a.exr", "--color", "a.exr"});
    CHECK(twice.status == 2);
    const RunResult averaged =
        work.run({"render", "scene.json", "-o", "a.exr", "--depth", "d.exr", "--supersample", "2"});
    CHECK(averaged.status == 2);
    CHECK(averaged.err.find("--depth: depths cannot be averaged") != std::string::npos);
}
