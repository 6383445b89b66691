// wavefog probe, end to end, against optical depths worked out by hand.
#include <doctest/doctest.h>

#include <cmath>
#include <sstream>

#include "run.h"

using namespace wavefog::test;

namespace {

struct Row {
    double optical_depth, transmittance;
};

/// The two columns that probe appends, and the rest of the line as it was.
std::pair<std::string, Row> split_row(const std::string& line) {
    const auto last = line.rfind(','), before = line.rfind(',', last - 1);
    return {line.substr(0, before),
            {std::stod(line.substr(before + 1)), std::stod(line.substr(last + 1))}};
}

std::vector<std::string> lines_of(const std::string& text) {
    std::istringstream stream(text);
    std::vector<std::string> lines;
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

}  // namespace

TEST_CASE("probe knows the optical depth of a single Haar cell") {
    const Workspace work;
    // One pixel of 0.5 in the middle of a 3x3 map of 10 m pixels: K = 0.04 * 0.5 = 0.02 /m there.
    work.write_floats("map.tif", 3, 3, {0, 0, 0, 0, 0.5f, 0, 0, 0, 0});
    REQUIRE(work.run({"convert", "map.tif", "-o", "fog.exr", "--basis", "haar", "--levels", "1",
                      "--rect", "0,0,30,30", "--extinction", "0.04", "--profile", "slab:0,5"})
                .status == 0);
    work.write_text("rays.csv",
                    "ox,oy,oz,px,py,pz\n"
                    "0,1,15,30,1,15\n"      // through the cell: 10 m
                    "12,1,15,17,1,15\n"     // inside it: 5 m
                    "0,6,15,30,6,15\n"      // above the slab
                    "15,-10,15,15,10,15\n"  // straight up through the slab: 5 m
                    "10,0,10,20,0,20\n"     // its diagonal
                    "15,1,15,15,1,15\n");   // no length
    const std::vector<double> expected = {0.2, 0.1, 0, 0.1, 0.02 * std::hypot(10, 10), 0};
    for (const char* method : {"reference", "exact"}) {
        CAPTURE(std::string(method));
        const RunResult result = work.run(
            {"probe", "fog.exr", "--rays", "rays.csv", "-o", "out.csv", "--method", method});
        REQUIRE_MESSAGE(result.status == 0, result.err);
        const auto rows = lines_of(work.read_text("out.csv"));
        REQUIRE(rows.size() == 7);
        CHECK(rows[0] == "ox,oy,oz,px,py,pz,optical_depth,transmittance");
        CHECK(split_row(rows[1]).first == "0,1,15,30,1,15");
        // Float32 in the shader; the map itself is a float file.
        const double allowed = std::string(method) == "reference" ? 1e-9 : 2e-6;
        for (std::size_t i = 0; i < expected.size(); ++i) {
            const Row row = split_row(rows[i + 1]).second;
            CHECK(std::abs(row.optical_depth - expected[i]) <= allowed);
            CHECK(row.transmittance ==
                  doctest::Approx(std::exp(-row.optical_depth)).epsilon(1e-15));
        }
    }
}

TEST_CASE("probe reads a pipe and writes a pipe, with all 17 digits") {
    const Workspace work;
    work.write_floats("map.tif", 1, 1, {1});
    REQUIRE(work.run({"convert", "map.tif", "-o", "fog.exr", "--basis", "haar", "--wrap", "repeat",
                      "--extinction", "0.1"})
                .status == 0);
    const RunResult result =
        work.run({"probe", "fog.exr", "--rays", "-", "-o", "-"}, "0,0,0,3,0,4\n0,0,0,0,7,0\n");
    REQUIRE_MESSAGE(result.status == 0, result.err);
    const auto rows = lines_of(result.out);
    REQUIRE(rows.size() == 2);
    CHECK(split_row(rows[0]).second.optical_depth == doctest::Approx(0.5).epsilon(1e-12));
    CHECK(split_row(rows[1]).second.optical_depth == doctest::Approx(0.7).epsilon(1e-12));
    CHECK(split_row(rows[0]).second.transmittance ==
          doctest::Approx(std::exp(-0.5)).epsilon(1e-12));
    // Text that reads back as the same double.
    const std::string digits = rows[0].substr(rows[0].rfind(',') + 1);
    std::ostringstream again;
    again.precision(17);
    again << std::stod(digits);
    CHECK(again.str() == digits);
}

TEST_CASE("probe writes to a device or a named pipe without replacing it") {
    const Workspace work;
    work.write_floats("map.tif", 1, 1, {1});
    const RunResult result = work.shell(
        "mkfifo pipe; cat pipe >copy & "
        "echo 0,0,0.5,1,0,0.5 | \"$WAVEFOG\" probe map.tif --rays - -o pipe && wait && test -p "
        "pipe");
    REQUIRE_MESSAGE(result.status == 0, result.err);
    CHECK(work.read_text("copy").starts_with("0,0,0.5,1,0,0.5,"));
    CHECK(work.files() == std::set<std::string>{"map.tif", "pipe", "copy"});
}

TEST_CASE("several fogs add up, and a picture is a fog too") {
    const Workspace work;
    work.write_floats("map.tif", 2, 2, {1, 1, 1, 1});
    const std::string fog = R"({"model": "wavelet", "image": "map.tif", "basis": "haar",
        "rect": [0, 0, 2, 2], "wrap": "repeat", "extinction": )";
    work.write_text("scene.json",
                    R"({"camera": {"eye": [0, 1, 0], "target": [1, 1, 0]}, "fog": [)" + fog +
                        "0.25}, " + fog + "0.5}]}");
    const RunResult both =
        work.run({"probe", "scene.json", "--rays", "-", "-o", "-"}, "0,0,0,4,0,0\n");
    REQUIRE_MESSAGE(both.status == 0, both.err);
    CHECK(split_row(lines_of(both.out)[0]).second.optical_depth == doctest::Approx(3));

    const RunResult picture =
        work.run({"probe", "map.tif", "--rays", "-", "-o", "-"}, "1,0,0.5,1,9,0.5\n");
    REQUIRE_MESSAGE(picture.status == 0, picture.err);
    CHECK(split_row(lines_of(picture.out)[0]).second.optical_depth > 0);
}

TEST_CASE("rays farther than float32 methods reach are refused with their place") {
    const Workspace work;
    work.write_text("scene.json", R"({"camera": {"eye": [0, 1, 0], "target": [1, 1, 0]}, "fog": [
        {"model": "halfspace", "normal": [0, 1, 0], "point": [0, 2, 0], "extinction": 0.5}]})");
    const RunResult far = work.run({"probe", "scene.json", "--rays", "-", "-o", "-"},
                                   "0,0,0,4,0,0\n0,0,0,0,0,-1e20\n");
    CHECK(far.status == 1);
    CHECK(far.err.find("line 2, column 6 (pz): -1e+20 m is farther") != std::string::npos);
    const RunResult near =
        work.run({"probe", "scene.json", "--rays", "-", "-o", "-"}, "0,0,0,1e9,0,0\n");
    CHECK(near.status == 0);
}

TEST_CASE("fogs given by formulas add to maps, and every method has them in closed form") {
    const Workspace work;
    work.write_floats("map.tif", 2, 2, {1, 1, 1, 1});
    work.write_text("scene.json", R"({"camera": {"eye": [0, 1, 0], "target": [1, 1, 0]}, "fog": [
        {"model": "halfspace", "normal": [0, 1, 0], "point": [0, 2, 0], "extinction": 0.5},
        {"model": "wavelet", "image": "map.tif", "basis": "haar", "rect": [0, 0, 2, 2],
         "wrap": "repeat", "extinction": 0.25},
        {"model": "layers", "profile": "ramp", "points": [[0, 0.125], [1, 0]]}]})");
    for (const char* method : {"reference", "exact", "march:4"}) {
        const RunResult run = work.run(
            {"probe", "scene.json", "--rays", "-", "-o", "-", "--method", method}, "0,0,0,4,0,0\n");
        REQUIRE_MESSAGE(run.status == 0, run.err);
        CHECK(split_row(lines_of(run.out)[0]).second.optical_depth ==
              doctest::Approx(4 * (0.5 + 0.25 + 0.125)).epsilon(1e-6));
    }
    work.write_text("bad.json", R"({"camera": {"eye": [0, 1, 0], "target": [1, 1, 0]}, "fog": [
        {"model": "halfspace", "normal": [0, 0, 0], "point": [0, 2, 0], "extinction": 0.5}]})");
    const RunResult bad =
        work.run({"probe", "bad.json", "--rays", "-", "-o", "-"}, "0,0,0,4,0,0\n");
    CHECK(bad.status == 1);
    CHECK(bad.err.find("bad.json: fog[0]: normal is [0, 0, 0]") != std::string::npos);
}

TEST_CASE("the methods agree with the reference as well as they promise") {
    const Workspace work;
    work.write_ramp_png("map.png", 32, 32);
    REQUIRE(work.run({"convert", "map.png", "-o", "fog.exr", "--extinction", "0.1"}).status == 0);
    std::string rays;
    for (int i = 0; i < 200; ++i)
        rays += std::to_string(i % 37 - 3) + ".25,1," + std::to_string(i % 11) + ",3,2," +
                std::to_string(31 - i % 29) + ".5\n";
    const auto depths = [&](const char* method, const char* mu) {
        const RunResult result = work.run(
            {"probe", "fog.exr", "--rays", "-", "-o", "-", "--method", method, "--mu", mu}, rays);
        REQUIRE_MESSAGE(result.status == 0, result.err);
        std::vector<double> values;
        for (const std::string& line : lines_of(result.out))
            values.push_back(split_row(line).second.transmittance);
        return values;
    };
    const auto largest = [&](const char* method, const char* mu) {
        const auto truth = depths("reference", mu), values = depths(method, mu);
        REQUIRE(values.size() == 200);
        double error = 0;
        for (std::size_t i = 0; i < truth.size(); ++i)
            error = std::max(error, std::abs(truth[i] - values[i]));
        return error;
    };
    CHECK(largest("exact", "1") <= 2e-6);
    CHECK(largest("exact", "0.5") <= 2e-6);
    CHECK(largest("exact", "0") <= 2e-6);
    CHECK(largest("march:256", "1") < largest("march:8", "1"));
    CHECK(largest("homogeneous", "1") > 1e-3);
}

TEST_CASE("an interrupted probe leaves no file") {
    const Workspace work;
    work.write_floats("map.tif", 1, 1, {1});
    REQUIRE(work.run({"convert", "map.tif", "-o", "fog.exr"}).status == 0);
    const auto before = work.files();
    // The signal comes while the command waits for more rays.
    const RunResult result = work.shell(
        "mkfifo rays; \"$WAVEFOG\" probe fog.exr --rays rays -o out.csv & pid=$!\n"
        "exec 3>rays; echo 0,0,0,1,1,1 >&3; sleep 0.5; kill -TERM $pid\n"
        "wait $pid; status=$?; exec 3>&-; rm rays; exit $status");
    CHECK(result.status == 128 + 15);
    CHECK(work.files() == before);
}
