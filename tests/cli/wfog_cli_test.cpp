// .wfog files through the command: there, back, promises, and many at a time.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "run.h"

namespace wavefog::test {
namespace {

using nlohmann::json;

json json_of(const RunResult& result) {
    INFO(result.err);
    REQUIRE(result.status == 0);
    return json::parse(result.out);
}

}  // namespace

TEST_CASE("convert goes between .exr and .wfog without loss") {
    const Workspace work;
    work.write_ramp_png("map.png", 70, 45);
    const std::vector<std::string> place = {"--rect", "-20,-20,20,30", "--extinction",
                                            "0.07",   "--profile",     "exponential:0,8"};
    const auto convert = [&](std::vector<std::string> arguments, bool placed) {
        arguments.insert(arguments.begin(), "convert");
        if (placed) arguments.insert(arguments.end(), place.begin(), place.end());
        arguments.emplace_back("--json");
        return json_of(work.run(arguments));
    };
    const json direct = convert({"map.png", "-o", "map.wfog"}, true);
    CHECK(direct["max_error"] == 0);
    CHECK(direct["worst_dT"] == 0);
    convert({"map.png", "-o", "map.exr"}, true);
    convert({"map.wfog", "-o", "from_wfog.exr"}, false);
    convert({"map.exr", "-o", "from_exr.wfog"}, false);
    CHECK(work.read_text("from_exr.wfog") == work.read_text("map.wfog"));
    CHECK(largest_difference(read_with_tinyexr(work.path("map.exr")),
                             read_with_tinyexr(work.path("from_wfog.exr"))) == 0);

    REQUIRE(work.run({"decode", "map.wfog", "-o", "back.tif"}).status == 0);
    const Picture back = read_picture(work.path("back.tif"));
    for (int y = 0; y < 45; ++y)
        for (int x = 0; x < 70; ++x)
            CHECK(back.at(x, y) == float(double((7 * x + 13 * y) % 256) / 255));
    const json info = json_of(work.run({"info", "map.wfog", "--json"}));
    CHECK(info["extinction"] == 0.07);
    CHECK(info["profile"] == "exponential:0,8");
    CHECK(info["bytes"] == work.read_text("map.wfog").size());
}

TEST_CASE("convert keeps what it promises of a .wfog file and says what it achieved") {
    const Workspace work;
    work.write_ramp_png("map.png", 90, 61);
    const auto convert = [&](std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {"convert", "map.png", "-o", "out.wfog", "--json"});
        return json_of(work.run(arguments));
    };
    for (const bool best : {false, true}) {
        std::vector<std::string> arguments = {"--max-error", "2/255"};
        if (best) arguments.emplace_back("--best");
        const json facts = convert(arguments);
        CHECK(facts["bytes"] == work.read_text("out.wfog").size());
        CHECK(facts["bits_per_pixel"] == doctest::Approx(8.0 * double(facts["bytes"]) / 90 / 61));
        CHECK(facts["max_error"].get<double>() > 0);
        REQUIRE(work.run({"decode", "out.wfog", "-o", "back.tif"}).status == 0);
        const Picture back = read_picture(work.path("back.tif"));
        double worst = 0;
        for (int y = 0; y < 61; ++y)
            for (int x = 0; x < 90; ++x)
                worst = std::max(worst, std::fabs(back.at(x, y) - (7 * x + 13 * y) % 256 / 255.0));
        CHECK(worst <= 2 / 255.0 + 1e-7);
        CHECK(worst == doctest::Approx(facts["max_error"].get<double>()).epsilon(1e-6));
    }
    CHECK(convert({"--bytes", "1500"})["bytes"] <= 1500);
    const json rays = convert({"--max-transmittance-error", "0.01", "--path", "60"});
    CHECK(rays["worst_dT"].get<double>() <= 0.01);
    const std::vector<std::string> thinning = {
        "--extinction", "0.05",   "--profile", "exponential:3,8", "--max-transmittance-error",
        "0.01",         "--path", "60"};
    const json anywhere = convert(thinning);
    CHECK(anywhere["worst_dT"].get<double>() <= 0.01);
    std::vector<std::string> grounded = thinning;
    grounded.insert(grounded.end(), {"--ground", "2.5"});
    const json above = convert(grounded);
    CHECK(above["worst_dT"].get<double>() <= 0.01);
    CHECK(above["bytes"] < anywhere["bytes"]);
    for (const json& facts : {rays, anywhere, above}) {
        CHECK(facts["worst_dT"] <= facts["proved_dT"]);
        CHECK(facts["proved_dT"] <= 0.01);
    }
    // The first of them says how to get the second.
    std::vector<std::string> line = {"convert", "map.png", "-o", "out.wfog"};
    line.insert(line.end(), thinning.begin(), thinning.end());
    CHECK(contains(work.run(line).err, "--ground Y makes the file smaller"));
}

TEST_CASE("a truncated .wfog file is shown as far as it goes") {
    const Workspace work;
    work.write_ramp_png("map.png", 200, 160);
    REQUIRE(work.run({"convert", "map.png", "-o", "whole.wfog"}).status == 0);
    const std::string whole = work.read_text("whole.wfog");
    work.write_text("part.wfog", whole.substr(0, whole.size() / 2));
    work.write_text("stub.wfog", whole.substr(0, 20));
    const RunResult part = work.run({"info", "part.wfog", "--json"});
    CHECK(part.status == 0);
    CHECK(contains(part.err, "part.wfog: ends early; it is shown with the"));
    const json facts = json_of(part);
    CHECK(facts.at("stream_levels") < facts.at("of_stream_levels"));
    CHECK(contains(part.err, "the " + facts.at("stream_levels").dump() + " coarsest of " +
                                 facts.at("of_stream_levels").dump() + " levels"));
    CHECK(!facts.contains("max_error"));  // that of the whole file is not this map's
    const RunResult decoded = work.run({"decode", "part.wfog", "-o", "part.png"});
    CHECK(decoded.status == 0);
    CHECK(contains(decoded.out, "stream levels"));
    const json of_whole = json_of(work.run({"info", "whole.wfog", "--json"}));
    CHECK(of_whole.at("stream_levels") == of_whole.at("of_stream_levels"));
    CHECK(of_whole.at("max_error") == 0);
    work.write_text("rays.csv", "0,0,0,100,0,80\n");
    const RunResult probed = work.run({"probe", "part.wfog", "--rays", "rays.csv", "-o", "-"});
    CHECK(probed.status == 0);
    CHECK(contains(probed.err, "ends early"));
    // The same levels of the whole file.
    const std::string streams = facts.at("stream_levels").dump();
    REQUIRE(work.run({"decode", "whole.wfog", "-o", "first.png", "--streams", streams}).status ==
            0);
    CHECK(work.read_text("first.png") == work.read_text("part.png"));
    CHECK(work.run({"decode", "map.png", "-o", "x.png", "--streams", "1"}).status == 2);
    const RunResult stub = work.run({"info", "stub.wfog"});
    CHECK(stub.status == 1);
    CHECK(contains(stub.err, "stub.wfog: is truncated"));
}

TEST_CASE("convert of many files goes on past a bad one") {
    const Workspace work;
    work.write_ramp_png("a.png", 30, 20);
    work.write_ramp_png("b.png", 20, 30);
    work.write_text("bad.png", "no picture");
    REQUIRE(work.shell("mkdir out sub && cp a.png sub/a.png").status == 0);
    const RunResult some = work.run(
        {"convert", "a.png", "bad.png", "b.png", "-o", "out", "--max-error", "1/255", "--json"});
    CHECK(some.status == 1);
    CHECK(contains(some.err, "wavefog: error: bad.png: "));
    CHECK(contains(some.err, "out: 1 of 3 files failed"));
    const json facts = json::parse(some.out);
    CHECK(facts["converted"] == 2);
    CHECK(facts["failed"] == 1);
    CHECK(work.run({"info", "out/a.wfog"}).status == 0);
    CHECK(work.run({"info", "out/b.wfog"}).status == 0);

    CHECK(work.run({"convert", "a.png", "b.png", "-o", "out"}).status == 0);
    CHECK(work.run({"info", "out/b.exr"}).status == 0);
    const RunResult twice = work.run({"convert", "a.png", "sub/a.png", "-o", "out"});
    CHECK(twice.status == 2);
    CHECK(contains(twice.err, "both a.png and sub/a.png"));

    // A directory is made, by its parents if need be.
    CHECK(work.run({"convert", "a.png", "b.png", "-o", "new/maps", "--lossless"}).status == 0);
    CHECK(work.run({"info", "new/maps/b.wfog"}).status == 0);
    CHECK(work.run({"convert", "a.png", "b.png", "-o", "a.png/maps"}).status == 1);

    // What ends early must not come out looking whole.
    work.write_ramp_png("large.png", 200, 160);
    REQUIRE(work.run({"convert", "large.png", "-o", "large.wfog"}).status == 0);
    const std::string whole = work.read_text("large.wfog");
    work.write_text("part.wfog", whole.substr(0, whole.size() - 2));
    const RunResult part = work.run({"convert", "part.wfog", "a.png", "-o", "parts", "--lossless"});
    CHECK(part.status == 1);
    CHECK(contains(part.err, "part.wfog: ends early"));
    CHECK(work.run({"info", "parts/a.wfog"}).status == 0);
    CHECK(work.run({"info", "parts/part.wfog"}).status == 1);
}

TEST_CASE("the worst of the sampled rays is near the worst of all") {
    const Workspace work;
    std::vector<float> pixels;
    for (int j = 0; j < 48; ++j)
        for (int i = 0; i < 64; ++i)
            pixels.push_back(float(0.5 + 0.5 * std::sin(i * 0.3) * std::cos(j * 0.2 + i * 0.05)));
    work.write_floats("map.tif", 64, 48, pixels);
    // Uniform fog: the worst ray stays over one pixel, and the proof is exact.
    const json facts =
        json_of(work.run({"convert", "map.tif", "-o", "map.wfog", "--extinction", "0.05",
                          "--max-transmittance-error", "0.02", "--path", "40", "--json"}));
    CHECK(facts.at("proved_dT") > 0.01);
    // Rays go through coefficients of floats, off by up to 16 * 2^-24 of the densest (1 here,
    // decomposition.h), over an optical depth of 2; the proof is about the pixels.
    CHECK(facts.at("worst_dT") <= facts.at("proved_dT").get<double>() + 2e-6);
    CHECK(facts.at("worst_dT") <= 0.02);
    CHECK(facts.at("worst_dT") > 0.8 * facts.at("proved_dT").get<double>());
}

TEST_CASE("flags that contradict each other or the output are mistakes") {
    const Workspace work;
    work.write_ramp_png("map.png", 8, 8);
    const std::pair<std::vector<std::string>, const char*> cases[] = {
        {{"x.wfog", "--lossless", "--max-error", "1/255"}, "give one of them"},
        {{"x.wfog", "--max-transmittance-error", "0.01"}, "go together"},
        {{"x.wfog", "--path", "10"}, "go together"},
        {{"x.wfog", "--max-error", "1/255", "--ground", "0"}, "how low rays reach"},
        {{"x.wfog", "--ground", "low"}, "--ground"},
        {{"x.wfog", "--max-error", "0"}, "no number above 0"},
        {{"x.wfog", "--max-error", "1/0"}, "no number above 0"},
        {{"x.wfog", "--max-error", "2"}, "a fraction of the map's full scale"},
        {{"x.wfog", "--max-transmittance-error", "3/2", "--path", "9"}, "a difference of"},
        {{"x.wfog", "--bytes", "-3"}, "--bytes"},
        {{"x.wfog", "--precision", "half"}, "about .exr"},
        {{"x.exr", "--best"}, "about .wfog"},
        {{"x.exr", "--max-error", "0.1"}, "about .wfog"}};
    for (const auto& [arguments, message] : cases) {
        std::vector<std::string> line = {"convert", "map.png", "-o"};
        line.insert(line.end(), arguments.begin(), arguments.end());
        const RunResult result = work.run(line);
        INFO(result.err);
        CHECK(result.status == 2);
        CHECK(contains(result.err, message));
    }
    const RunResult small = work.run({"convert", "map.png", "-o", "x.wfog", "--bytes", "5"});
    CHECK(small.status == 1);
    CHECK(contains(small.err, "cannot be as small as 5 bytes"));
    CHECK(work.files() == std::set<std::string>{"map.png"});
}

}  // namespace wavefog::test
