// Every bad input gives its message and exit status, and leaves no file.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>

#include "run.h"

using namespace wavefog::test;

namespace {

struct Case {
    std::vector<std::string> arguments;
    int status;
    std::vector<std::string> message;  ///< parts of the line on stderr, in any order
    std::string input = "";
};

/// A directory with good files (map.png, fog.exr, scene.json, rays.csv) and bad ones.
void prepare(const Workspace& work) {
    work.write_ramp_png("map.png", 16, 16);
    REQUIRE(work.run({"convert", "map.png", "-o", "fog.exr"}).status == 0);
    const std::string scene = R"("camera": {"eye": [0, 5, 20], "target": [0, 0, 0]},
        "fog": [{"image": "map.png", "rect": [0, 0, 16, 16], "extinction": 0.1}])";
    work.write_text("scene.json", "{" + scene + "}");
    work.write_text("unknown_key.json", "{" + scene + R"(, "foggy": true})");
    work.write_text("broken.json", "{" + scene + ",,");
    work.write_text("no_image.json", R"({"camera": {"eye": [0, 5, 20], "target": [0, 0, 0]},
        "fog": [{"image": "gone.png", "rect": [0, 0, 16, 16], "extinction": 0.1}]})");
    work.write_text("rays.csv", "0,1,0,5,1,5\n");
    work.write_text("words.csv", "ox,oy,oz,px,py,pz\n0,1,0,5,1,5\n0,1,far,5,1,5\n");
    work.write_text("short.csv", "0,1,0,5,1\n");
    work.write_text("empty.png", "");
    work.write_text("text.png", "this is no picture\n");
    work.write_text("truncated.png", work.read_text("map.png").substr(0, 90));
    work.write_text("truncated.exr", work.read_text("fog.exr").substr(0, 400));
    work.write_floats("nan.tif", 2, 2, {0, 1, NAN, 0});
    work.write_floats("inf.tif", 2, 2, {0, INFINITY, 0, 0});
    work.write_floats("huge.tif", 4, 1, {0, 3e38f, 3e38f, 3e38f});
    work.write_floats("negative.tif", 2, 2, {0, 1, 0, -0.5f});
    work.write_floats("picture.exr", 2, 2, {0, 1, 0, 0.5f});
    std::filesystem::create_directory(work.path("directory"));
    std::filesystem::create_directory(work.path("directory.png"));
    std::filesystem::create_directory(work.path("directory.exr"));
}

void check(const Workspace& work, const Case& c) {
    std::string line;
    for (const std::string& argument : c.arguments) line += " " + argument;
    INFO("wavefog", line);
    const auto before = work.files();
    const std::string fog = work.read_text("fog.exr"), map = work.read_text("map.png");
    const RunResult result = work.run(c.arguments, c.input);
    INFO("stderr: ", result.err);
    CHECK(result.status == c.status);
    const auto at = result.err.find("wavefog: error: ");
    REQUIRE(at != std::string::npos);
    const std::string error = result.err.substr(at);
    for (const std::string& part : c.message)
        CHECK_MESSAGE(error.find(part) != std::string::npos, "missing: ", part);
    CHECK_MESSAGE(error.find("; ") != std::string::npos, "no remedy");
    CHECK(result.out.empty());
    CHECK(work.files() == before);
    CHECK(work.read_text("fog.exr") == fog);
    CHECK(work.read_text("map.png") == map);
}

void check_all(const std::vector<Case>& cases) {
    const Workspace work;
    prepare(work);
    for (const Case& c : cases) check(work, c);
}

}  // namespace

TEST_CASE("bad inputs of convert") {
    check_all({
        {{"convert", "gone.png", "-o", "x.exr"}, 1, {"gone.png: there is no such file"}},
        {{"convert", "directory", "-o", "x.exr"}, 1, {"directory: this is a directory"}},
        {{"convert", "empty.png", "-o", "x.exr"}, 1, {"empty.png: "}},
        {{"convert", "text.png", "-o", "x.exr"}, 1, {"text.png: "}},
        {{"convert", "truncated.png", "-o", "x.exr"}, 1, {"truncated.png: "}},
        {{"convert", "truncated.exr", "-o", "x.exr"}, 1, {"truncated.exr: "}},
        {{"convert", "nan.tif", "-o", "x.exr"}, 1, {"nan.tif: ", "--sanitize"}},
        {{"convert", "inf.tif", "-o", "x.exr"}, 1, {"inf.tif: ", "--sanitize"}},
        {{"convert", "negative.tif", "-o", "x.exr"}, 1, {"negative.tif: ", "--sanitize"}},
        {{"convert", "scene.json", "-o", "x.exr"}, 1, {"scene.json: "}},
        {{"convert", "map.png", "-o", "gone/x.exr"},
         1,
         {"gone/x.exr: the directory gone does not"}},
        {{"convert", "map.png", "-o", "directory.exr"}, 1, {"directory.exr: this is a directory"}},
        {{"convert", "fog.exr", "-o", "fog.exr"}, 2, {"fog.exr: output and input are the same"}},
        {{"convert", "fog.exr", "-o", "./directory/../fog.exr"}, 2, {"the same file"}},
        {{"convert", "map.png", "-o", "scene.exr"}, 1, {"scene.json: this file describes no fog"}},
        {{"convert", "map.png", "-o", "x.wfog", "--layout", "atlas"}, 2, {"about .exr"}},
        {{"convert", "huge.tif", "-o", "x.wfog"}, 1, {"huge.tif: densities up to 3e+38 overflow"}},
        {{"convert", "map.png", "-o", "x.jpg"}, 2, {"cannot write '.jpg'", "use .exr"}},
        {{"convert", "map.png", "-o", "x"}, 2, {"cannot write ''"}},
        {{"convert", "map.png"}, 2, {"--output", "convert --help"}},
        {{"convert"}, 2, {"IN", "convert --help"}},
        {{"convert", "map.png", "more.png", "-o", "x.exr"}, 2, {"more.png"}},
        {{"convert", "map.png", "-o", "x.exr", "--basis", "cubist"},
         2,
         {"--basis", "cubist", "haar"}},
        {{"convert", "map.png", "-o", "x.exr", "--family", "9,9"}, 2, {"9,9", "2,2"}},
        {{"convert", "map.png", "-o", "x.exr", "--family", "positive"}, 2, {"positive", "scaling"}},
        {{"convert", "fog.exr", "-o", "x.exr", "--family", "3,3"}, 2, {"3,3", "2,2"}},
        {{"convert", "map.png", "-o", "x.exr", "--levels", "-1"}, 2, {"--levels", "'-1'", "auto"}},
        {{"convert", "map.png", "-o", "x.exr", "--levels", "two"}, 2, {"--levels", "'two'"}},
        {{"convert", "map.png", "-o", "x.exr", "--form", "round"},
         2,
         {"--form", "wavelet, scaling"}},
        {{"convert", "map.png", "-o", "x.exr", "--wrap", "mirror"}, 2, {"--wrap", "zero, repeat"}},
        {{"convert", "map.png", "-o", "x.exr", "--layout", "pile"},
         2,
         {"--layout", "atlas, levels"}},
        {{"convert", "map.png", "-o", "x.exr", "--precision", "8"}, 2, {"--precision", "half"}},
        {{"convert", "map.png", "-o", "x.exr", "--rect", "0,0,1"}, 2, {"--rect", "3 values"}},
        {{"convert", "map.png", "-o", "x.exr", "--rect", "5,0,1,1"}, 2, {"--rect", "no area"}},
        {{"convert", "map.png", "-o", "x.exr", "--rect", "0,0,1,nan"}, 2, {"--rect", "'nan'"}},
        {{"convert", "map.png", "-o", "x.exr", "--extinction", "-1"},
         2,
         {"--extinction", "0 or more"}},
        {{"convert", "map.png", "-o", "x.exr", "--extinction", "inf"},
         2,
         {"--extinction", "'inf'"}},
        {{"convert", "map.png", "-o", "x.exr", "--extinction", "0.1m"}, 2, {"'0.1m'"}},
        {{"convert", "map.png", "-o", "x.exr", "--profile", "box"},
         2,
         {"--profile", "slab:BOTTOM"}},
        {{"convert", "map.png", "-o", "x.exr", "--profile", "slab:9,1"}, 2, {"--profile"}},
        {{"convert", "map.png", "-o", "x.exr", "--profile", "exponential:0,0"}, 2, {"scale"}},
        {{"convert", "map.png", "-o", "x.exr", "--channel", "Q"}, 1, {"map.png", "Q"}},
        {{"convert", "fog.exr", "-o", "x.exr", "--sanitize"}, 2, {"fog.exr", "--sanitize"}},
        {{"convert", "map.png", "-o", "x.exr", "--colour"}, 2, {"--colour"}},
    });
}

TEST_CASE("bad inputs of info and decode") {
    check_all({
        {{"info", "gone.exr"}, 1, {"gone.exr: there is no such file"}},
        {{"info", "directory"}, 1, {"directory: this is a directory"}},
        {{"info", "truncated.exr"}, 1, {"truncated.exr: "}},
        {{"info", "empty.png"}, 1, {"empty.png: "}},
        {{"info", "scene.json"}, 1, {"scene.json: "}},
        {{"info"}, 2, {"FILE", "info --help"}},
        {{"decode", "gone.exr", "-o", "x.tif"}, 1, {"gone.exr: there is no such file"}},
        {{"decode", "picture.exr", "-o", "x.tif"}, 1, {"picture.exr: "}},
        {{"decode", "map.png", "-o", "x.tif"}, 2, {"map.png: "}},
        {{"decode", "truncated.exr", "-o", "x.tif"}, 1, {"truncated.exr: "}},
        {{"decode", "fog.exr", "-o", "x.jpg"}, 2, {"cannot write '.jpg'", ".exr, .tif"}},
        {{"decode", "fog.exr", "-o", "fog.exr"}, 2, {"the same file"}},
        {{"decode", "fog.exr", "-o", "gone/x.tif"}, 1, {"the directory gone does not exist"}},
        {{"decode", "fog.exr", "-o", "directory.png"}, 1, {"this is a directory"}},
        {{"decode", "fog.exr", "-o", "x.tif", "--level", "-1"}, 2, {"--level", "'-1'"}},
        {{"decode", "fog.exr", "-o", "x.tif", "--level", "9"}, 2, {"--level 9", "levels 0"}},
    });
}

TEST_CASE("bad inputs of probe") {
    const std::vector<std::string> good = {"probe", "fog.exr", "--rays", "rays.csv", "-o", "x.csv"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), good.begin(), good.end());
        return more;
    };
    check_all({
        {{"probe", "gone.exr", "--rays", "rays.csv", "-o", "x.csv"}, 1, {"gone.exr: there is no"}},
        {{"probe", "fog.exr", "--rays", "gone.csv", "-o", "x.csv"}, 1, {"gone.csv: there is no"}},
        {{"probe", "fog.exr", "--rays", "directory", "-o", "x.csv"},
         1,
         {"directory: this is a dir"}},
        {{"probe", "fog.exr", "--rays", "words.csv", "-o", "x.csv"},
         1,
         {"line 3, column 3 (oz): 'far'"}},
        {{"probe", "fog.exr", "--rays", "short.csv", "-o", "x.csv"}, 1, {"line 1 has 5 columns"}},
        {{"probe", "fog.exr", "--rays", "map.png", "-o", "x.csv"}, 1, {"map.png: line 1"}},
        {{"probe", "fog.exr", "--rays", "-", "-o", "x.csv"},
         1,
         {"standard input: line 1"},
         "a,b\n"},
        {{"probe", "fog.exr", "--rays", "-", "-o", "-"}, 1, {"standard input: holds no rays"}},
        {{"probe", "fog.exr", "--rays", "rays.csv", "-o", "gone/x.csv"},
         1,
         {"gone does not exist"}},
        {{"probe", "fog.exr", "--rays", "rays.csv", "-o", "directory"}, 1, {"this is a directory"}},
        {{"probe", "fog.exr", "--rays", "rays.csv", "-o", "rays.csv"}, 2, {"the same file"}},
        {{"probe", "fog.exr", "--rays", "rays.csv", "-o", "fog.exr"}, 2, {"the same file"}},
        {{"probe", "broken.json", "--rays", "rays.csv", "-o", "x.csv"}, 1, {"broken.json: "}},
        {{"probe", "fog.exr", "-o", "x.csv"}, 2, {"--rays", "probe --help"}},
        {with({"--method", "magic"}), 2, {"--method", "magic", "exact"}},
        {with({"--method", "march:0"}), 2, {"--method", "march"}},
        {with({"--method", "march"}), 2, {"--method", "march"}},
        {with({"--method", "froxel:8x8x8"}), 2, {"froxel"}},
        {with({"--mu", "1.5"}), 2, {"--mu", "1.5 is out of range; use 0 to 1"}},
        {with({"--mu", "-0.1"}), 2, {"--mu"}},
        {with({"--mu", "nan"}), 2, {"--mu", "'nan'"}},
    });
}

TEST_CASE("bad inputs of render") {
    const std::vector<std::string> good = {"render", "scene.json", "-o", "x.png"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), good.begin(), good.end());
        return more;
    };
    check_all({
        {{"render", "gone.json", "-o", "x.png"}, 1, {"gone.json: there is no such file"}},
        {{"render", "directory", "-o", "x.png"}, 1, {"directory: this is a directory"}},
        {{"render", "broken.json", "-o", "x.png"}, 1, {"broken.json: "}},
        {{"render", "map.png", "-o", "x.png"}, 1, {"map.png: "}},
        {{"render", "unknown_key.json", "-o", "x.png"}, 1, {"unknown_key.json: ", "foggy"}},
        {{"render", "no_image.json", "-o", "x.png"},
         1,
         {"no_image.json: fog[0].image", "gone.png"}},
        {{"render", "fog.exr", "-o", "x.png"}, 2, {"this is a fog, not a scene", "--fog fog.exr"}},
        {{"render", "scene.json", "-o", "x.jpg"}, 2, {"cannot write '.jpg'", ".png, .exr"}},
        {{"render", "scene.json", "-o", "gone/x.png"}, 1, {"the directory gone does not exist"}},
        {{"render", "scene.json", "-o", "directory.png"}, 1, {"this is a directory"}},
        {{"render", "scene.json", "-o", "scene.json"}, 2, {"cannot write '.json'"}},
        {{"render", "scene.json", "-o", "fog.exr", "--fog", "fog.exr"}, 2, {"the same file"}},
        {with({"--fog", "gone.exr"}), 1, {"gone.exr: there is no such file"}},
        {with({"--fog", "truncated.exr"}), 1, {"truncated.exr: "}},
        {with({"--context", "vulkan"}), 2, {"vulkan", "osmesa"}},
        {with({"--method", "magic"}), 2, {"--method", "magic"}},
        {with({"--mu", "2"}), 2, {"--mu", "use 0 to 1"}},
        {with({"--size", "0x600"}), 2, {"--size", "WIDTHxHEIGHT"}},
        {with({"--size", "800"}), 2, {"--size", "WIDTHxHEIGHT"}},
        {with({"--size", "99999x2"}), 2, {"--size", "16384"}},
        {with({"--supersample", "0"}), 2, {"--supersample"}},
        {with({"--size", "16384x8", "--supersample", "16"}), 2, {"--supersample"}},
        {with({"--transmittance", "T.png"}), 2, {"T.png", "use .exr"}},
        {with({"--transmittance", "gone/T.exr"}), 1, {"the directory gone does not exist"}},
        {{"render", "scene.json", "-o", "x.exr", "--transmittance", "./x.exr"}, 2, {"same file"}},
    });
}

TEST_CASE("usage of the command itself") {
    check_all({
        {{}, 2, {"wavefog --help"}},
        {{"fly"}, 2, {"fly", "wavefog --help"}},
        {{"--loud"}, 2, {"wavefog --help"}},
    });
    const Workspace work;
    for (const char* command : {"convert", "info", "decode", "probe", "render"}) {
        const RunResult help = work.run({command, "--help"});
        CHECK(help.status == 0);
        CHECK(help.err.empty());
        CHECK_MESSAGE(help.out.find("Example:") != std::string::npos, command);
        CHECK(help.out.find(std::string("wavefog ") + command) != std::string::npos);
    }
    CHECK(work.run({"--help"}).status == 0);
    CHECK(work.run({"--version"}).out.starts_with("wavefog "));
}
