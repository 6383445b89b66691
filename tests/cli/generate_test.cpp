// wavefog generate, end to end.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <utility>

#include "run.h"

using namespace wavefog::test;
using nlohmann::json;

namespace {

json generate(const Workspace& work, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "generate");
    arguments.push_back("--json");
    const RunResult result = work.run(arguments);
    REQUIRE_MESSAGE(result.status == 0, result.err);
    return json::parse(result.out);
}

Picture noise(const Workspace& work, std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"-o", "noise.exr", "--size", "96x64", "--seed", "11"});
    generate(work, arguments);
    return read_picture(work.path("noise.exr"));
}

/// Largest step between neighbours inside the picture, and across its edges when it is tiled.
std::pair<double, double> steps_inside_and_across(const Picture& p) {
    double inside = 0, across = 0;
    for (int y = 0; y < p.height; ++y)
        for (int x = 0; x < p.width; ++x) {
            const double right = std::abs(double(p.at((x + 1) % p.width, y)) - double(p.at(x, y)));
            const double down = std::abs(double(p.at(x, (y + 1) % p.height)) - double(p.at(x, y)));
            double& of_x = x + 1 == p.width ? across : inside;
            double& of_y = y + 1 == p.height ? across : inside;
            of_x = std::max(of_x, right);
            of_y = std::max(of_y, down);
        }
    return {inside, across};
}

double fogged_share(const Picture& p) {
    return double(std::count_if(p.pixels.begin(), p.pixels.end(), [](float v) { return v > 0; })) /
           double(p.pixels.size());
}

/// How fast values change: mean |difference| of neighbours in a row.
double roughness(const Picture& p) {
    double sum = 0;
    for (int y = 0; y < p.height; ++y)
        for (int x = 1; x < p.width; ++x)
            sum += std::abs(double(p.at(x, y)) - double(p.at(x - 1, y)));
    return sum / double(p.pixels.size());
}

// One wave along x of 16 m, its crest at x = 8; a slab between 0 and 4 m that holds twice as much.
const char* const kScene = R"({
    "size": [8, 8], "camera": {"eye": [0, 1, 0], "target": [0, 1, -1]},
    "fog": [{"model": "cosines", "extinction": 0.02, "waves": [
                {"extinction": 0.02, "direction": [1, 0, 0], "frequency": 0.39269908169872414,
                 "phase": 3.141592653589793}]},
            {"model": "layers", "profile": "ramp", "points": [[0, 0], [4, 0.04]]}]})";

double wave(double x) {
    return 0.02 - 0.02 * std::cos(0.39269908169872414 * x);
}

}  // namespace

TEST_CASE("generate: a seed gives the same bytes in every format, another seed another picture") {
    const Workspace work;
    for (const std::string model : {"perlin", "simplex"})
        for (const std::string extension : {"png", "tif", "exr"}) {
            CAPTURE(model + " " + extension);
            const auto make = [&](const std::string& name, const char* seed) {
                const json facts = generate(
                    work, {model, "-o", name + "." + extension, "--seed", seed, "--size", "40x33"});
                CHECK(facts["seed"] == std::stoull(seed));
                CHECK(facts["size"] == json({40, 33}));
                return work.read_text(name + "." + extension);
            };
            const std::string first = make("a", "18446744073709551615");
            CHECK(first == make("b", "18446744073709551615"));
            CHECK(first != make("c", "1"));
        }
}

TEST_CASE("generate: a seed chosen at random is printed and gives the picture again") {
    const Workspace work;
    const json facts = generate(work, {"perlin", "-o", "a.exr", "--size", "32x32"});
    const std::string seed = facts["seed"].dump();
    generate(work, {"perlin", "-o", "b.exr", "--size", "32x32", "--seed", seed});
    CHECK(work.read_text("a.exr") == work.read_text("b.exr"));
}

TEST_CASE("generate: noise is fog, 0 to 1, on the share of the map that is asked for") {
    const Workspace work;
    for (const std::string model : {"perlin", "simplex"})
        for (const double coverage : {0.0, 0.25, 0.7, 1.0}) {
            CAPTURE(model);
            CAPTURE(coverage);
            const Picture p = noise(work, {model, "--coverage", std::to_string(coverage)});
            const auto [low, high] = std::minmax_element(p.pixels.begin(), p.pixels.end());
            CHECK(*low == 0.0f);
            CHECK(*high == (coverage > 0 ? 1.0f : 0.0f));
            // The pixel at the threshold itself is 0;
            CHECK(std::abs(fogged_share(p) - coverage) <= 2.0 / double(p.pixels.size()));
        }
}

TEST_CASE("generate: every option of noise does what it says") {
    const Workspace work;
    for (const std::string model : {"perlin", "simplex"}) {
        CAPTURE(model);
        const std::vector<std::string> smooth = {model, "--octaves", "1", "--coverage", "1"};
        const auto with = [&](std::vector<std::string> arguments) {
            auto all = smooth;
            all.insert(all.end(), arguments.begin(), arguments.end());
            return noise(work, all);
        };
        const double plain = roughness(with({}));
        CHECK(roughness(with({"--features", "16"})) > 1.3 * plain);
        CHECK(roughness(with({"--warp", "2"})) > 1.3 * plain);
        const double rough = roughness(noise(work, {model, "--coverage", "1"}));
        CHECK(rough > 1.3 * plain);
        CHECK(roughness(noise(work, {model, "--coverage", "1", "--gain", "0.8"})) > 1.3 * rough);
        CHECK(roughness(
                  noise(work, {model, "--coverage", "1", "--octaves", "3", "--lacunarity", "6"})) >
              1.3 * roughness(noise(work, {model, "--coverage", "1", "--octaves", "3"})));
        // No gain: only the first octave counts.
        CHECK(largest_difference(noise(work, {model, "--coverage", "1", "--gain", "0"}),
                                 with({})) == 0);
    }
}

TEST_CASE("generate: --tile leaves no seam, and without it there is one") {
    const Workspace work;
    for (const std::string model : {"perlin", "simplex"})
        for (const std::string warp : {"0", "1"}) {
            CAPTURE(model);
            const std::vector<std::string> arguments = {
                model, "--octaves", "2", "--coverage", "1", "--features", "3", "--warp", warp};
            auto tiled = arguments;
            tiled.push_back("--tile");
            const auto [inside, across] = steps_inside_and_across(noise(work, tiled));
            // The edge is as smooth as the inside: the steepest place may lie on it.
            CHECK(across <= 1.1 * inside);
            const auto [steps, seam] = steps_inside_and_across(noise(work, arguments));
            if (warp == "0") CHECK(seam > 1.5 * steps);
        }
}

TEST_CASE("generate: a scene's fog at a height and its mean between two") {
    const Workspace work;
    work.write_text("scene.json", kScene);
    const auto check = [&](std::vector<std::string> arguments, double layer) {
        arguments.insert(arguments.begin(), "scene.json");
        arguments.insert(arguments.end(),
                         {"-o", "map.exr", "--rect", "0,0,32,8", "--size", "64x4"});
        const json facts = generate(work, arguments);
        const double scale = facts["extinction"];
        CHECK(facts["rect"] == json({0, 0, 32, 8}));
        const Picture p = read_picture(work.path("map.exr"));
        CHECK(*std::max_element(p.pixels.begin(), p.pixels.end()) == 1.0f);
        for (int x = 0; x < 64; ++x)
            for (int y = 0; y < 4; ++y)
                CHECK(scale * double(p.at(x, y)) ==
                      doctest::Approx(wave((x + 0.5) / 2) + layer).epsilon(1e-6));
    };
    check({"--height", "3"}, 0.03);
    check({"--height", "-1"}, 0);
    check({"--mean", "0,4"}, 0.02);
    check({"--mean", "2,6"}, (0.03 * 2 + 0.04 * 2) / 4);
}

TEST_CASE("generate: --mean keeps the optical depth of vertical rays, maps included") {
    const Workspace work;
    work.write_ramp_png("map.png", 16, 16);
    work.write_text("scene.json", R"({
        "size": [8, 8], "camera": {"eye": [0, 1, 0], "target": [0, 1, -1]},
        "fog": [{"model": "wavelet", "image": "map.png", "rect": [-8, -8, 8, 8], "extinction": 0.1,
                 "height": {"profile": "exponential", "base": 1, "scale": 3}},
                {"model": "halfspace", "normal": [0.6, 0.8, 0], "point": [0, 4, 0],
                 "gradient": 0.01}]})");
    const json facts = generate(work, {"scene.json", "-o", "mean.exr", "--mean", "-1,20", "--size",
                                       "16x16"});  // the map's own rectangle
    CHECK(facts["rect"] == json({-8, -8, 8, 8}));
    REQUIRE(work.run({"convert", "mean.exr", "-o", "fog.exr", "--rect", "-8,-8,8,8", "--extinction",
                      facts["extinction"].dump(), "--profile", "slab:-1,20"})
                .status == 0);
    std::string rays;
    for (const char* place : {"-7.5,%,-7.5", "0.5,%,3.5", "6.5,%,-2.5"}) {
        std::string ends[2] = {place, place};
        ends[0].replace(ends[0].find('%'), 1, "-1");
        ends[1].replace(ends[1].find('%'), 1, "20");
        rays += ends[0] + "," + ends[1] + "\n";
    }
    const auto depths = [&](const std::string& fog) {
        const RunResult result = work.run({"probe", fog, "--rays", "-", "-o", "-"}, rays);
        REQUIRE_MESSAGE(result.status == 0, result.err);
        std::vector<double> values;
        std::istringstream lines(result.out);
        for (std::string line; std::getline(lines, line);) {
            const auto last = line.rfind(','), before = line.rfind(',', last - 1);
            values.push_back(std::stod(line.substr(before + 1, last - before - 1)));
        }
        return values;
    };
    const auto scene = depths("scene.json"), map = depths("fog.exr");
    REQUIRE(scene.size() == 3);
    // Pixels are floats.
    for (std::size_t i = 0; i < 3; ++i) CHECK(map[i] == doctest::Approx(scene[i]).epsilon(1e-6));
}

TEST_CASE("generate: a map holds a halfspace's extinction, whatever its fraction") {
    const Workspace work;
    const auto pixels = [&](const std::string& more) {
        work.write_text("scene.json", R"({"camera": {"eye": [0, 1, 0], "target": [0, 1, -1]},
            "fog": [{"model": "halfspace", "normal": [0.6, 0.8, 0], "point": [0, 4, 0],
                     "extinction": 0.05)" +
                                          more + "}]}");
        generate(work, {"scene.json", "-o", "map.exr", "--mean", "-1,60", "--size", "16x16",
                        "--rect", "-8,-8,8,8"});
        return read_picture(work.path("map.exr")).pixels;
    };
    const auto plain = pixels("");
    CHECK(pixels(R"(, "fraction": "exp2")") == plain);
    CHECK(pixels(R"(, "fraction": "linear", "start": 3)") == plain);
}

TEST_CASE(
    "generate: a tile of a scene has no seam and stays the scene's beyond the first quarter") {
    const Workspace work;
    work.write_text("scene.json", kScene);
    const std::vector<std::string> arguments = {"scene.json", "--height", "2",    "--rect",
                                                "0,0,39,8",   "--size",   "78x16"};
    const auto map = [&](const std::string& name, bool tile) {
        auto all = arguments;
        all.insert(all.end(), {"-o", name});
        if (tile) all.push_back("--tile");
        const json facts = generate(work, all);
        Picture p = read_picture(work.path(name));
        for (float& v : p.pixels) v *= facts["extinction"].get<float>();
        return p;
    };
    const Picture plain = map("plain.exr", false), tile = map("tile.exr", true);
    CHECK(steps_inside_and_across(plain).second > 2 * steps_inside_and_across(plain).first);
    CHECK(steps_inside_and_across(tile).second <= 1.1 * steps_inside_and_across(tile).first);
    for (int y = 4; y < 16; ++y)
        for (int x = 20; x < 78; ++x)
            CHECK(tile.at(x, y) == doctest::Approx(plain.at(x, y)).epsilon(1e-6));
}

TEST_CASE("generate: what makes no sense is refused, named, and leaves no file") {
    const Workspace work;
    work.write_text("scene.json", kScene);
    work.write_text("clear.json",
                    R"({"size": [8, 8], "camera": {"eye": [0, 1, 0], "target": [0, 1, -1]}})");
    const auto files = work.files();
    const auto refused = [&](std::vector<std::string> arguments, int status, const char* what) {
        arguments.insert(arguments.begin(), "generate");
        arguments.insert(arguments.end(), {"-o", "out.exr"});
        const RunResult result = work.run(arguments);
        CAPTURE(std::string(what));
        CHECK(result.status == status);
        CHECK_MESSAGE(result.err.find(what) != std::string::npos, result.err);
        CHECK(work.files() == files);
    };
    refused({"worley"}, 2, "'worley' is no model");
    refused({"none.json", "--height", "1"}, 1, "none.json");
    refused({"perlin", "--seed", "-1"}, 2, "--seed");
    refused({"perlin", "--size", "0x4"}, 2, "'0x4' is not a map's size");
    refused({"perlin", "--size", "40000x40000"}, 2, "2^30 pixels");
    for (const auto& [flag, value] : {std::pair{"--features", "0"},
                                      {"--features", "257"},
                                      {"--octaves", "0"},
                                      {"--octaves", "17"},
                                      {"--gain", "1.1"},
                                      {"--gain", "nan"},
                                      {"--lacunarity", "1"},
                                      {"--lacunarity", "9"},
                                      {"--warp", "-1"},
                                      {"--warp", "5"},
                                      {"--coverage", "1.01"}})
        refused({"perlin", flag, value}, 2, flag);
    refused({"perlin", "--height", "1"}, 2, "are about scenes and particles");
    refused({"scene.json", "--height", "1", "--seed", "3"}, 2, "about noise");
    refused({"scene.json"}, 2, "--height Y or --mean Y0,Y1");
    refused({"scene.json", "--height", "1", "--mean", "0,1"}, 2, "give one of them");
    refused({"scene.json", "--mean", "3,3"}, 2, "the first height must be below the second");
    refused({"scene.json", "--height", "1"}, 2, "--rect x0,z0,x1,z1");
    refused({"clear.json", "--height", "1"}, 1, "has no \"fog\"");
    refused({"scene.json", "--height", "inf"}, 2, "--height");
}

TEST_CASE("generate: a map without fog is written, with a warning") {
    const Workspace work;
    work.write_text("scene.json", R"({"camera": {"eye": [0, 1, 0], "target": [0, 1, -1]}, "fog": [
        {"model": "halfspace", "normal": [0, 1, 0], "point": [0, 4, 0], "extinction": 0.05}]})");
    const RunResult run = work.run({"generate", "scene.json", "-o", "map.exr", "--height", "50",
                                    "--size", "8x8", "--rect", "-8,-8,8,8"});
    CHECK(run.status == 0);
    CHECK(run.err.find("scene.json: there is no fog here, every pixel is 0") != std::string::npos);
}
