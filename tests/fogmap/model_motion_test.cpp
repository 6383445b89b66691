// Formulas whose shape changes: what lies between two shapes, and scene files that hold them.
#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "fogmap/model_support.h"
#include "support/temp_dir.h"
#include "wavefog/fogmap/model_motion.h"
#include "wavefog/fogmap/scene.h"

using namespace wavefog;
using namespace wavefog::test;
using Eigen::Vector3d;

namespace {

/// Two shapes of every kind, unlike in all that may differ.
std::vector<std::pair<FogModel, FogModel>> shape_pairs(Random& random) {
    auto from = random_models(random), to = random_models(random, {3, 1, -2});
    for (FogModel& fraction : random_fractions(random)) {
        from.push_back(fraction);
        to.push_back(moved(fraction, {1, 2, 3}));
    }
    std::vector<std::pair<FogModel, FogModel>> pairs;
    for (std::size_t i = 0; i < from.size(); ++i) {
        if (auto* plane = std::get_if<Halfspace>(&to[i]))
            plane->normal = std::get<Halfspace>(from[i]).normal;
        if (auto* fog = std::get_if<Polynomials>(&to[i])) {
            const auto& before = std::get<Polynomials>(from[i]);
            for (std::size_t k = 0; k < fog->terms.size(); ++k) {
                fog->terms[k].direction = before.terms[k].direction;
                fog->terms[k].half_width = before.terms[k].half_width;
                fog->terms[k].outside = before.terms[k].outside;
            }
        }
        pairs.emplace_back(from[i], to[i]);
    }
    return pairs;
}

std::string complaint(const FogModel& a, const FogModel& b) {
    const auto ok = check_interpolable(a, b);
    return ok ? "" : ok.error().message;
}

}  // namespace

TEST_CASE("shapes: those between two valid ones are valid, and the ends are the shapes") {
    Random random(401);
    for (int round = 0; round < 10; ++round)
        for (const auto& [a, b] : shape_pairs(random)) {
            CAPTURE(kind_name(a));
            REQUIRE(complaint(a, b).empty());
            for (const double share : {0.0, 0.1, 0.5, 0.83, 1.0}) {
                const FogModel between = interpolate(a, b, share);
                const auto ok = validate(between);
                CHECK_MESSAGE(ok.has_value(), (ok ? "" : ok.error().message));
            }
            for (const auto& [o, p] : model_segments(random, 20)) {
                const double at_a = optical_depth(a, o, p), at_b = optical_depth(b, o, p);
                CHECK_LE(std::abs(optical_depth(interpolate(a, b, 0), o, p) - at_a),
                         1e-12 * (1 + at_a));
                // b - a is rounded, so that a + (b - a) may miss b by its last digits.
                CHECK_LE(std::abs(optical_depth(interpolate(a, b, 1), o, p) - at_b),
                         1e-9 * (1 + at_b));
                CHECK(optical_depth(interpolate(a, b, 0.4), o, p) >= 0);
            }
        }
}

TEST_CASE("shapes: coefficients mix as the fogs do") {
    // What is linear in its coefficients is the mean of both fogs, at every point.
    Random random(403);
    for (auto [a, b] : shape_pairs(random)) {
        if (auto* fog = std::get_if<Cosines>(&b)) {
            const auto& before = std::get<Cosines>(a);
            for (std::size_t i = 0; i < fog->waves.size(); ++i) {
                fog->waves[i].direction = before.waves[i].direction;
                fog->waves[i].frequency = before.waves[i].frequency;
                fog->waves[i].phase = before.waves[i].phase;
            }
        } else if (auto* terms = std::get_if<Polynomials>(&b)) {
            const auto& before = std::get<Polynomials>(a);
            for (std::size_t i = 0; i < terms->terms.size(); ++i) {
                terms->terms[i].centre = before.terms[i].centre;
                terms->terms[i].extinction *= 3;
            }
        } else {
            continue;
        }
        const FogModel between = interpolate(a, b, 0.3);
        for (int i = 0; i < 200; ++i) {
            const Vector3d x = random_vector(random, 40);
            CHECK(extinction(between, x) ==
                  doctest::Approx(0.7 * extinction(a, x) + 0.3 * extinction(b, x)).epsilon(1e-12));
        }
    }
}

TEST_CASE("shapes: at a time, in the wind, at rest before and after") {
    using Kind = Potentials::Object::Kind;
    const auto ball = [](double x, double reach) {
        return Potentials{0, {{Kind::point, {x, 0, 0}, {0, 0, 0}, 0, 0.1, reach}}};
    };
    const ModelMotion motion(Wind(0, 2), {{1, ball(0, 2)}, {3, ball(8, 4)}});
    const auto at = [&](double seconds) {
        const auto models = models_at({ball(0, 2)}, {motion}, seconds);
        return std::get<Potentials>(models.front()).objects.front();
    };
    CHECK(at(-5).from == Vector3d(0, 0, -10));
    CHECK(at(2).from == Vector3d(4, 0, 4));
    CHECK(at(2).reach == 3);
    CHECK(at(2.5).from == Vector3d(6, 0, 5));
    CHECK(at(1e6).from == Vector3d(8, 0, 2e6));
    CHECK(at(1e6).reach == 4);
}

TEST_CASE("shapes: what cannot turn into one another is named") {
    Random random(407);
    const auto models = random_models(random);
    CHECK(contains(complaint(models[0], models[6]), "of another kind"));
    Halfspace plane{{0, 1, 0}, {0, 0, 0}, 1, 0}, turned = plane, other = plane;
    turned.normal = {1, 0, 0};
    other.fraction = Halfspace::Fraction::exp2;
    CHECK(contains(complaint(plane, turned), "normal differs"));
    CHECK(contains(complaint(plane, other), "fraction differs"));
    Cosines waves = random_cosines(random), fewer = waves;
    fewer.waves.pop_back();
    CHECK(contains(complaint(waves, fewer), "waves has"));
    Polynomials terms = random_polynomials(random, {0, 0, 0}), wider = terms;
    wider.terms[1].half_width *= 2;
    CHECK(contains(complaint(terms, wider), "polynomials[1]"));
    Potentials objects = random_potentials(random, {0, 0, 0}), back = objects;
    for (auto& object : back.objects)
        if (object.kind == Potentials::Object::Kind::line) std::swap(object.from, object.to);
    CHECK(contains(complaint(objects, back), "turns about"));
    Separable table{0.1, {}, Separable::Integral::exact}, longer = table;
    longer.axes[1] = {{1, 2}, 0, 1, false};
    CHECK(contains(complaint(table, longer), "y has another number"));
}

TEST_CASE("shapes: scene files, and mistakes that name the key") {
    const TempDir dir;
    const auto load = [&](const std::string& fog) {
        dir.write("scene.json",
                  R"({"camera": {"eye": [0, 2, 0], "target": [0, 2, -1]}, "fog": [)" + fog + "]}");
        return load_scene(dir / "scene.json");
    };
    const auto scene = load(R"({"model": "cosines", "wind": [1, 0], "channels": [1, 0.5, 0.5],
        "shapes": [
        {"time": -1, "extinction": 0.2, "waves": [{"extinction": 0.1, "direction": [1, 0, 0],
         "frequency": 1}]},
        {"time": 3, "extinction": 0.4, "waves": [{"extinction": 0.3, "direction": [1, 0, 0],
         "frequency": 1}]}]})");
    REQUIRE_MESSAGE(scene.has_value(), (scene ? "" : scene.error().message));
    REQUIRE(scene->models.size() == 1);
    // As it is at time 0, a quarter of the way.
    CHECK(std::get<Cosines>(scene->models[0]).extinction == doctest::Approx(0.25));
    CHECK(scene->models[0].channels == Channels{1, 0.5, 0.5});
    const auto later = models_at(scene->models, scene->model_motions, 1);
    CHECK(std::get<Cosines>(later[0]).waves[0].extinction == doctest::Approx(0.2));
    CHECK(std::get<Cosines>(later[0]).waves[0].phase == doctest::Approx(-1));
    CHECK(later[0].channels == Channels{1, 0.5, 0.5});

    const std::string layer = R"("profile": "exponential", "base": 0, "scale": 2)";
    for (const auto& [shapes, message] :
         {std::pair<std::string, std::string>{"[]", "fog[0].shapes: is empty"},
          {"3", "fog[0].shapes: "},
          {R"([{"extinction": 1, )" + layer + "}]", "fog[0].shapes[0].time: is missing"},
          {R"([{"time": 0, "extinction": -1, )" + layer + "}]",
           "fog[0].shapes[0]: extinction is -1"},
          {R"([{"time": 0, "extinction": 1, )" + layer + R"(}, {"time": 0, "extinction": 1, )" +
               layer + "}]",
           "fog[0].shapes[1]: time is 0, after 0"},
          {R"([{"time": 0, "extinction": 1, )" + layer +
               R"(}, {"time": 1, "profile": "ramp", "points": [[0, 1], [1, 0]]}])",
           "fog[0].shapes[1]: is of another kind"},
          {R"([{"time": 0, "wind": [1, 0], "extinction": 1, )" + layer + "}]",
           "fog[0].shapes[0]: \"wind\" stands beside \"shapes\""}}) {
        const auto result = load(R"({"model": "layers", "shapes": )" + shapes + "}");
        REQUIRE_FALSE(result.has_value());
        CHECK_MESSAGE(contains(result.error().message, message), result.error().message);
    }
    const auto alone = load(R"({"model": "layers", "time": 1, "extinction": 1, )" + layer + "}");
    REQUIRE_FALSE(alone.has_value());
    CHECK(contains(alone.error().message, "time belongs to the entries of \"shapes\""));
}
