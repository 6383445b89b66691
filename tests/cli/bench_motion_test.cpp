// wavefog bench and fit where fog moves: preset motion, particles, fog by colour channel.
#include <doctest/doctest.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "run.h"

using namespace wavefog::test;
using nlohmann::json;

namespace {

const char* const kParticles = R"({"model": "particles", "source": "fog", "position": [0, 4, 0],
    "area": 12, "spread_deg": 80, "rate": 20, "radius": [2, 5]})";

void write_scene(const Workspace& work, const std::string& more) {
    work.write_ramp_png("map.png", 32, 32);
    work.write_text("scene.json", R"({"size": [48, 32],
        "camera": {"eye": [0, 5, 30], "target": [0, 4, 0], "near": 0.1, "far": 400},
        "fog": [{"image": "map.png", "levels": 2, "rect": [-32, -32, 32, 32], "extinction": 0.02})" +
                                      more + "]}");
}

double worst(const json& stored, const std::string& method) {
    for (const json& row : stored["rows"])
        if (row["method"] == method) return row["max_dT"];
    FAIL("no row of " << method);
    return 0;
}

}  // namespace

TEST_CASE("bench --preset motion: each size and each number of particles has its times") {
    const Workspace work;
    const RunResult run = work.run({"bench", "--preset", "motion", "--budget", "0.5", "-o", "out"});
    REQUIRE_MESSAGE(run.status == 0, run.err);
    const json rows = json::parse(work.read_text("out/results.json"))["motion"];
    REQUIRE(rows.size() == 10);
    double before = 0;
    for (std::size_t i = 0; i < 5; ++i) {
        CHECK(rows[i]["size"] == 64 << i);
        for (const char* key : {"decompose_ms", "mix_ms", "textures_ms"}) CHECK(rows[i][key] > 0);
        CHECK(rows[i]["levels"] == 5);
    }
    for (std::size_t i = 5; i < 10; ++i) {
        // 0, 20, 200, 2000, 20000 and what chance makes of their lives.
        const double count = rows[i]["particles"], wanted = i == 5 ? 0 : 2 * std::pow(10, i - 5);
        CHECK(std::abs(count - wanted) <= 4 * std::sqrt(wanted));
        CHECK(rows[i]["draw_ms"] >= rows[i]["draw_ms_p05"]);
        CHECK(rows[i]["draw_ms"] <= rows[i]["draw_ms_p95"]);
        CHECK(rows[i]["draw_ratio_none"] > 0);
        CHECK(count >= before);
        before = count;
    }
    CHECK(run.out.find("decompose, ms") != std::string::npos);
    CHECK(run.out.find("20") != std::string::npos);
    const RunResult again = work.run({"bench", "--from", "out/results.json"});
    CHECK(again.out == run.out);
    for (const char* flag : {"--frames", "--mu"}) {
        const RunResult refused = work.run({"bench", "--preset", "motion", flag, "1"});
        CHECK(refused.status == 2);
        CHECK(refused.err.find("leave out") != std::string::npos);
    }
}

TEST_CASE("bench: particles are in the pictures and in their truth") {
    const Workspace work;
    write_scene(work, std::string(", ") + kParticles);
    const RunResult run = work.run({"bench", "scene.json", "-o", "out", "--frames", "1",
                                    "--methods", "exact,radial:step,paper-scaling,froxel:16x12x8"});
    REQUIRE_MESSAGE(run.status == 0, run.err);
    const json stored = json::parse(work.read_text("out/results.json"));
    CHECK(worst(stored, "exact") <= 2e-6);
    CHECK(worst(stored, "paper-scaling") <= 2e-6);
    // What a method errs is the map's: particles only dim it.
    write_scene(work, "");
    REQUIRE(work.run({"bench", "scene.json", "-o", "bare", "--frames", "1", "--methods",
                      "radial:step,froxel:16x12x8"})
                .status == 0);
    const json bare = json::parse(work.read_text("bare/results.json"));
    for (const char* method : {"radial:step", "froxel:16x12x8"})
        CHECK(worst(stored, method) <= worst(bare, method) + 2e-6);
}

TEST_CASE("fit: particles stay in the scene, which keeps its promise with them") {
    const Workspace work;
    write_scene(work, std::string(", ") + kParticles);
    const RunResult run =
        work.run({"fit", "scene.json", "--max-error", "0.01", "-o", "small.json"});
    REQUIRE_MESSAGE(run.status == 0, run.err);
    CHECK(run.err.find("particles stay in the scene and are left out of the fit") !=
          std::string::npos);
    const json small = json::parse(work.read_text("small.json"));
    CHECK(small["fog"][1] == json::parse(kParticles));
    // Both drawn by the reference's rays: the error is that of the map.
    for (const auto& [scene, method] : {std::pair{"scene", "reference"}, {"small", ""}}) {
        std::vector<std::string> arguments = {
            "render",          std::string(scene) + ".json", "-o", "p.exr",
            "--transmittance", std::string(scene) + ".T.exr"};
        if (*method) arguments.insert(arguments.end(), {"--method", method, "--mu", "1"});
        REQUIRE(work.run(arguments).status == 0);
    }
    const Picture truth = read_picture(work.path("scene.T.exr"));
    CHECK(largest_difference(truth, read_picture(work.path("small.T.exr"))) <= 0.01);
}

TEST_CASE("bench and fit refuse fog by colour channel and say why and what to do") {
    const Workspace work;
    for (const std::string fog :
         {R"({"model": "layers", "profile": "exponential", "extinction": 0.01, "base": 0,
              "scale": 5)",
          R"({"model": "particles", "source": "fog", "position": [0, 1, 0], "rate": 3,
              "radius": [1, 2])"}) {
        write_scene(work, ", " + fog + R"(, "channels": [1, 0.5, 0]})");
        for (const std::vector<std::string>& command :
             {std::vector<std::string>{"bench", "scene.json"},
              {"fit", "scene.json", "--max-error", "0.01", "-o", "small.json"}}) {
            const RunResult run = work.run(command);
            CHECK(run.status == 1);
            CHECK(run.err.find("errors are measured for one colour; remove the key") !=
                  std::string::npos);
        }
    }
}
