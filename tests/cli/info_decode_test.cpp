// wavefog info and wavefog decode, end to end.
#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "run.h"

using namespace wavefog::test;
using nlohmann::json;

namespace {

json info(const Workspace& work, const std::string& file) {
    const RunResult result = work.run({"info", file, "--json"});
    REQUIRE_MESSAGE(result.status == 0, result.err);
    return json::parse(result.out);
}

}  // namespace

TEST_CASE("info describes a fog, level by level") {
    const Workspace work;
    work.write_ramp_png("map.png", 40, 24);
    REQUIRE(work.run({"convert", "map.png", "-o", "fog.exr", "--levels", "2", "--rect", "0,0,80,48",
                      "--profile", "slab:1,5", "--extinction", "0.25"})
                .status == 0);
    const json facts = info(work, "fog.exr");
    CHECK(facts["kind"] == "fog");
    CHECK(facts["size"] == json({40, 24}));
    CHECK(facts["basis"] == "linear");
    CHECK(facts["family"] == "2,2");
    CHECK(facts["form"] == "wavelet");
    CHECK(facts["wrap"] == "zero");
    CHECK(facts["levels"] == 2);
    CHECK(facts["cell"] == json({2.0, 2.0}));
    CHECK(facts["extinction"] == 0.25);
    CHECK(facts["profile"] == "slab:1,5");
    using std::filesystem::file_size;
    CHECK(facts["bytes"] == file_size(work.path("fog.exr")) + file_size(work.path("fog.json")));

    const json& levels = facts["energy_per_level"];
    REQUIRE(levels.size() == 3);
    double shares = 0;
    for (const json& level : levels) shares += level["energy_share"].get<double>();
    CHECK(shares == doctest::Approx(1));
    CHECK(levels[2]["map_width"] == 40);
    CHECK(levels[2]["map_height"] == 24);
    const Picture map = read_picture(work.path("map.png"));
    CHECK(levels[2]["map_max"].get<double>() ==
          doctest::Approx(*std::max_element(map.pixels.begin(), map.pixels.end())));

    // A file a level: the bytes of all of them.
    REQUIRE(work.run({"convert", "fog.exr", "-o", "l.exr", "--layout", "levels"}).status == 0);
    CHECK(info(work, "l.exr")["bytes"] == file_size(work.path("l.l1.exr")) +
                                              file_size(work.path("l.l2.exr")) +
                                              file_size(work.path("l.json")));

    const RunResult text = work.run({"info", "fog.exr"});
    CHECK(text.status == 0);
    CHECK(text.out.find("basis:") != std::string::npos);
    CHECK(text.out.find("energy share") != std::string::npos);
}

TEST_CASE("info describes a picture and counts the pixels that cannot be fog") {
    const Workspace work;
    work.write_floats("odd.tif", 3, 1, {0.5f, NAN, 2});
    const json facts = info(work, "odd.tif");
    CHECK(facts["kind"] == "picture");
    CHECK(facts["size"] == json({3, 1}));
    CHECK(facts["invalid_pixels"] == 1);
    CHECK(facts["max"] == 2);
    // An .exr picture is not a fog file.
    work.write_floats("picture.exr", 2, 1, {0.25f, 0.75f});
    CHECK(info(work, "picture.exr")["kind"] == "picture");
}

TEST_CASE("decode writes any level in any format") {
    const Workspace work;
    work.write_ramp_png("map.png", 33, 20);
    const Picture map = read_picture(work.path("map.png"));
    REQUIRE(work.run({"convert", "map.png", "-o", "fog.exr", "--levels", "2", "--basis", "haar"})
                .status == 0);
    // A float, a float and 16 bits of [0,1].
    const std::vector<std::pair<const char*, double>> formats = {
        {"back.exr", 16 * 0x1p-24}, {"back.tif", 16 * 0x1p-24}, {"back.png", 0x1p-16}};
    for (const auto& [name, allowed] : formats) {
        const RunResult result = work.run({"decode", "fog.exr", "-o", name});
        REQUIRE_MESSAGE(result.status == 0, result.err);
        CHECK_MESSAGE(largest_difference(map, read_picture(work.path(name))) <= allowed, name);
    }
    // Haar approximations are means of 4x4 blocks.
    REQUIRE(work.run({"decode", "fog.exr", "-o", "coarse.tif", "--level", "0"}).status == 0);
    const Picture coarse = read_picture(work.path("coarse.tif"));
    CHECK(coarse.width == 9);
    CHECK(coarse.height == 5);
    double mean = 0;
    for (int y = 4; y < 8; ++y)
        for (int x = 8; x < 12; ++x) mean += double(map.at(x, y)) / 16;
    CHECK(coarse.at(2, 1) == doctest::Approx(mean).epsilon(1e-6));

    const RunResult wrong = work.run({"decode", "fog.exr", "-o", "no.tif", "--level", "3"});
    CHECK(wrong.status == 2);
    CHECK(wrong.err.find("levels 0 (coarsest) to 2") != std::string::npos);
}

TEST_CASE("decode warns when a PNG cannot hold the values") {
    const Workspace work;
    work.write_floats("bright.tif", 2, 2, {0, 3, 1, 5});
    REQUIRE(work.run({"convert", "bright.tif", "-o", "fog.exr", "--levels", "0"}).status == 0);
    const RunResult result = work.run({"decode", "fog.exr", "-o", "back.png"});
    CHECK(result.status == 0);
    CHECK(result.err.find("2 of 4 coefficients lie outside [0,1]") != std::string::npos);
    // Float rounding around 0 and 1 is less than a 16-bit step.
    work.write_ramp_png("ramp.png", 40, 24);
    REQUIRE(work.run({"convert", "ramp.png", "-o", "ramp.exr"}).status == 0);
    CHECK(work.run({"decode", "ramp.exr", "-o", "again.png"}).err.empty());
}
