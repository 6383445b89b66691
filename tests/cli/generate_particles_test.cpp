// wavefog generate and probe with particles and with fog by colour channel, end to end.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "run.h"

using namespace wavefog::test;
using nlohmann::json;

namespace {

json generate(const Workspace& work, std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "generate");
    arguments.push_back("--json");
    const RunResult result = work.run(arguments);
    REQUIRE_MESSAGE(result.status == 0, result.err);
    return json::parse(result.out);
}

/// The columns that probe appends to each ray, `count` of them.
std::vector<std::vector<double>> probe(const Workspace& work, const std::string& fog,
                                       const std::string& rays, std::size_t count = 2,
                                       std::vector<std::string> more = {}) {
    more.insert(more.begin(), {"probe", fog, "--rays", "-", "-o", "-"});
    const RunResult result = work.run(more, rays);
    REQUIRE_MESSAGE(result.status == 0, result.err);
    std::vector<std::vector<double>> rows;
    std::istringstream lines(result.out);
    for (std::string line; std::getline(lines, line);) {
        std::istringstream parts(line);
        std::vector<double> values;
        for (std::string part; std::getline(parts, part, ',');) values.push_back(std::stod(part));
        REQUIRE(values.size() == 6 + count);
        rows.emplace_back(values.begin() + 6, values.end());
    }
    return rows;
}

/// Vertical rays between the heights of "slab:Y0,Y1", spread over a rectangle.
std::string vertical_rays(const json& facts, int count) {
    const std::string slab = facts["profile"];
    const auto comma = slab.find(',');
    const std::string low = slab.substr(5, comma - 5), high = slab.substr(comma + 1);
    const double x0 = facts["rect"][0], z0 = facts["rect"][1], x1 = facts["rect"][2],
                 z1 = facts["rect"][3];
    std::ostringstream rays;
    rays.precision(17);
    for (int i = 0; i < count; ++i) {
        const double x = x0 + (x1 - x0) * std::fmod(0.5 + i * 0.6180339887, 1);
        const double z = z0 + (z1 - z0) * std::fmod(0.5 + i * 0.7548776662, 1);
        rays << x << ',' << low << ',' << z << ',' << x << ',' << high << ',' << z << '\n';
    }
    return rays.str();
}

std::string text(const json& value) {
    std::string words = value.dump();
    std::erase_if(words, [](char c) { return c == '[' || c == ']'; });
    return words;
}

/// Converts a generated map to the fog that it belongs to.
void convert(const Workspace& work, const std::string& map, const std::string& fog,
             const json& facts) {
    const RunResult result =
        work.run({"convert", map, "-o", fog, "--rect", text(facts["rect"]), "--extinction",
                  facts["extinction"].dump(), "--profile", facts["profile"]});
    REQUIRE_MESSAGE(result.status == 0, result.err);
}

double largest_error(const std::vector<std::vector<double>>& a,
                     const std::vector<std::vector<double>>& b) {
    REQUIRE(a.size() == b.size());
    double largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i)
        largest = std::max(largest, std::abs(a[i].back() - b[i].back()));
    return largest;
}

const char* const kView = R"("size": [9, 9], "camera": {"eye": [0, 3, 40], "target": [0, 3, 0],
                             "far": 80})";

std::string scene(const std::string& fogs, const std::string& more = "") {
    return std::string("{") + kView + more + ", \"fog\": [" + fogs + "]}";
}

const char* const kSource = R"({"model": "particles", "source": "fog", "position": [0, 4, 0],
    "area": 6, "spread_deg": 80, "rate": 30, "radius": [3, 6], "wind": [2, 1], "drag": 0.4})";

}  // namespace

TEST_CASE("generate: a state of particles becomes a map whose vertical rays keep their clarity") {
    const Workspace work;
    work.write_text("scene.json", scene(kSource));
    double before = 1;
    for (const char* size : {"64x64", "128x128", "256x256"}) {
        const json facts =
            generate(work, {"scene.json", "-o", "map.exr", "--size", size, "--time", "3.5"});
        CHECK(facts["particles"] > 200);
        const Picture map = read_picture(work.path("map.exr"));
        const auto [low, high] = std::minmax_element(map.pixels.begin(), map.pixels.end());
        CHECK(*low == 0.0f);
        CHECK(*high == 1.0f);
        convert(work, "map.exr", "fog.exr", facts);
        const std::string rays = vertical_rays(facts, 400);
        const auto truth = probe(work, "scene.json", rays, 2, {"--time", "3.5"});
        const double thickest = std::max_element(truth.begin(), truth.end())->front();
        CHECK(thickest > 1);
        const double error = largest_error(probe(work, "fog.exr", rays), truth);
        MESSAGE(std::string(size), ": largest |dT| of vertical rays ", error);
        // Straight lines between pixels miss the tips of the cones that particles are, by the fewer
        // the finer pixels are; which tips a ray passes is chance.
        CHECK(error < 0.75 * before);
        before = error;
    }
    CHECK(before < 3e-3);
}

TEST_CASE("generate: a pixel is the clarity through its centre, between the heights of --mean") {
    const Workspace work;
    work.write_text("scene.json", scene(kSource));
    const json facts = generate(work, {"scene.json", "-o", "map.exr", "--size", "8x8", "--mean",
                                       "3.5,5", "--rect", "-8,-8,8,8"});
    CHECK(facts["profile"] == "slab:3.5,5");
    const Picture map = read_picture(work.path("map.exr"));
    std::string rays;
    for (int j = 0; j < 8; ++j)
        for (int i = 0; i < 8; ++i) {
            const std::string x = std::to_string(2 * i - 7), z = std::to_string(2 * j - 7);
            rays += x + ",3.5," + z + "," + x + ",5," + z + "\n";
        }
    const auto truth = probe(work, "scene.json", rays);
    for (std::size_t k = 0; k < 64; ++k)
        CHECK(double(map.pixels[k]) * facts["extinction"].get<double>() * 1.5 ==
              doctest::Approx(truth[k][0]).epsilon(1e-6));
}

TEST_CASE("generate particles: every flag is the scene's key") {
    const Workspace work;
    const std::vector<std::pair<std::string, std::string>> keys = {
        {"source", "smoke"},  {"position", "1,2,3"},
        {"area", "2.5"},      {"direction", "1,1,0"},
        {"spread_deg", "20"}, {"speed", "2"},
        {"rate", "25"},       {"life", "5,30"},
        {"step", "0.2"},      {"radius", "1,4"},
        {"opacity", "0.6"},   {"lift", "0.3"},
        {"drag", "0.25"},     {"wind", "[[0,1,0],[3,-1,2]]"},
        {"seed", "77"}};
    const std::vector<std::string> place = {"--size", "40x30",         "--time", "2",
                                            "--rect", "-20,-20,30,20", "--mean", "-5,20"};
    std::vector<std::string> arguments = {"particles", "-o", "flags.exr"};
    std::string fog = R"({"model": "particles")";
    for (const auto& [key, value] : keys) {
        std::string flag = key;
        std::replace(flag.begin(), flag.end(), '_', '-');
        arguments.insert(arguments.end(), {"--" + flag, value});
        const bool list = value.find(',') != value.npos && value.front() != '[';
        fog += ", \"" + key + "\": " +
               (key == "source" ? "\"smoke\""
                : list          ? "[" + value + "]"
                                : value);
    }
    work.write_text("scene.json", scene(fog + "}"));
    arguments.insert(arguments.end(), place.begin(), place.end());
    const json flags = generate(work, arguments);
    std::vector<std::string> named = {"scene.json", "-o", "scene.exr"};
    named.insert(named.end(), place.begin(), place.end());
    const json whole = generate(work, named);
    CHECK(flags["seed"] == 77);
    CHECK(flags["particles"] == whole["particles"]);
    CHECK(flags["extinction"] == whole["extinction"]);
    CHECK(flags["extinction"] > 0);
    CHECK(read_picture(work.path("flags.exr")).pixels ==
          read_picture(work.path("scene.exr")).pixels);
    // Each of them alone changes the map.
    const auto with = [&](const std::string& flag, const std::string& value) {
        std::vector<std::string> all = {"particles", "-o", "one.exr"};
        if (!flag.empty()) all.insert(all.end(), {flag, value});
        all.insert(all.end(), place.begin(), place.end());
        const json facts = generate(work, all);
        Picture p = read_picture(work.path("one.exr"));
        for (float& v : p.pixels) v *= facts["extinction"].get<float>();
        return p.pixels;
    };
    const auto plain = with("", "");
    for (const auto& [key, value] : keys) {
        std::string flag = "--" + key;
        std::replace(flag.begin(), flag.end(), '_', '-');
        CAPTURE(flag);
        // Without drag there is no wind to feel, and the other way round.
        if (key == "drag" || key == "wind") continue;
        CHECK(with(flag, value) != plain);
    }
    // The defaults are a bank of fog, and of smoke.
    for (const char* source : {"fog", "smoke"}) {
        const json facts = generate(work, {"particles", "--source", source, "-o", "p.png"});
        CHECK(facts["particles"] > 30);
        CHECK(read_picture(work.path("p.png")).width == 512);
    }
}

TEST_CASE("generate: states at several times are the keyframes of a map that changes") {
    const Workspace work;
    work.write_text("scene.json", scene(kSource));
    const std::vector<std::string> shared = {"--size", "48x48", "--rect",       "-24,-24,40,40",
                                             "--mean", "-4,12", "--extinction", "0.05"};
    json facts;
    std::string images;
    for (const char* time : {"0", "2", "4"}) {
        const std::string name = std::string("t") + time + ".exr";
        std::vector<std::string> arguments = {"scene.json", "-o", name, "--time", time};
        arguments.insert(arguments.end(), shared.begin(), shared.end());
        facts = generate(work, arguments);
        CHECK(facts["extinction"] == 0.05);
        images += (images.empty() ? "" : ", ") + std::string(R"({"time": )") + time +
                  R"(, "image": ")" + name + "\"}";
    }
    work.write_text("maps.json", scene(R"({"images": [)" + images + R"(], "basis": "haar",
        "rect": [-24, -24, 40, 40], "extinction": 0.05,
        "height": {"profile": "slab", "bottom": -4, "top": 12}})"));
    // Haar keeps a pixel's value over all of it: rays through centres.
    std::string rays;
    for (int k = 0; k < 48; k += 5)
        for (int i = 0; i < 48; i += 3) {
            const double x = -24 + (i + 0.5) * 64 / 48, z = -24 + (k + 0.5) * 64 / 48;
            const std::string place[] = {std::to_string(x), std::to_string(z)};
            rays += place[0] + ",-4," + place[1] + "," + place[0] + ",12," + place[1] + "\n";
        }
    std::vector<std::vector<std::vector<double>>> truths;
    for (const char* time : {"0", "2", "4"}) {
        truths.push_back(probe(work, "scene.json", rays, 2, {"--time", time}));
        const auto drawn = probe(work, "maps.json", rays, 2, {"--time", time});
        // Rays were written with 6 decimals, coefficients are floats.
        CHECK(largest_error(drawn, truths.back()) < 1e-5);
    }
    // Between keys the optical depth is linear in time.
    const auto drawn = probe(work, "maps.json", rays, 2, {"--time", "2.5"});
    for (std::size_t i = 0; i < drawn.size(); ++i)
        CHECK(std::abs(drawn[i][0] - (0.75 * truths[1][i][0] + 0.25 * truths[2][i][0])) < 2e-5);
}

TEST_CASE("generate: a scene's time moves its winds and shows its keyframes") {
    const Workspace work;
    work.write_ramp_png("map.png", 16, 16);
    work.write_text("scene.json", scene(R"({"model": "cosines", "extinction": 0.02, "wind": [1, 0],
        "waves": [{"extinction": 0.02, "direction": [1, 0, 0], "frequency": 0.5}]},
        {"image": "map.png", "rect": [-8, -8, 8, 8], "extinction": 0.1, "wrap": "repeat",
         "wind": [1, 0]})"));
    const auto at = [&](const char* time, const char* rect) {
        generate(work, {"scene.json", "-o", "m.exr", "--size", "16x4", "--height", "1", "--time",
                        time, "--rect", rect, "--extinction", "1"});
        return read_picture(work.path("m.exr"));
    };
    CHECK(largest_difference(at("3", "0,0,16,4"), at("0", "-3,0,13,4")) < 1e-6);
    CHECK(largest_difference(at("3", "0,0,16,4"), at("0", "0,0,16,4")) > 1e-3);
}

TEST_CASE("probe: particles add to other fogs, with every method, and meet the scene's ground") {
    const Workspace work;
    work.write_ramp_png("hill.png", 16, 16);
    const std::string layer = R"({"model": "layers", "profile": "exponential", "extinction": 0.01,
                                  "base": 0, "scale": 5})";
    const std::string falling = R"({"model": "particles", "source": "fog", "position": [0, 9, 0],
        "direction": [0, -1, 0], "area": 10, "rate": 40, "radius": [3, 5], "lift": -1,
        "speed": 3})";
    const std::string ground = R"(, "terrain": {"heightmap": "hill.png",
        "rect": [-40, -40, 40, 40], "height": [0, 6]})";
    work.write_text("layer.json", scene(layer));
    work.write_text("particles.json", scene(falling, ground));
    work.write_text("both.json", scene(layer + ", " + falling, ground));
    work.write_text("through.json", scene(falling));
    const std::string rays = "0,3,40,0,3,-40\n-20,8,7,20,1,-7\n0,0,0,0,20,0\n5,5,5,5,5,5\n";
    for (const char* method : {"reference", "exact", "radial"}) {
        const std::vector<std::string> more = {"--method", method, "--time", "1.25"};
        const auto a = probe(work, "layer.json", rays, 2, more);
        const auto b = probe(work, "particles.json", rays, 2, more);
        const auto sum = probe(work, "both.json", rays, 2, more);
        for (std::size_t i = 0; i < sum.size(); ++i)
            CHECK(sum[i][0] == doctest::Approx(a[i][0] + b[i][0]).epsilon(1e-12));
        CHECK(b[0][0] > 0.1);
        CHECK(largest_error(b, probe(work, "particles.json", rays, 2, {"--time", "1.25"})) <= 2e-6);
        CHECK(largest_error(b, probe(work, "through.json", rays, 2, more)) > 1e-3);
    }
    // The middle pixel of a picture looks along the first ray, to the sky at 80 m.
    REQUIRE(work.run({"render", "both.json", "-o", "r.exr", "--transmittance", "T.exr", "--time",
                      "1.25"})
                .status == 0);
    const double seen = double(read_picture(work.path("T.exr")).at(4, 4));
    const auto sky = probe(work, "both.json", "0,3,40,0,3,-40\n", 2, {"--time", "1.25"});
    work.write_text("bare.json", scene(layer + ", " + falling));
    CHECK(sky[0][1] > 0);
    // The ground may end the ray earlier: no more than the whole of it is lost.
    CHECK(seen >= sky[0][1] - 2e-6);
    REQUIRE(work.run({"render", "bare.json", "-o", "r.exr", "--transmittance", "T.exr"}).status ==
            0);
    CHECK(std::abs(double(read_picture(work.path("T.exr")).at(4, 4)) -
                   probe(work, "bare.json", "0,3,40,0,3,-40\n")[0][1]) <= 2e-6);
}

TEST_CASE("probe and generate: fog by colour channel comes in three columns and three maps") {
    const Workspace work;
    const std::string grey = R"({"model": "layers", "profile": "ramp",
        "points": [[0, 0.02], [10, 0]]})";
    const std::string red = R"({"model": "layers", "profile": "ramp",
        "points": [[0, 0.05], [4, 0]], "channels": [1, 0.5, 0]})";
    work.write_text("grey.json", scene(grey));
    work.write_text("red.json", scene(red));
    work.write_text("both.json", scene(grey + ", " + red));
    const std::string rays = "0,3,40,0,1,-40\n0,0,0,0,20,0\n";
    for (const char* method : {"reference", "exact"}) {
        const auto a = probe(work, "grey.json", rays, 2, {"--method", method});
        const auto b = probe(work, "red.json", rays, 6, {"--method", method});
        const auto sum = probe(work, "both.json", rays, 6, {"--method", method});
        for (std::size_t i = 0; i < sum.size(); ++i)
            for (std::size_t c = 0; c < 3; ++c) {
                CHECK(b[i][c] == doctest::Approx(b[i][0] * (2 - double(c)) / 2).epsilon(1e-6));
                CHECK(sum[i][c] == doctest::Approx(a[i][0] + b[i][c]).epsilon(1e-6));
                CHECK(sum[i][3 + c] == doctest::Approx(std::exp(-sum[i][c])));
            }
    }
    const RunResult named =
        work.run({"probe", "both.json", "--rays", "-", "-o", "-"}, "ox,oy,oz,px,py,pz\n" + rays);
    CHECK(named.out.find("ox,oy,oz,px,py,pz,optical_depth_red,optical_depth_green,"
                         "optical_depth_blue,transmittance_red,transmittance_green,"
                         "transmittance_blue\n") == 0);
    const std::vector<std::string> place = {"--height", "2", "--rect", "0,0,4,4", "--size", "4x4"};
    for (const auto& [channel, share] : {std::pair{"R", 1.0}, {"G", 0.5}, {"B", 0.0}}) {
        std::vector<std::string> arguments = {"both.json", "-o", "m.exr", "--channel", channel};
        arguments.insert(arguments.end(), place.begin(), place.end());
        CHECK(generate(work, arguments)["extinction"].get<double>() ==
              doctest::Approx(0.016 + 0.025 * share).epsilon(1e-6));
    }
}

TEST_CASE("probe, generate and render: particles by colour channel, of several sources") {
    const Workspace work;
    const std::string whole = kSource, end = whole.substr(0, whole.rfind('}'));
    const std::string red = end + R"(, "channels": [1, 0.5, 0]})";
    const std::string other = end + R"(, "seed": 12, "channels": [0, 0.5, 2]})";
    work.write_text("grey.json", scene(kSource));
    work.write_text("red.json", scene(red));
    work.write_text("both.json", scene(red + ", " + other));
    const std::string rays = "0,3,40,0,3,-40\n0,0,0,0,20,0\n";
    for (const char* method : {"reference", "exact"}) {
        const auto grey = probe(work, "grey.json", rays, 2, {"--method", method});
        const auto a = probe(work, "red.json", rays, 6, {"--method", method});
        const auto both = probe(work, "both.json", rays, 6, {"--method", method});
        CHECK(grey[0][0] > 0);
        for (std::size_t i = 0; i < a.size(); ++i) {
            for (std::size_t c = 0; c < 3; ++c)
                CHECK(a[i][c] == doctest::Approx(grey[i][0] * (2 - double(c)) / 2).epsilon(1e-6));
            CHECK(both[i][0] == doctest::Approx(a[i][0]).epsilon(1e-6));
            CHECK(both[i][2] == doctest::Approx(4 * (both[i][1] - a[i][1])).epsilon(1e-6));
        }
    }
    std::map<std::string, double> densest;
    for (const char* channel : {"R", "G", "B"})
        densest[channel] = generate(work, {"red.json", "-o", "m.exr", "--mean", "0,12", "--size",
                                           "24x24", "--channel", channel})["extinction"];
    CHECK(densest["R"] > 0);
    CHECK(densest["G"] == doctest::Approx(densest["R"] / 2));
    CHECK(densest["B"] == 0);
    // The picture, by the shader and by the reference.
    for (const char* method : {"reference", "exact"})
        REQUIRE(work.run({"render", "both.json", "-o", "p.exr", "--method", method,
                          "--transmittance", std::string(method) + ".exr"})
                    .status == 0);
    const Picture truth = read_picture(work.path("reference.exr")),
                  drawn = read_picture(work.path("exact.exr"));
    REQUIRE(drawn.channels == 3);
    CHECK(largest_difference(truth, drawn) <= 6e-6);
}

TEST_CASE("generate: what makes no sense with particles and channels is refused and named") {
    const Workspace work;
    work.write_text("scene.json", scene(kSource));
    work.write_text("red.json", scene(R"({"model": "layers", "profile": "ramp",
        "points": [[0, 0.05], [4, 0]], "channels": [1, 0.5, 0]})"));
    const auto files = work.files();
    const auto refused = [&](std::vector<std::string> arguments, int status, const char* what,
                             const char* output = "out.exr") {
        arguments.insert(arguments.begin(), "generate");
        arguments.insert(arguments.end(), {"-o", output, "--size", "8x8"});
        const RunResult result = work.run(arguments);
        CAPTURE(std::string(what));
        CHECK(result.status == status);
        CHECK_MESSAGE(result.err.find(what) != std::string::npos, result.err);
        CHECK(work.files() == files);
    };
    refused({"scene.json", "--height", "3"}, 2, "--height: particles dim rays");
    refused({"scene.json", "--rate", "3"}, 2, "--source to --wind are about model particles");
    refused({"particles", "--features", "3"}, 2, "are about noise");
    refused({"perlin", "--time", "3"}, 2, "are about scenes and particles");
    refused({"particles", "--rate", "-3"}, 2, "particles: rate is -3");
    refused({"particles", "--radius", "1"}, 2, "particles: radius");
    refused({"particles", "--radius", "0,1"}, 2, "particles: radius[0] is 0");
    refused({"particles", "--position", "here"}, 2, "particles: position");
    refused({"particles", "--source", "steam"}, 2, "it must be one of: fog, smoke");
    refused({"particles", "--seed", "99999999999"}, 2, "particles: seed");
    refused({"particles", "--extinction", "0"}, 2, "--extinction");
    refused({"particles", "--extinction", "1e-9"}, 1, "times --extinction, and a .png ends at 1",
            "out.png");
    refused({"red.json", "--height", "2", "--rect", "0,0,1,1"}, 2, "--channel R, G or B");
    refused({"red.json", "--channel", "Y"}, 2, "--channel");
    // Particles between pixels are told.
    const RunResult small = work.run({"generate", "particles", "-o", "small.exr", "--size", "8x8",
                                      "--radius", "0.1,0.2", "--area", "50"});
    CHECK(small.status == 0);
    CHECK(small.err.find("are smaller than two pixels") != std::string::npos);
}
