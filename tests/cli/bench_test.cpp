// wavefog bench, end to end on OSMesa: what it writes, not how fast it is.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "run.h"

using namespace wavefog::test;
using nlohmann::json;

namespace {

void write_scene(const Workspace& work, const std::string& name = "scene.json",
                 const std::string& basis = "linear") {
    work.write_ramp_png("map.png", 32, 32);
    work.write_text(name, R"({
        "size": [48, 32],
        "camera": {"eye": [0, 5, 30], "target": [0, 4, 0], "near": 0.1, "far": 400},
        "fog": [{"model": "wavelet", "image": "map.png", "basis": ")" +
                              basis + R"(", "levels": 2,
                 "rect": [-32, -32, 32, 32], "extinction": 0.04}]})");
}

json results(const Workspace& work, const std::string& folder = "out") {
    return json::parse(work.read_text(folder + "/results.json"));
}

const json& row(const json& stored, const std::string& method, double mu = 1) {
    for (const json& r : stored["rows"])
        if (r["method"] == method && r["mu"] == mu) return r;
    FAIL("no row of " << method);
    return stored;
}

}  // namespace

TEST_CASE("bench measures methods in turn and writes rows, provenance and charts") {
    const Workspace work;
    write_scene(work);
    const RunResult run = work.run({"bench", "scene.json", "-o", "out", "--frames", "3",
                                    "--methods", "exact,march:16,paper-scaling", "--mu", "1,0.5"});
    REQUIRE_MESSAGE(run.status == 0, run.err);
    CHECK(run.out.find("march:16") != std::string::npos);
    CHECK(work.files() == std::set<std::string>{"map.png", "scene.json", "out", "out/results.json",
                                                "out/results.csv", "out/figures.csv",
                                                "out/error-scene.svg", "out/error-scene.png"});
    const json stored = results(work);
    REQUIRE(stored["rows"].size() == 6);  // homogeneous, two methods at two mus, march
    CHECK(stored["rows"][0]["method"] == "homogeneous");
    CHECK(stored["rows"][0]["ratio_homogeneous"] == 1);
    CHECK(stored["cut"].empty());
    CHECK(stored["skipped"].empty());
    for (const json& r : stored["rows"]) {
        CHECK(r["frames"] == 3);
        CHECK(r["width"] == 48);
        CHECK(r["map"] == "map.png");
        CHECK(r["map_width"] == 32);
        CHECK(r["basis"] == "linear");
        CHECK(r["family"] == "2,2");
        CHECK(r["levels"] == 2);
        CHECK(r["ms_median"] > 0);
        CHECK(r["ms_p05"] <= r["ms_p95"]);
        CHECK(r["bytes"].is_number());
    }
    CHECK(row(stored, "exact")["max_dT"] < 2e-6);
    CHECK(row(stored, "exact")["psnr"] > 100);
    CHECK(row(stored, "march:16")["max_dT"] > row(stored, "exact")["max_dT"]);
    CHECK(row(stored, "exact", 0.5)["max_dT"] > 1e-4);
    CHECK(row(stored, "homogeneous")["ssim"] < 1);
    // The certified bound stands beside the error that was measured.
    CHECK(row(stored, "exact")["max_dT"] <= row(stored, "exact")["bound_dT"]);
    CHECK(row(stored, "exact")["bound_dT"] < 2e-5);  // float32 alone
    CHECK(row(stored, "exact", 0.5)["max_dT"] <= row(stored, "exact", 0.5)["bound_dT"]);
    CHECK(row(stored, "march:16")["max_dT"] <= row(stored, "march:16")["bound_dT"]);
    CHECK(row(stored, "homogeneous")["bound_dT"] == 1.0);  // may miss any fog
    const json& where = stored["provenance"];
    for (const char* key : {"date", "command", "commit", "compiler", "cpu", "gl_renderer",
                            "gl_version", "clock", "system"})
        CHECK(where[key].get<std::string>().size() > 1);
    CHECK(where["command"].get<std::string>().find("--frames 3") != std::string::npos);
    CHECK(where["data"].size() == 2);
    CHECK(where["data"][1]["sha256"].get<std::string>().size() == 64);
    CHECK(work.read_text("out/error-scene.svg").find("march") != std::string::npos);
    const Picture chart = read_picture(work.path("out/error-scene.png"));
    CHECK(chart.width == 1200);
    CHECK(chart.height == 800);

    // The same tables and pictures from the stored numbers, into another folder.
    const RunResult again = work.run({"bench", "--from", "out/results.json", "-o", "again"});
    REQUIRE_MESSAGE(again.status == 0, again.err);
    CHECK(again.out == run.out);
    for (const char* file : {"results.json", "results.csv", "figures.csv", "error-scene.svg"})
        CHECK(work.read_text("again/" + std::string(file)) ==
              work.read_text("out/" + std::string(file)));
}

TEST_CASE("bench has fogs given by formulas in its pictures and in its truth") {
    const Workspace work;
    write_scene(work);
    std::string scene = work.read_text("scene.json");
    scene.insert(scene.find("\"fog\": [") + 8,
                 R"({"model": "halfspace", "normal": [0, 1, 0], "point": [0, 3, 0],
                     "extinction": 0.02}, )");
    work.write_text("scene.json", scene);
    const RunResult run =
        work.run({"bench", "scene.json", "-o", "out", "--frames", "1", "--methods", "exact"});
    REQUIRE_MESSAGE(run.status == 0, run.err);
    CHECK(row(results(work), "exact")["map"] == "map.png");
    CHECK(row(results(work), "exact")["max_dT"] < 2e-6);
}

TEST_CASE("bench without gnuplot writes the numbers and says how to get the pictures") {
    const Workspace work;
    write_scene(work);
    const RunResult run =
        work.shell("PATH=/nowhere \"$WAVEFOG\" bench scene.json -o out --frames 1 --methods exact");
    REQUIRE_MESSAGE(run.status == 0, run.err);
    CHECK(run.err.find("gnuplot-nox") != std::string::npos);
    CHECK(run.err.find("--from out/results.json") != std::string::npos);
    CHECK(work.files() == std::set<std::string>{"map.png", "scene.json", "out", "out/results.json",
                                                "out/results.csv", "out/figures.csv"});
}

TEST_CASE("bench tells what the time did not allow, with rows or without") {
    const Workspace work;
    write_scene(work);
    write_scene(work, "other.json");
    const RunResult run = work.run({"bench", "scene.json", "other.json", "-o", "out", "--budget",
                                    "0.001", "--methods", "exact"});
    REQUIRE_MESSAGE(run.status == 0, run.err);
    CHECK(run.err.find("left out for want of time") != std::string::npos);
    const json stored = results(work);
    CHECK(stored["cut"].size() >= 2);
    for (const json& r : stored["rows"]) {
        CHECK(r["ms_median"].is_null());
        CHECK(r["max_dT"].is_null());
    }
}

TEST_CASE("bench skips what cannot be drawn and says why") {
    const Workspace work;
    write_scene(work, "cubic.json", "cubic");
    const RunResult run =
        work.run({"bench", "cubic.json", "-o", "out", "--frames", "1", "--methods", "exact"});
    REQUIRE_MESSAGE(run.status == 0, run.err);
    CHECK(run.err.find("could not be measured") != std::string::npos);
    CHECK(run.err.find("degree 3") != std::string::npos);
    CHECK(results(work)["rows"].empty());
}

TEST_CASE("bench presets: speed prints a table, paper-tables measures its cells") {
    const Workspace work;
    write_scene(work);
    const RunResult speed =
        work.run({"bench", "scene.json", "--preset", "speed", "--frames", "1", "--json"});
    REQUIRE_MESSAGE(speed.status == 0, speed.err);
    const json stored = json::parse(speed.out);
    CHECK(stored["rows"].size() == 6);
    CHECK(stored["provenance"]["preset"] == "speed");

    write_scene(work, "other.json");
    const RunResult tables =
        work.run({"bench", "scene.json", "other.json", "--preset", "paper-tables", "--size", "8x6",
                  "--frames", "1", "-o", "out"});
    REQUIRE_MESSAGE(tables.status == 0, tables.err);
    CHECK(tables.err.find("one scene") != std::string::npos);
    CHECK(tables.out.find("Table 3") != std::string::npos);
    const json measured = results(work);
    for (const json& r : measured["rows"]) {
        CAPTURE(r.dump());
        // Truncated by mu, or exact but for quadratic tables of 32 samples.
        CHECK((r["method"] == "homogeneous" || r["mu"] < 1 || r["max_dT"] < 1e-3));
        CHECK(r["max_dT"] <= r["bound_dT"]);
    }
    CHECK(work.files().contains("out/speed-paper-tables.svg"));
}

TEST_CASE("bench resolution and models: scenes of formulas alone, tables and charts") {
    const Workspace work;
    write_scene(work);
    work.write_text("layer.json", R"({
        "size": [48, 32],
        "camera": {"eye": [0, 5, 30], "target": [0, 2, 0], "near": 0.1, "far": 400},
        "terrain": {"heightmap": "map.png", "rect": [-40, -40, 40, 40], "height": [0, 3]},
        "fog": [{"model": "layers", "profile": "exponential", "extinction": 0.03, "base": 1,
                 "scale": 3}]})");
    const RunResult run = work.run({"bench", "scene.json", "layer.json", "--preset", "resolution",
                                    "--size", "160x120", "--frames", "1", "-o", "out"});
    REQUIRE_MESSAGE(run.status == 0, run.err);
    const json stored = results(work);
    // homogeneous, every pixel, three sizes by two upsamplings, vertices; twice.
    REQUIRE(stored["rows"].size() == 2 * 9);
    for (const json& r : stored["rows"]) {
        CAPTURE(r.dump());
        CHECK(r["ms_median"] > 0);
        const std::string method = r["method"];
        // A constant fog of its own is no picture of the scene's.
        const bool measured = method != "homogeneous" || r["scene"] == "scene";
        CHECK(r["max_dT"].is_number() == measured);
        CHECK(r["bound_dT"].is_number() == (r["scene"] == "scene"));
        if (r["bound_dT"].is_number()) CHECK(r["max_dT"] <= r["bound_dT"]);
        // The picture is no larger than these, and the sky, which is fogged pixel by pixel, is all
        // that the scene without a terrain has.
        const bool sky_alone = method == "exact@vertices" && r["scene"] == "scene";
        if (method == "exact" || sky_alone || method.rfind("exact@512", 0) == 0 ||
            method.rfind("exact@256", 0) == 0)
            CHECK(r["max_dT"] < 2e-6);
        else if (measured)
            CHECK(r["max_dT"] > 2e-6);
    }
    CHECK(run.out.find("128² average") != std::string::npos);
    CHECK(run.out.find("layer, exact, vertices") != std::string::npos);
    CHECK(work.files().contains("out/resolution-scene-exact.svg"));
    CHECK(work.files().contains("out/resolution-layer-exact.png"));

    const RunResult models = work.run({"bench", "scene.json", "layer.json", "--preset", "models",
                                       "--size", "48x32", "--frames", "1", "-o", "models"});
    REQUIRE_MESSAGE(models.status == 0, models.err);
    const json drawn = results(work, "models");
    REQUIRE(drawn["rows"].size() == 5);  // homogeneous twice, exact twice, radial of the map
    for (const json& r : drawn["rows"])
        if (r["method"] == "exact") CHECK(r["max_dT"] < 2e-6);
    CHECK(models.out.find("formulas") != std::string::npos);
    CHECK(work.read_text("models/models.svg").find("layer") != std::string::npos);
}

TEST_CASE("bench refuses what it cannot use and leaves no files") {
    const Workspace work;
    write_scene(work);
    work.write_text("file", "no folder");
    work.write_text("no-fog.json", R"({"camera": {"eye": [0,1,0], "target": [0,1,-1]}})");
    const auto before = work.files();
    const auto check = [&](std::vector<std::string> arguments, int status, const char* words) {
        arguments.insert(arguments.begin(), "bench");
        const RunResult run = work.run(arguments);
        CAPTURE(run.err);
        CHECK(run.status == status);
        CHECK(run.err.rfind("wavefog: error: ", 0) == 0);
        CHECK(run.err.find(words) != std::string::npos);
        CHECK(work.files() == before);
    };
    check({"-o", "out"}, 2, "name a scene");
    check({"none.json", "-o", "."}, 1, "none.json");
    check({"no-fog.json"}, 1, "no wavelet fog");
    check({"scene.json", "-o", "file"}, 1, "this is a file");
    check({"scene.json", "-o", "a/b"}, 1, "parent");
    check({"scene.json", "--preset", "fast"}, 2, "fast");
    check({"scene.json", "--map", "map.png"}, 2, "--preset scale");
    check({"scene.json", "--preset", "scale", "--map", "a.png", "--map", "b.png"}, 2,
          "2 --map for 1 scenes");
    check({"scene.json", "--preset", "scale", "--map", "none.png"}, 1, "none.png");
    check({"scene.json", "--methods", "exact,magic"}, 2, "magic");
    check({"scene.json", "--methods", "reference"}, 2, "reference");
    check({"scene.json", "--mu", "1,3"}, 2, "3");
    check({"scene.json", "--budget", "soon"}, 2, "soon");
    check({"--from", "file", "-o", "."}, 1, "not a results file");
    check({"scene.json", "--from", "file"}, 2, "--from");
    check({"--readme", "none.md"}, 1, "none.md");
}

TEST_CASE("README.md is what bench makes of the committed results") {
    const Workspace work;
    const RunResult copied = work.shell("cp -r '" WAVEFOG_DATA_DIR
                                        "/../README.md' . && mkdir data && "
                                        "cp -r '" WAVEFOG_DATA_DIR "/results' data/");
    REQUIRE_MESSAGE(copied.status == 0, copied.err);
    const std::string before = work.read_text("README.md");
    const RunResult run = work.run({"bench", "--readme", "README.md"});
    REQUIRE_MESSAGE(run.status == 0, run.err);
    CHECK(before.find("<!-- bench data/results/") != std::string::npos);
    CHECK(work.read_text("README.md") == before);
}
