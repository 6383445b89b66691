// wavefog animate, end to end on OSMesa.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "run.h"

using namespace wavefog::test;
using nlohmann::json;

namespace {

/// A map, a formula and particles, all moving; a second map that changes.
void write_scene(const Workspace& work, const std::string& method = "radial") {
    work.write_ramp_png("map.png", 32, 32);
    work.write_ramp_png("hill.png", 16, 16);
    work.write_floats("flat.exr", 32, 32, std::vector<float>(32 * 32, 0.5f));
    work.write_text("scene.json", R"({
        "size": [48, 32],
        "camera": {"eye": [0, 12, 30], "target": [0, 4, 0], "near": 0.1, "far": 400},
        "terrain": {"heightmap": "hill.png", "rect": [-40, -40, 40, 40], "height": [0, 6]},
        "fog": [{"image": "map.png", "rect": [-32, -32, 32, 32], "extinction": 0.04,
                 "wrap": "repeat", "wind": [[0, 5, 0], [2, 5, 9]]},
                {"images": [{"time": 0, "image": "map.png"}, {"time": 1, "image": "flat.exr"}],
                 "rect": [-32, -32, 32, 32], "extinction": 0.04},
                {"model": "cosines", "extinction": 0.004, "wind": [2, 0], "waves":
                 [{"extinction": 0.004, "direction": [1, 0, 0], "frequency": 0.4}]},
                {"model": "particles", "source": "smoke", "position": [0, 6, 0], "spread_deg": 30,
                 "rate": 30, "radius": [0.5, 3], "wind": [1, 0], "drag": 0.5}],
        "method": {"name": ")" + method +
                                      R"("}})");
}

RunResult animate(const Workspace& work, const std::string& frames, const std::string& pattern,
                  std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"animate", "scene.json", "--frames", frames, "-o", pattern});
    return work.run(more);
}

}  // namespace

TEST_CASE("animate: a frame is the same byte for byte, whoever draws it in whichever range") {
    const Workspace work;
    for (const char* method : {"radial", "exact", "paper"}) {
        write_scene(work, method);
        const RunResult all = animate(work, "0-30", "all_####.png", {"--json"});
        REQUIRE_MESSAGE(all.status == 0, all.err);
        CHECK(json::parse(all.out)["frames"] == 31);
        CHECK(json::parse(all.out)["to"] == "all_0030.png");
        REQUIRE(animate(work, "17-19", "part_##.png").status == 0);
        REQUIRE(animate(work, "18", "one_#.png").status == 0);
        const std::string frame = work.read_text("all_0018.png");
        CHECK(frame == work.read_text("part_18.png"));
        CHECK(frame == work.read_text("one_18.png"));
        CHECK(frame != work.read_text("all_0017.png"));
        // 18 / 24 s, as render draws it.
        REQUIRE(work.run({"render", "scene.json", "-o", "r.png", "--time", "0.75"}).status == 0);
        CHECK(frame == work.read_text("r.png"));
    }
}

TEST_CASE("animate: the reference draws the same frames") {
    const Workspace work;
    write_scene(work, "exact");
    const auto draw = [&](const char* method) {
        const auto result = work.run({"render", "scene.json", "-o", "r.exr", "--transmittance",
                                      "T.exr", "--time", "0.6", "--method", method});
        REQUIRE_MESSAGE(result.status == 0, result.err);
        return read_picture(work.path("T.exr"));
    };
    // Half a metre of a particle's radius at 30 m: float32 positions are off by 2e-6 m.
    CHECK_LE(largest_difference(draw("exact"), draw("reference")), 2e-5);
}

TEST_CASE("animate: mistakes end with 2 and name the flag, and leave no file") {
    const Workspace work;
    write_scene(work);
    const auto before = work.files();
    const auto expect = [&](const RunResult& result, int status, const std::string& words) {
        CAPTURE(result.err);
        CHECK(result.status == status);
        CHECK(result.err.find(words) != std::string::npos);
        CHECK(work.files() == before);
    };
    expect(animate(work, "5-2", "f_####.png"), 2, "ends before it begins");
    expect(animate(work, "x-2", "f_####.png"), 2, "is no range of frames");
    expect(animate(work, "-3", "f_####.png"), 2, "--frames");
    expect(animate(work, "1-2", "f.png"), 2, "needs one run of #");
    expect(animate(work, "1-2", "f_##_##.png"), 2, "needs one run of #");
    expect(animate(work, "1-2", "f_####.jpg"), 2, "cannot write '.jpg'");
    expect(animate(work, "1-2", "none/f_####.png"), 1, "does not exist");
    expect(animate(work, "1-2", "f_####.png", {"--fps", "0"}), 2, "--fps");
    expect(animate(work, "1-2", "f_####.exr", {"--video", "v.mp4"}), 2, "needs frames as .png");
    expect(work.shell("PATH= $WAVEFOG animate scene.json --frames 1-2 -o f_#.png --video v.mp4"), 1,
           "there is no ffmpeg in PATH");
}

TEST_CASE("animate: ffmpeg is told frames, rate and place; its failure is one error") {
    const Workspace work;
    write_scene(work, "exact");
    REQUIRE(work.shell("mkdir -p bin && printf '#!/bin/sh\\necho \"$@\" > told.txt\\n"
                       "for last; do :; done\\necho film > \"$last\"\\n' > bin/ffmpeg && "
                       "chmod +x bin/ffmpeg")
                .status == 0);
    const std::string line =
        "PATH=$PWD/bin:$PATH $WAVEFOG animate scene.json --frames 3-5 --fps 12 -o f_###.png "
        "--video film.mp4";
    const RunResult made = work.shell(line);
    REQUIRE_MESSAGE(made.status == 0, made.err);
    CHECK(work.read_text("film.mp4") == "film\n");
    const std::string told = work.read_text("told.txt");
    CHECK(told.find("-framerate 12 -start_number 3 -i f_%03d.png -frames:v 3") !=
          std::string::npos);
    REQUIRE(work.shell("printf '#!/bin/sh\\nexit 7\\n' > bin/ffmpeg; rm film.mp4").status == 0);
    const RunResult failed = work.shell(line);
    CHECK(failed.status == 1);
    CHECK(failed.err.find("ffmpeg ended with status 7") != std::string::npos);
    CHECK(work.files().count("film.mp4") == 0);
}
