// wavefog convert, end to end.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>

#include "run.h"

using namespace wavefog::test;
using nlohmann::json;

namespace {

json convert(const Workspace& work, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "convert");
    arguments.push_back("--json");
    const RunResult result = work.run(arguments);
    REQUIRE_MESSAGE(result.status == 0, result.err);
    return json::parse(result.out);
}

}  // namespace

TEST_CASE("convert says what it wrote, and engines can open it") {
    const Workspace work;
    work.write_ramp_png("map.png", 37, 23);
    const json facts = convert(
        work, {"map.png", "-o", "fog.exr", "--basis", "quadratic", "--levels", "3", "--rect",
               "-20,-10,17,13", "--extinction", "0.05", "--profile", "exponential:0,8"});
    CHECK(facts["size"] == json({37, 23}));
    CHECK(facts["basis"] == "quadratic");
    CHECK(facts["family"] == "3,3");
    CHECK(facts["levels"] == 3);
    CHECK(facts["rect"] == json({-20.0, -10.0, 17.0, 13.0}));
    CHECK(facts["extinction"] == 0.05);
    CHECK(facts["profile"] == "exponential:0,8");
    CHECK(facts["wrote"] == json({"fog.exr", "fog.json"}));
    CHECK(facts["bytes"] == file_size(work.path("fog.exr")) + file_size(work.path("fog.json")));
    CHECK(work.files() == std::set<std::string>{"map.png", "fog.exr", "fog.json"});
    CHECK_NOTHROW(json::parse(work.read_text("fog.json")));

    const Picture by_engine = read_with_tinyexr(work.path("fog.exr"));
    const Picture by_oiio = read_picture(work.path("fog.exr"));
    CHECK(by_oiio.channels == 4);
    CHECK(largest_difference(by_engine, by_oiio) == 0);
}

TEST_CASE("convert writes every layout and precision, and decode finds the map in each") {
    const Workspace work;
    work.write_ramp_png("map.png", 20, 31);
    const Picture map = read_picture(work.path("map.png"));
    for (const char* layout : {"atlas", "levels", "parts"})
        for (const char* precision : {"half", "float"})
            for (const char* basis : {"haar", "linear", "quadratic"})
                for (const char* form : {"wavelet", "scaling"}) {
                    CAPTURE(std::string(layout));
                    CAPTURE(std::string(precision));
                    CAPTURE(std::string(basis));
                    CAPTURE(std::string(form));
                    const json facts =
                        convert(work, {"map.png", "-o", "fog.exr", "--layout", layout,
                                       "--precision", precision, "--basis", basis, "--form", form});
                    // The wavelet form packs the approximation with level 1.
                    int images = 1;
                    if (std::string(layout) == "levels")
                        images = facts["levels"].get<int>() + (std::string(form) == "scaling");
                    CHECK(int(facts["wrote"].size()) == images + 1);
                    for (const json& file : facts["wrote"])
                        CHECK(std::filesystem::exists(work.path(file.get<std::string>())));
                    const RunResult decoded = work.run({"decode", "fog.exr", "-o", "back.tif"});
                    REQUIRE_MESSAGE(decoded.status == 0, decoded.err);
                    // Rounded up to the next float16 (2^-10 of the value), or float rounding.
                    const double allowed = std::string(precision) == "half" ? 0x1p-9 : 16 * 0x1p-24;
                    CHECK(largest_difference(map, read_picture(work.path("back.tif"))) <= allowed);
                }
}

TEST_CASE("convert changes a fog file: its place alone, or its decomposition too") {
    const Workspace work;
    work.write_ramp_png("map.png", 16, 16);
    convert(work,
            {"map.png", "-o", "a.exr", "--basis", "haar", "--levels", "2", "--extinction", "2"});
    const json moved = convert(work, {"a.exr", "-o", "b.exr", "--rect", "0,0,160,160"});
    CHECK(moved["basis"] == "haar");
    CHECK(moved["levels"] == 2);
    CHECK(moved["extinction"] == 2);
    CHECK(moved["rect"] == json({0.0, 0.0, 160.0, 160.0}));
    const json changed = convert(work, {"b.exr", "-o", "c.exr", "--basis", "linear", "--family",
                                        "positive", "--form", "scaling", "--wrap", "repeat"});
    CHECK(changed["basis"] == "linear");
    CHECK(changed["family"] == "positive");
    CHECK(changed["form"] == "scaling");
    CHECK(changed["wrap"] == "repeat");
    CHECK(changed["rect"] == json({0.0, 0.0, 160.0, 160.0}));
    CHECK(changed["extinction"] == 2);
    REQUIRE(work.run({"decode", "c.exr", "-o", "back.tif"}).status == 0);
    CHECK(largest_difference(read_picture(work.path("map.png")),
                             read_picture(work.path("back.tif"))) <= 32 * 0x1p-24);
}

TEST_CASE("convert warns of capped levels and unstable families") {
    const Workspace work;
    work.write_ramp_png("map.png", 8, 8);
    const RunResult capped = work.run({"convert", "map.png", "-o", "a.exr", "--levels", "9"});
    CHECK(capped.status == 0);
    CHECK(capped.err.find("wavefog: warning: --levels 9: a map of 8x8 gains nothing beyond 3") !=
          std::string::npos);
    const RunResult unstable = work.run({"convert", "map.png", "-o", "b.exr", "--family", "2,0"});
    CHECK(unstable.status == 0);
    CHECK(unstable.err.find("wavefog: warning: family 2,0 is unstable") != std::string::npos);
    CHECK(unstable.err.find("1.41") != std::string::npos);
}

TEST_CASE("convert replaces impossible pixels when it is told to, and counts them") {
    const Workspace work;
    work.write_floats("odd.tif", 2, 2, {1, NAN, -1, INFINITY});
    const RunResult result =
        work.run({"convert", "odd.tif", "-o", "fog.exr", "--sanitize", "--json", "--levels", "0"});
    REQUIRE_MESSAGE(result.status == 0, result.err);
    CHECK(json::parse(result.out)["sanitized"] == 3);
    CHECK(result.err.find("3 of 4 pixels") != std::string::npos);
    REQUIRE(work.run({"decode", "fog.exr", "-o", "back.tif"}).status == 0);
    CHECK(read_picture(work.path("back.tif")).pixels == std::vector<float>{1, 0, 0, 0});
}

TEST_CASE("a run that fails leaves the older output as it was") {
    const Workspace work;
    work.write_ramp_png("map.png", 8, 8);
    REQUIRE(work.run({"convert", "map.png", "-o", "fog.exr"}).status == 0);
    const std::string before = work.read_text("fog.exr");
    work.write_floats("nan.tif", 1, 1, {NAN});
    CHECK(work.run({"convert", "nan.tif", "-o", "fog.exr"}).status == 1);
    CHECK(work.read_text("fog.exr") == before);
}
