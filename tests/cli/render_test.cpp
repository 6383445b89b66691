// wavefog render, end to end on OSMesa.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <tuple>

#include "run.h"

using namespace wavefog::test;
using nlohmann::json;

namespace {

/// A camera 2 m above a hill, and fog from a ramp of 32x32 pixels over 64 m.
void write_scene(const Workspace& work, const std::string& method = R"({"name": "exact"})") {
    work.write_ramp_png("map.png", 32, 32);
    work.write_ramp_png("hill.png", 16, 16);
    work.write_text("scene.json", R"({
        "size": [48, 32],
        "camera": {"eye": [0, 12, 30], "target": [0, 4, 0], "near": 0.1, "far": 400},
        "terrain": {"heightmap": "hill.png", "rect": [-40, -40, 40, 40], "height": [0, 6]},
        "fog_colour": [0.5, 0.6, 0.7],
        "fog": [{"model": "wavelet", "image": "map.png", "rect": [-32, -32, 32, 32],
                 "extinction": 0.08, "height": {"profile": "exponential", "base": 0, "scale": 8}}],
        "method": )" + method + "}");
}

Picture transmittance(const Workspace& work, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {"render", "scene.json", "-o", "out.exr"});
    arguments.insert(arguments.end(), {"--transmittance", "T.exr"});
    const RunResult result = work.run(arguments);
    REQUIRE_MESSAGE(result.status == 0, result.err);
    return read_picture(work.path("T.exr"));
}

}  // namespace

TEST_CASE("render writes a picture of the scene's size, or of the size asked for") {
    const Workspace work;
    write_scene(work);
    const RunResult result = work.run({"render", "scene.json", "-o", "out.png", "--json"});
    REQUIRE_MESSAGE(result.status == 0, result.err);
    const json facts = json::parse(result.out);
    CHECK(facts["method"] == "exact");
    CHECK(facts["mu"] == 1);
    CHECK(facts["context"] == "osmesa");
    const Picture picture = read_picture(work.path("out.png"));
    CHECK(std::tuple(picture.width, picture.height, picture.channels) == std::tuple(48, 32, 3));
    REQUIRE(work.run({"render", "scene.json", "-o", "small.png", "--size", "17x9"}).status == 0);
    CHECK(read_picture(work.path("small.png")).width == 17);
    CHECK(read_picture(work.path("small.png")).height == 9);
}

TEST_CASE("render: exact gives the reference's transmittance and colours, also at mu < 1") {
    const Workspace work;
    write_scene(work);
    for (const char* mu : {"1", "0.5", "0"}) {
        CAPTURE(std::string(mu));
        const Picture exact = transmittance(work, {"--mu", mu});
        const Picture exact_colour = read_picture(work.path("out.exr"));
        const Picture truth = transmittance(work, {"--mu", mu, "--method", "reference"});
        CHECK(exact.channels == 1);
        CHECK(largest_difference(exact, truth) <= 2e-6);
        CHECK(largest_difference(exact_colour, read_picture(work.path("out.exr"))) <= 4e-6);
    }
}

TEST_CASE("render: fogs given by formulas are drawn with maps and without") {
    const Workspace work;
    write_scene(work);
    const std::string formula =
        R"({"model": "layers", "profile": "exponential", "extinction": 0.02, "base": 2, "scale": 5})";
    std::string scene = work.read_text("scene.json");
    scene.insert(scene.find("\"fog\": [") + 8, formula + ", ");
    work.write_text("scene.json", scene);
    const Picture both = transmittance(work, {});
    CHECK(largest_difference(both, transmittance(work, {"--method", "reference"})) <= 2e-6);
    work.write_text("formula.json", R"({"camera": {"eye": [0, 12, 30], "target": [0, 4, 0]},
                                        "fog": [)" +
                                        formula + "]}");
    const Picture alone = transmittance(work, {"--fog", "formula.json"});
    CHECK(largest_difference(alone, transmittance(work, {"--fog", "formula.json", "--method",
                                                         "reference"})) <= 2e-6);
    CHECK(largest_difference(alone, both) > 0.01);
}

TEST_CASE("render: the method and mu come from the scene unless the flags say otherwise") {
    const Workspace work;
    write_scene(work, R"({"name": "march:8", "mu": 0.25})");
    const auto facts = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"render", "scene.json", "-o", "out.png", "--json"});
        const RunResult result = work.run(more);
        REQUIRE_MESSAGE(result.status == 0, result.err);
        return json::parse(result.out);
    };
    CHECK(facts({})["method"] == "march:8");
    CHECK(facts({})["mu"] == 0.25);
    CHECK(facts({"--method", "homogeneous"})["method"] == "homogeneous");
    CHECK(facts({"--method", "exact"})["mu"] == 0.25);
    CHECK(facts({"--mu", "0.75"})["mu"] == 0.75);
}

TEST_CASE("render: fog in a reduced picture and at vertices, by flag and by the scene") {
    const Workspace work;
    write_scene(work);
    const Picture full = transmittance(work, {});
    const auto difference = [&](const Picture& a) {
        double sum = 0;
        for (std::size_t i = 0; i < a.pixels.size(); ++i)
            sum += std::abs(double(a.pixels[i]) - double(full.pixels[i])) / double(a.pixels.size());
        return sum;
    };
    CHECK(transmittance(work, {"--method", "exact@48x32"}).pixels == full.pixels);
    const double fine = difference(transmittance(work, {"--method", "exact@24x16"}));
    const double coarse = difference(transmittance(work, {"--method", "exact@6x4"}));
    const double average = difference(transmittance(work, {"--method", "exact@6x4:average"}));
    const double vertices = difference(transmittance(work, {"--method", "exact@vertices"}));
    CHECK(fine > 0);
    CHECK(fine < coarse);
    CHECK(coarse < average);
    // Terrain has a vertex at every 1.25 m here, and fog changes over 2 m.
    CHECK(vertices > 0);
    CHECK(vertices < 0.01);
    // The reduced picture is that of all samples.
    const RunResult large = work.run({"render", "scene.json", "-o", "out.png", "--supersample", "2",
                                      "--method", "exact@24x16", "--json"});
    REQUIRE_MESSAGE(large.status == 0, large.err);
    CHECK(json::parse(large.out)["method"] == "exact@24x16");

    write_scene(work, R"({"name": "exact@24x16"})");
    CHECK(difference(transmittance(work, {})) == fine);
    work.write_text("rays.csv", "0,2,0,30,2,0\n");
    for (const std::string method :
         {"froxel:8x8x8@24x16", "radial@vertices", "exact@24", "reference@24x16"}) {
        CAPTURE(method);
        const RunResult run =
            work.run({"render", "scene.json", "-o", "none.png", "--method", method});
        CHECK(run.status == 2);
        CHECK(run.err.find("method \"" + method + "\"") != std::string::npos);
        CHECK_FALSE(work.files().contains("none.png"));
    }
    const RunResult probe = work.run(
        {"probe", "scene.json", "--rays", "rays.csv", "-o", "none.csv", "--method", "exact@24x16"});
    CHECK(probe.status == 2);
    CHECK(probe.err.find("no pixels") != std::string::npos);
}

TEST_CASE("render --fog replaces the fogs of the scene") {
    const Workspace work;
    write_scene(work);
    REQUIRE(work.run({"convert", "map.png", "-o", "same.exr", "--rect", "-32,-32,32,32",
                      "--extinction", "0.08", "--profile", "exponential:0,8"})
                .status == 0);
    const Picture own = transmittance(work, {});
    CHECK(largest_difference(own, transmittance(work, {"--fog", "same.exr"})) <= 1e-6);
    // Twice the fog squares the transmittance.
    const Picture twice = transmittance(work, {"--fog", "same.exr", "--fog", "same.exr"});
    double largest = 0;
    for (std::size_t i = 0; i < own.pixels.size(); ++i)
        largest = std::max(largest,
                           std::abs(double(twice.pixels[i]) - std::pow(double(own.pixels[i]), 2)));
    CHECK(largest <= 4e-6);
}

TEST_CASE("render --supersample averages colours and transmittances of the larger picture") {
    const Workspace work;
    write_scene(work);
    const Picture large = transmittance(work, {"--size", "96x64"});
    const Picture large_colour = read_picture(work.path("out.exr"));
    const Picture small = transmittance(work, {"--supersample", "2"});
    const Picture small_colour = read_picture(work.path("out.exr"));
    REQUIRE(small.width == 48);
    REQUIRE(small.height == 32);
    const auto check = [](const Picture& fine, const Picture& coarse) {
        double largest = 0;
        for (int y = 0; y < coarse.height; ++y)
            for (int x = 0; x < coarse.width; ++x)
                for (int c = 0; c < coarse.channels; ++c) {
                    double mean = 0;
                    for (int k = 0; k < 4; ++k)
                        mean += double(fine.at(2 * x + k % 2, 2 * y + k / 2, c)) / 4;
                    largest = std::max(largest, std::abs(mean - double(coarse.at(x, y, c))));
                }
        CHECK(largest <= 1e-6);
    };
    check(large, small);
    check(large_colour, small_colour);
}

TEST_CASE("render writes .png as the sRGB of .exr") {
    const Workspace work;
    write_scene(work);
    REQUIRE(work.run({"render", "scene.json", "-o", "a.exr"}).status == 0);
    REQUIRE(work.run({"render", "scene.json", "-o", "a.png"}).status == 0);
    const Picture linear = read_picture(work.path("a.exr")), png = read_picture(work.path("a.png"));
    double largest = 0;
    for (std::size_t i = 0; i < linear.pixels.size(); ++i) {
        const double v = std::clamp(double(linear.pixels[i]), 0.0, 1.0);
        const double srgb = v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
        largest = std::max(largest, std::abs(srgb - double(png.pixels[i])));
    }
    CHECK(largest <= 1.01 / 255);  // rounding, and dither of half a step each way
}

TEST_CASE("render: a scene's further cameras are chosen by name") {
    const Workspace work;
    write_scene(work);
    json scene = json::parse(work.read_text("scene.json"));
    const json aside = {{"eye", {20, 9, 10}}, {"target", {0, 3, 0}}, {"far", 300}};
    json named = aside;
    named["name"] = "aside";
    scene["cameras"] = {named};
    work.write_text("scene.json", scene.dump());
    const Picture main = transmittance(work, {});
    const Picture chosen = transmittance(work, {"--camera", "aside"});
    scene["camera"] = aside;
    work.write_text("scene.json", scene.dump());
    CHECK(largest_difference(chosen, transmittance(work, {})) == 0);
    CHECK(largest_difference(chosen, main) > 0.1);

    const auto before = work.files();
    const RunResult wrong =
        work.run({"render", "scene.json", "-o", "x.png", "--camera", "nowhere"});
    CHECK(wrong.status == 2);
    CHECK(wrong.err.find("scene.json: no camera \"nowhere\"; choose one of: aside") !=
          std::string::npos);
    CHECK(work.files() == before);
}
