// wavefog fit, end to end on OSMesa.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <tuple>
#include <vector>

#include "run.h"

using namespace wavefog::test;
using nlohmann::json;

namespace {

void write_scene(const Workspace& work, const std::function<double(double, double)>& density,
                 const std::string& fog = R"("basis": "linear")") {
    std::vector<float> pixels;
    for (int j = 0; j < 64; ++j)
        for (int i = 0; i < 64; ++i)
            pixels.push_back(float(density((i + 0.5) / 64, (j + 0.5) / 64)));
    work.write_floats("map.tif", 64, 64, pixels);
    work.write_ramp_png("hill.png", 16, 16);
    work.write_text("scene.json", R"({
        "size": [64, 48],
        "camera": {"eye": [0, 12, 40], "target": [0, 4, 0], "near": 0.1, "far": 400},
        "terrain": {"heightmap": "hill.png", "rect": [-60, -60, 60, 60], "height": [0, 6]},
        "fog": [{"image": "map.tif", "rect": [-64, -64, 64, 64], "extinction": 0.02, )" +
                                      fog + "}]}");
}

json fit(const Workspace& work, const std::string& error) {
    const RunResult result =
        work.run({"fit", "scene.json", "--max-error", error, "-o", "small.json", "--json"});
    REQUIRE_MESSAGE(result.status == 0, result.err);
    return json::parse(result.out);
}

Picture transmittance(const Workspace& work, const std::string& scene, const std::string& method) {
    std::vector<std::string> arguments = {"render",          scene,  "-o", "p.png",
                                          "--transmittance", "T.exr"};
    if (!method.empty()) arguments.insert(arguments.end(), {"--method", method, "--mu", "1"});
    const RunResult result = work.run(arguments);
    REQUIRE_MESSAGE(result.status == 0, result.err);
    return read_picture(work.path("T.exr"));
}

}  // namespace

TEST_CASE("fit: a smooth map comes out small, a rough one does not, and both keep the error") {
    // Smooth to its border too: a map that ends at 0.5 there has an edge.
    const auto smooth = [](double x, double z) {
        return std::pow(16 * x * (1 - x) * z * (1 - z), 2.0);
    };
    const auto rough = [](double x, double z) {
        return std::fmod(13 * x + 7 * z, 1.0) < 0.4 ? 1.0 : 0.05;
    };
    for (const bool is_smooth : {true, false}) {
        const Workspace work;
        if (is_smooth)
            write_scene(work, smooth);
        else
            write_scene(work, rough);
        const json facts = fit(work, "0.004");
        CAPTURE(facts.dump());
        CHECK(facts["max_dT_tuning"] <= 0.004);
        CHECK(facts["max_dT_held_out"] <= 0.004);
        // Every pixel of the picture that the written scene draws, against the old scene's truth.
        const Picture truth = transmittance(work, "scene.json", "reference");
        CHECK(largest_difference(transmittance(work, "small.json", ""), truth) <= 0.004 + 1e-6);
        const int dropped = facts["fogs"][0]["finest_levels_dropped"];
        if (is_smooth)
            CHECK(dropped >= 2);
        else
            CHECK(dropped == 0);
    }
}

TEST_CASE("fit: a scene that homogeneous fog satisfies is told so") {
    const Workspace work;
    write_scene(
        work, [](double, double) { return 0.5; }, R"("wrap": "repeat")");
    const json facts = fit(work, "0.01");
    CHECK(facts["method"] == "homogeneous");
    CHECK(facts["advice"].get<std::string>().find("needs no map") != std::string::npos);
}

TEST_CASE("fit: a time can be the goal, and wrong arguments leave nothing") {
    const Workspace work;
    write_scene(work, [](double x, double z) { return x * z; });
    const auto before = work.files();
    for (const auto& [arguments, status, words] :
         std::vector<std::tuple<std::vector<std::string>, int, std::string>>{
             {{"fit", "scene.json", "-o", "x.json"}, 2, "--max-error"},
             {{"fit", "scene.json", "-o", "x.json", "--max-error", "0"}, 2, "--max-error"},
             {{"fit", "scene.json", "-o", "x.exr", "--max-error", "0.1"}, 2, ".json"},
             {{"fit", "scene.json", "-o", "scene.json", "--max-error", "0.1"}, 2, "same file"},
             {{"fit", "gone.json", "-o", "x.json", "--max-error", "0.1"}, 1, "gone.json"},
             {{"fit", "scene.json", "-o", "no/x.json", "--max-error", "0.1"},
              1,
              "does not exist"}}) {
        const RunResult result = work.run(arguments);
        CAPTURE(result.err);
        CHECK(result.status == status);
        CHECK(result.err.find(words) != std::string::npos);
        CHECK(work.files() == before);
    }
    const RunResult timed = work.run({"fit", "scene.json", "--max-error", "0.05", "--target",
                                      "1000", "-o", "timed.json", "--json"});
    REQUIRE_MESSAGE(timed.status == 0, timed.err);
    // Everything is fast enough: the most exact setting wins.
    CHECK(json::parse(timed.out)["max_dT_tuning"] < 1e-5);
}
