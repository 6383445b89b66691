// Products of tabulated functions: both integrals, tables from scene files, what is refused.
#include <doctest/doctest.h>

#include <cmath>

#include "fogmap/fog_support.h"
#include "fogmap/model_support.h"
#include "support/temp_dir.h"
#include "wavefog/fogmap/scene.h"

using namespace wavefog;
using namespace wavefog::test;
using Eigen::Vector3d;

namespace {

Separable published(Separable fog) {
    fog.integral = Separable::Integral::published;
    return fog;
}

Separable exact(Separable fog) {
    fog.integral = Separable::Integral::exact;
    return fog;
}

/// The mean of one axis's function along a segment, by quadrature of its values.
double axis_mean(const Separable& fog, std::size_t axis, const Vector3d& o, const Vector3d& p) {
    Separable one{1, {}, Separable::Integral::exact};
    one.axes[axis] = fog.axes[axis];
    const AdaptiveSimpson along([&](double t) { return extinction(one, o + t * (p - o)); });
    return along.integral(0, 1, 26, 1e-12);
}

/// A scene of one fog.
Result<Scene> load(const TempDir& dir, const std::string& fog) {
    write_bytes(dir / "scene.json",
                R"({"camera": {"eye": [0, 2, 0], "target": [0, 2, -1]}, "fog": [)" + fog + "]}");
    return load_scene(dir / "scene.json");
}

}  // namespace

TEST_CASE("separable: repeated tables equal adaptive quadrature") {
    Random random(31);
    for (int round = 0; round < 4; ++round) {
        const FogModel fog = random_separable(random, {0, 0, 0}, true);
        for (const auto& [o, p] : model_segments(random, 60)) {
            const double metres = (p - o).norm();
            const AdaptiveSimpson along([&](double t) { return extinction(fog, o + t * (p - o)); });
            CHECK(std::abs(optical_depth(fog, o, p) -
                           metres * along.integral(0, 1, 26, 1e-11 / std::max(metres, 1.0))) <
                  1e-9);
        }
    }
}

TEST_CASE("separable: as published it is distance times the product of the three means") {
    Random random(37);
    for (const bool repeat : {false, true}) {
        const Separable fog = published(random_separable(random, {0, 0, 0}, repeat));
        for (const auto& [o, p] : model_segments(random, 100)) {
            const double expected = 0.03 * (p - o).norm() * axis_mean(fog, 0, o, p) *
                                    axis_mean(fog, 1, o, p) * axis_mean(fog, 2, o, p);
            CHECK(std::abs(optical_depth(FogModel(fog), o, p) - expected) < 1e-9);
        }
    }
}

TEST_CASE("separable: both integrals agree along an axis and with one table, not elsewhere") {
    Random random(41);
    const Separable fog = random_separable(random, {0, 0, 0}, true);
    const auto tau = [](const Separable& of, const Vector3d& o, const Vector3d& p) {
        return optical_depth(FogModel(of), o, p);
    };
    double most = 0;
    for (int i = 0; i < 200; ++i) {
        const Vector3d o = random_vector(random, 15), p = random_vector(random, 15);
        for (int a = 0; a < 3; ++a) {
            Vector3d along = o;
            along[a] = p[a];
            CHECK(tau(published(fog), o, along) == doctest::Approx(tau(exact(fog), o, along)));
        }
        Separable one = fog;
        one.axes[0].values.clear();
        one.axes[2].values.clear();
        CHECK(tau(published(one), o, p) == doctest::Approx(tau(exact(one), o, p)));
        most = std::max(most, std::abs(tau(published(fog), o, p) / tau(exact(fog), o, p) - 1));
        // The half way there and the half way on do not make the way as published.
        const Vector3d m = (o + p) / 2;
        CHECK(tau(exact(fog), o, m) + tau(exact(fog), m, p) ==
              doctest::Approx(tau(exact(fog), o, p)));
    }
    CHECK(most > 0.1);
    const Vector3d o(-18, -15, -18), p(18, 14, 18), m = (o + p) / 2;
    const double parts = tau(published(fog), o, m) + tau(published(fog), m, p);
    CHECK(std::abs(parts / tau(published(fog), o, p) - 1) > 0.01);
}

TEST_CASE("separable: a table of two points is a ramp, and a product of two ramps is a parabola") {
    const FogModel ramp = Ramp{{{2, 0.04}, {12, 0}}};
    const FogModel table = Separable{
        0.04, {AxisTable{}, AxisTable{{1, 0}, 2, 12}, AxisTable{}}, Separable::Integral::exact};
    Random random(43);
    for (const auto& [o, p] : model_segments(random, 400))
        CHECK(optical_depth(table, o, p) == doctest::Approx(optical_depth(ramp, o, p)));
    // x y along the diagonal of a square of 6 m: integral of t^2.
    const AxisTable rising{{0, 1}, 0, 6};
    const FogModel both{Separable{0.5, {rising, AxisTable{}, rising}, Separable::Integral::exact}};
    const FogModel paper{
        Separable{0.5, {rising, AxisTable{}, rising}, Separable::Integral::published}};
    const double metres = std::sqrt(72.0);
    CHECK(optical_depth(both, {0, 0, 0}, {6, 0, 6}) == doctest::Approx(0.5 * metres / 3));
    CHECK(optical_depth(paper, {0, 0, 0}, {6, 0, 6}) == doctest::Approx(0.5 * metres / 4));
}

TEST_CASE("separable: scenes give values, noise, cosines and exponentials as tables") {
    const TempDir dir;
    const auto scene = load(dir, R"(
        {"model": "layers", "profile": "table", "extinction": 0.1,
         "y": {"values": [1, 0.5, 0], "begin": 2, "end": 6}},
        {"model": "separable", "extinction": 0.2, "integral": "published",
         "x": {"noise": {"seed": 4, "features": 5}, "begin": -50, "end": 150},
         "y": {"exponential": 8, "begin": 3},
         "z": {"cosine": 0.5, "begin": 0, "end": 40}})");
    REQUIRE_MESSAGE(scene.has_value(), (scene ? "" : scene.error().message));
    REQUIRE(scene->models.size() == 2);
    CHECK(extinction(scene->models[0], {9, 3, 9}) == doctest::Approx(0.075));
    CHECK(extinction(scene->models[0], {9, -3, 9}) == doctest::Approx(0.1));
    const auto& fog = std::get<Separable>(scene->models[1]);
    CHECK(fog.integral == Separable::Integral::published);
    const auto& noise = fog.axes[0];
    CHECK(noise.repeat);
    CHECK(*std::min_element(noise.values.begin(), noise.values.end()) == 0);
    CHECK(*std::max_element(noise.values.begin(), noise.values.end()) == 1);
    // Straight lines over 1/32 of a scale: (1/32)^2 / 8 of the value.
    Separable height{1, {AxisTable{}, fog.axes[1], AxisTable{}}, Separable::Integral::exact};
    for (const double y : {-3.0, 3.0, 5.1, 11.2, 40.0})
        CHECK(std::abs(extinction(FogModel(height), {0, y, 0}) -
                       std::exp(-std::max(y - 3, 0.0) / 8)) < 1.3e-4);
    Separable waves{1, {AxisTable{}, AxisTable{}, fog.axes[2]}, Separable::Integral::exact};
    for (const double z : {-3.0, 0.0, 10.3, 77.0})
        CHECK(std::abs(extinction(FogModel(waves), {0, 0, z}) -
                       (1 + 0.5 * std::cos(2 * 3.14159265358979 * z / 40)) / 1.5) < 1e-4);
}

TEST_CASE("separable: mistakes name the key") {
    const TempDir dir;
    for (const auto& [axis, message] :
         {std::pair{R"({"values": [1], "begin": 0, "end": 1})", "y.values has 1 entries"},
          {R"({"values": [], "begin": 0, "end": 1})", "fog[0].y.values: is empty"},
          {R"({"values": [1, -1], "begin": 0, "end": 1})", "y.values[1] is -1"},
          {R"({"values": [1, 2], "begin": 1, "end": 1})", "y.end is 1, begin is 1"},
          {R"({"values": [1, 2], "begin": 0, "end": 1, "outside": "repeat"})",
           "y.values begins with 1 and ends with 2"},
          {R"({"values": [1, 2], "cosine": 1, "begin": 0, "end": 1})", "fog[0].y: needs one of"},
          {R"({"begin": 0, "end": 1})", "fog[0].y: needs one of"},
          {R"({"values": [1, 2], "end": 1})", "fog[0].y.begin: is missing"},
          {R"({"exponential": 0, "begin": 1})", "fog[0].y.exponential"},
          {R"({"exponential": 2, "begin": 1, "end": 3})", "fog[0].y.end: unknown key"},
          {R"({"cosine": 1.5, "begin": 0, "end": 1})", "fog[0].y.cosine"},
          {R"({"noise": {"features": 0}, "begin": 0, "end": 1})", "fog[0].y.noise.features"},
          {R"({"noise": {"features": 3, "speed": 1}, "begin": 0, "end": 1})",
           "fog[0].y.noise.speed: unknown key"}}) {
        const auto scene =
            load(dir, std::string(R"({"model": "separable", "extinction": 1, "y": )") + axis + "}");
        REQUIRE_FALSE(scene.has_value());
        CHECK_MESSAGE(scene.error().message.find(message) != std::string::npos,
                      scene.error().message);
    }
    const auto negative = load(dir, R"({"model": "separable", "extinction": -1})");
    REQUIRE_FALSE(negative.has_value());
    CHECK(negative.error().message.find("fog[0]: extinction is -1") != std::string::npos);
}

TEST_CASE("channels: scenes give them to maps, formulas and particles; mistakes name the key") {
    const TempDir dir;
    write_bytes(dir / "map.pgm", "P2 2 2 255\n255 0 128 64\n");
    const std::string map = R"({"model": "wavelet", "image": "map.pgm", "rect": [0, 0, 2, 2],
                                "extinction": 1, "channels": )";
    const std::string layer = R"({"model": "layers", "profile": "depth", "surface": 1,
                                  "gradient": 1, "channels": )";
    const std::string source = R"({"model": "particles", "source": "fog", "position": [0, 0, 0],
                                   "rate": 1, "radius": [1, 2], "channels": )";
    for (const std::string& fog : {map, layer, source}) {
        const auto scene = load(dir, fog + "[1, 0.5, 0]}");
        REQUIRE_MESSAGE(scene.has_value(), (scene ? "" : scene.error().message));
        const std::vector<Channels> expected = {{1, 0.5, 0}},
                                    particles = channels_of(scene->particles);
        CHECK((!scene->fogs.empty()     ? channels_of(scene->fogs)
               : !scene->models.empty() ? channels_of(scene->models)
                                        : particles) == expected);
        CHECK(coloured(scene->fogs, scene->models, particles));
        for (const auto& [channels, message] :
             {std::pair{"[1, 1]}", "fog[0].channels: "},
              {"[0, 0, 0]}", "no colour sees the fog"},
              {"[1, -0.5, 0]}", "channels is [1, -0.5, 0]; each must be 0 or more"}}) {
            const auto bad = load(dir, fog + channels);
            REQUIRE_FALSE(bad.has_value());
            CHECK_MESSAGE(bad.error().message.find(message) != std::string::npos,
                          bad.error().message);
        }
        const auto grey = load(dir, fog + "[1, 1, 1]}");
        CHECK_FALSE(coloured(grey->fogs, grey->models, channels_of(grey->particles)));
    }
}
