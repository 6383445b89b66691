// wavefog fit, end to end on OSMesa.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
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
        const double ratio = facts["coefficient_bytes"]["ratio"];
        CHECK(facts["why"].dump().find("too much") != std::string::npos);
        if (is_smooth) {
            CHECK(dropped >= 2);
            CHECK(ratio >= 8);
        } else {
            CHECK(dropped == 0);
            CHECK(ratio <= 2);
        }
    }
}

TEST_CASE("fit: a map that a formula describes becomes one, and the scene is told so") {
    // Cameras see the fog from above and stay clear of the slab's lower side.
    const std::vector<std::tuple<std::string, std::string, std::string>> cases = {
        {"", "homogeneous fog with extinction 0.01/m", R"({"model":"layers","profile":"ramp")"},
        {R"({"profile": "slab", "bottom": -1000, "top": 5})",
         "halfspace fog below y = 5 m with extinction 0.01/m", R"({"model":"halfspace")"},
        {R"({"profile": "exponential", "base": 2, "scale": 3})",
         "a layer of fog with extinction 0.01/m below y = 2 m",
         R"({"model":"layers","profile":"exponential","extinction":0.0)"},
        {R"({"profile": "linear", "base": 2, "top": 9})",
         "a layer of fog with extinction 0.01/m below y = 2 m, falling to 0 at 9 m",
         R"({"model":"layers","profile":"ramp","points":[[2)"}};
    for (const auto& [profile, words, written] : cases) {
        const Workspace work;
        write_scene(
            work, [](double, double) { return 0.5; },
            R"("wrap": "repeat")" + (profile.empty() ? "" : R"(, "height": )" + profile));
        const json facts = fit(work, "0.0005");
        CAPTURE(facts.dump());
        CHECK(facts["advice"].get<std::string>().find(words) == 0);
        CHECK(facts["advice"].get<std::string>().find("already satisfies this scene") !=
              std::string::npos);
        CHECK(facts["fogs"][0]["kept"] == "none: a formula");
        CHECK(facts["coefficient_bytes"]["after"] == 0);
        CHECK(facts["max_dT_held_out"] <= 0.0005);
        CHECK(work.files().count("small.fog0.exr") == 0);
        const auto scene = nlohmann::ordered_json::parse(work.read_text("small.json"));
        CHECK(scene["fog"][0].dump().find(written) == 0);
        const Picture truth = transmittance(work, "scene.json", "reference");
        CHECK(largest_difference(transmittance(work, "small.json", ""), truth) <= 0.0005);
    }
}

TEST_CASE("fit: a map that hardly matters needs no fog at all, and the scene is told so") {
    // All levels of detail can go here; families differ in how many they have.
    const auto rough = [](double x, double z) { return std::fmod(13 * x + 7 * z, 1.0); };
    const std::vector<std::pair<std::string, std::string>> changes = {
        {"extinction", "5e-5"},
        {"extinction", "0"},
        {"rect", "[-64, 60, 64, 188]"},  // behind the camera
        {"height", R"({"profile": "slab", "bottom": 500, "top": 510})"}};
    for (const auto& [key, value] : changes) {
        CAPTURE(key);
        CAPTURE(value);
        const Workspace work;
        write_scene(work, rough);
        json scene = json::parse(work.read_text("scene.json"));
        scene["fog"][0][key] = json::parse(value);
        work.write_text("scene.json", scene.dump());
        const json facts = fit(work, "0.05");
        CHECK(facts["advice"] == "no fog already satisfies this scene: it needs no map");
        CHECK(facts["fogs"][0]["kept"] == "none: no fog");
        CHECK(facts["why"].dump().find("no fog in its place") != std::string::npos);
        CHECK(json::parse(work.read_text("small.json"))["fog"].empty());
        CHECK(largest_difference(transmittance(work, "small.json", ""),
                                 transmittance(work, "scene.json", "reference")) <= 0.05);
    }
}

TEST_CASE("fit: one map becomes a formula, another stays, a formula stays as it is") {
    const Workspace work;
    write_scene(
        work, [](double x, double z) { return std::fmod(13 * x + 7 * z, 1.0) < 0.4 ? 1.0 : 0.05; });
    work.write_floats("flat.tif", 8, 8, std::vector<float>(64, 1.0f));
    json scene = json::parse(work.read_text("scene.json"));
    const json flat = {{"image", "flat.tif"},
                       {"rect", {-64, -64, 64, 64}},
                       {"wrap", "repeat"},
                       {"extinction", 0.004}};
    scene["fog"].insert(scene["fog"].begin(), flat);
    const json plane = {
        {"model", "halfspace"}, {"normal", {0, 1, 0}}, {"point", {0, 3, 0}}, {"extinction", 0.01}};
    scene["fog"].push_back(plane);
    work.write_text("scene.json", scene.dump());
    const json facts = fit(work, "0.004");
    CAPTURE(facts.dump());
    CHECK(facts["fogs"][0]["kept"] == "none: a formula");
    CHECK(facts["fogs"][1]["kept"] == "64x64");
    CHECK(facts["advice"].get<std::string>().find("for fog 0: it needs no map") !=
          std::string::npos);
    const json small = json::parse(work.read_text("small.json"));
    CHECK(small["fog"][0]["profile"] == "ramp");
    CHECK(small["fog"][1]["file"] == "small.fog1.exr");
    CHECK(small["fog"][2] == plane);
    CHECK(largest_difference(transmittance(work, "small.json", ""),
                             transmittance(work, "scene.json", "reference")) <= 0.004 + 1e-6);
}

TEST_CASE("fit: what one of the cameras sees stays, and the scene keeps its cameras") {
    const Workspace work;
    // Rough behind the main camera alone.
    write_scene(work, [](double x, double z) {
        const double smooth = 0.3 * std::pow(16 * x * (1 - x) * z * (1 - z), 2.0);
        return z > 0.86 && z < 0.95 && std::fmod(13 * x, 1.0) < 0.4 ? 1.0 : smooth;
    });
    const json alone = fit(work, "0.004");
    CHECK(alone["cameras"] == 1);
    CHECK(alone["fogs"][0]["finest_levels_dropped"] >= 1);
    json scene = json::parse(work.read_text("scene.json"));
    scene["cameras"] = {{{"name", "back"}, {"eye", {0, 12, 40}}, {"target", {0, 4, 80}}}};
    work.write_text("scene.json", scene.dump());
    const json both = fit(work, "0.004");
    CAPTURE(both.dump());
    CHECK(both["cameras"] == 2);
    CHECK(both["fogs"][0]["finest_levels_dropped"] == 0);
    CHECK(both["why"].dump().find("(back") != std::string::npos);
    CHECK(json::parse(work.read_text("small.json"))["cameras"] == scene["cameras"]);
    const auto seen_from_back = [&](const std::string& file, const std::string& method) {
        const RunResult result = work.run({"render", file, "-o", "p.png", "--transmittance",
                                           "T.exr", "--camera", "back", "--method", method});
        REQUIRE_MESSAGE(result.status == 0, result.err);
        return read_picture(work.path("T.exr"));
    };
    CHECK(largest_difference(seen_from_back("small.json", both["method"]),
                             seen_from_back("scene.json", "reference")) <= 0.004 + 1e-6);
}

TEST_CASE("fit keeps its promise on real maps, from cameras that it has not seen") {
    for (const auto& [map, error] :
         std::vector<std::pair<std::string, std::string>>{{"weather_crop_64.png", "0.004"},
                                                          {"cloudiness_72x46.tif", "0.01"},
                                                          {"rain_stageiv_87x118.tif", "0.02"},
                                                          {"weather_smooth_512.png", "0.004"}}) {
        CAPTURE(map);
        const Workspace work;
        write_scene(
            work, [](double, double) { return 0.0; },
            R"("basis": "linear", "height": {"profile": "exponential", "base": 2, "scale": 6})");
        json scene = json::parse(work.read_text("scene.json"));
        scene["fog"][0]["image"] = std::string(WAVEFOG_DATA_DIR) + "/" + map;
        scene["cameras"] = {{{"name", "side"}, {"eye", {-45, 9, -5}}, {"target", {0, 3, 10}}}};
        work.write_text("scene.json", scene.dump());
        const json facts = fit(work, error);
        CAPTURE(facts.dump());
        json small = json::parse(work.read_text("small.json"));
        const json unseen = {{{"eye", {1, 12.5, 38}}, {"target", {4, 4, -2}}},
                             {{"eye", {-2, 11.5, 41}}, {"target", {-9, 4, 1}}},
                             {{"eye", {-44, 9.5, -3}}, {"target", {2, 3, 4}}}};
        for (const json& camera : unseen) {
            scene["camera"] = small["camera"] = camera;
            work.write_text("scene.json", scene.dump());
            work.write_text("moved.json", small.dump());
            CHECK(largest_difference(transmittance(work, "moved.json", ""),
                                     transmittance(work, "scene.json", "reference")) <=
                  std::stod(error));
        }
    }
}

TEST_CASE("fit keeps its promise in every pixel of the scene's own camera") {
    // Tuned on a sixteenth of the pixels, which err less here than all do.
    const Workspace work;
    std::vector<float> pixels;
    std::uint32_t state = 12345;
    for (int i = 0; i < 128 * 128; ++i) {
        state = (state * 1103515245u + 12345u) & 0x7fffffffu;
        pixels.push_back(float((state >> 16) & 255u) / 255);
    }
    write_scene(work, [](double, double) { return 0.0; });
    work.write_floats("map.tif", 128, 128, pixels);
    json scene = json::parse(work.read_text("scene.json"));
    scene["size"] = {800, 600};
    scene["camera"]["eye"] = {2, 12, 40};
    scene["camera"]["target"] = {5, 4, 0};
    work.write_text("scene.json", scene.dump());
    const json facts = fit(work, "0.0046");
    CAPTURE(facts.dump());
    CHECK(facts["own_cameras_checked"] == "every pixel of 1 camera at 800x600");
    const double found = facts["max_dT_own_cameras"];
    CHECK(found <= 0.0046);
    const double drawn = largest_difference(transmittance(work, "small.json", ""),
                                            transmittance(work, "scene.json", "reference"));
    CHECK(drawn <= 0.0046);
    CHECK(drawn == doctest::Approx(found).epsilon(0.01));  // T.exr is rounded
}

TEST_CASE("fit: small errors are kept by radial:step, and formulas alone leave nothing to fit") {
    const Workspace work;
    write_scene(work, [](double x, double z) { return x * z; });
    // The least error of the tables is below that of radial without steps.
    const json facts = fit(work, "1/50000");
    CHECK(facts["max_error"] == doctest::Approx(2e-5));
    const auto tried = facts["kept_the_error"].dump() + facts["missed_the_error"].dump();
    for (const char* method : {"\"radial:512x64:step\"", "\"radial:1024x128:step\"",
                               "\"radial:2048x256:step\"", "\"radial:step\""})
        CHECK(tried.find(method) != std::string::npos);
    CHECK(facts["kept_the_error"].dump().find(":step") != std::string::npos);

    json scene = json::parse(work.read_text("scene.json"));
    scene["fog"] = {{{"model", "halfspace"},
                     {"normal", {0, 1, 0}},
                     {"point", {0, 3, 0}},
                     {"extinction", 0.01}}};
    work.write_text("plane.json", scene.dump());
    scene["fog"] = json::array();
    work.write_text("empty.json", scene.dump());
    for (const auto& [name, words] : std::vector<std::pair<std::string, std::string>>{
             {"plane.json", "there is nothing to fit"}, {"empty.json", "add one"}}) {
        const RunResult result =
            work.run({"fit", name, "--max-error", "0.1", "-o", "x.json", "--json"});
        CAPTURE(result.err);
        CHECK(result.status == 1);
        CHECK(result.err.find(words) != std::string::npos);
        CHECK(work.files().count("x.json") == 0);
    }
}

TEST_CASE("fit: two runs write the same bytes") {
    // By error, or a formula: time, which no run repeats, decides nothing here.
    for (const bool formula : {false, true}) {
        CAPTURE(formula);
        const Workspace work;
        write_scene(
            work, [&](double x, double z) { return formula ? 0.5 : x * z; },
            formula ? R"("wrap": "repeat")" : R"("basis": "linear")");
        std::string scene, fog;
        for (const bool first : {true, false}) {
            std::vector<std::string> arguments = {"fit",        "scene.json",  "-o",
                                                  "small.json", "--max-error", "0.01"};
            if (!formula) arguments.insert(arguments.end(), {"--target", "1000"});
            const RunResult result = work.run(arguments);
            REQUIRE_MESSAGE(result.status == 0, result.err);
            if (!first) CHECK(work.read_text("small.json") == scene);
            scene = work.read_text("small.json");
            if (formula) continue;
            if (!first) CHECK(work.read_text("small.fog0.exr") == fog);
            fog = work.read_text("small.fog0.exr");
            CHECK(fog.size() > 1000);
        }
    }
}

TEST_CASE("fit: a time can be the goal, and wrong arguments leave nothing") {
    const Workspace work;
    write_scene(work, [](double x, double z) { return x * z; });
    const auto before = work.files();
    for (const auto& [arguments, status, words] :
         std::vector<std::tuple<std::vector<std::string>, int, std::string>>{
             {{"fit", "scene.json", "-o", "x.json"}, 2, "--max-error"},
             {{"fit", "scene.json", "-o", "x.json", "--max-error", "0"}, 2, "--max-error"},
             {{"fit", "scene.json", "-o", "x.json", "--max-error", "3/2"}, 2, "out of range"},
             {{"fit", "scene.json", "-o", "x.json", "--max-error", "1/0"}, 2, "1/255"},
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
