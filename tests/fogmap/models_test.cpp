// Fogs given by formulas: closed forms against quadrature that knows only the extinction at points.
#include "wavefog/fogmap/models.h"

#include <doctest/doctest.h>

#include "fogmap/fog_support.h"
#include "fogmap/model_support.h"
#include "support/temp_dir.h"
#include "wavefog/fogmap/scene.h"

using namespace wavefog;
using namespace wavefog::test;
using Eigen::Vector3d;

namespace {

double quadrature(const FogModel& model, const Vector3d& o, const Vector3d& p) {
    const double metres = (p - o).norm();
    const AdaptiveSimpson along([&](double t) { return extinction(model, o + t * (p - o)); });
    return metres * along.integral(0, 1, 24, 1e-11 / std::max(metres, 1.0));
}

// Depth g of the halfspace paper's four-case tables: F.P and F.C are heights over the plane, V = C
// - P (constant density times distance, and the linear one).
double constant_by_cases(double fp, double fc, double fv, double length) {
    if (fp >= 0 && fc >= 0) return 0;
    if (fp < 0 && fc >= 0) return -fp / fv * length;
    if (fp >= 0) return (1 + fp / fv) * length;
    return length;
}
double linear_by_cases(double fp, double fc, double fv, double length) {
    if (fp >= 0 && fc >= 0) return 0;
    if (fp < 0 && fc >= 0) return 0.5 * length * fp * fp / fv;
    if (fp >= 0) return -0.5 * length * (fp + fc + fp * fp / fv);
    return -0.5 * length * (fp + fc);
}

std::string complaint(const FogModel& model) {
    const auto ok = validate(model);
    return ok ? "valid" : ok.error().message;
}

}  // namespace

TEST_CASE("models: closed forms equal adaptive quadrature") {
    Random random(6);
    double worst = 0;
    for (int round = 0; round < 6; ++round)
        for (const FogModel& model : random_models(random)) {
            REQUIRE(complaint(model) == "valid");
            for (const auto& [o, p] : model_segments(random, 40)) {
                const double exact = optical_depth(model, o, p);
                const double error = std::abs(exact - quadrature(model, o, p));
                worst = std::max(worst, error);
                CAPTURE(kind_name(model));
                CAPTURE(o.transpose());
                CAPTURE(p.transpose());
                REQUIRE(exact >= 0);
                REQUIRE_LE(error, 1e-9);
            }
        }
    MESSAGE("largest error ", worst);
}

TEST_CASE("models: halfspaces equal the four-case tables of the paper") {
    Random random(2);
    int cases[4] = {};
    for (int i = 0; i < 4000; ++i) {
        const Halfspace constant{random_direction(random), random_vector(random, 10), 0.04, 0};
        const Halfspace linear{constant.normal, constant.point, 0, 0.008};
        const Vector3d c = random_vector(random, 30), p = random_vector(random, 30), v = c - p;
        const double fp = constant.normal.dot(p - constant.point);
        const double fc = constant.normal.dot(c - constant.point);
        const double fv = constant.normal.dot(v), length = v.norm();
        ++cases[(fp < 0 ? 1 : 0) + (fc < 0 ? 2 : 0)];
        // The tables divide by F.V, which costs digits where it is small.
        const double tolerance = 1e-12 * (1 + length * length / std::abs(fv));
        CHECK_LE(
            std::abs(optical_depth(constant, c, p) - 0.04 * constant_by_cases(fp, fc, fv, length)),
            tolerance);
        CHECK_LE(
            std::abs(optical_depth(linear, c, p) - 0.008 * linear_by_cases(fp, fc, fv, length)),
            tolerance);
    }
    for (const int count : cases) CHECK(count > 400);
}

TEST_CASE("models: fog fractions of the true distance, by the paper's table 1") {
    Random random(12);
    int clear = 0, hidden = 0, between = 0;
    for (int round = 0; round < 20; ++round)
        for (const FogModel& model : random_fractions(random)) {
            REQUIRE(complaint(model) == "valid");
            const Halfspace& fog = std::get<Halfspace>(model);
            Halfspace plain = fog;
            plain.fraction = Halfspace::Fraction::exp;
            plain.start = 0;
            for (const auto& [o, p] : model_segments(random, 40)) {
                const double depth = quadrature(plain, o, p);  // rho d of the table
                double expected = std::exp(-depth * depth);
                if (fog.fraction == Halfspace::Fraction::linear) {
                    // rho (e - d), the fog's end e being 1 / rho behind its start.
                    expected = std::clamp(1 + fog.extinction * fog.start - depth, 0.0, 1.0);
                    ++(expected == 1 ? clear : expected == 0 ? hidden : between);
                }
                const double tau = optical_depth(model, o, p);
                CHECK(std::isfinite(tau));
                CHECK_LE(std::abs(std::exp(-tau) - expected), 1e-9);
                CHECK_LE(std::abs(tau - optical_depth(model, p, o)), 1e-11 * (1 + tau * 1e3));
            }
        }
    for (const int count : {clear, hidden, between}) CHECK(count > 200);
}

TEST_CASE("models: linear fog ends where OpenGL's does") {
    using enum Halfspace::Fraction;
    // GL_FOG_START = 10 m, GL_FOG_END = 60 m, all of space behind the plane.
    const Halfspace fog{{0, 1, 0}, {0, 1e4, 0}, 0.02, 0, linear, 10};
    const auto clarity = [&](double d) {
        return std::exp(-optical_depth(fog, {0, 0, 0}, {d, 0, 0}));
    };
    CHECK(clarity(0) == 1);
    CHECK(clarity(10) == 1);
    CHECK(clarity(35) == doctest::Approx(0.5).epsilon(1e-12));
    CHECK(clarity(60) < 1e-12);
    CHECK(clarity(61) < 1e-80);
    CHECK(clarity(1e9) < 1e-80);
}

TEST_CASE("models: F.V = 0, in the plane, beside it and far along it") {
    const Halfspace constant{{0, 1, 0}, {0, 3, 0}, 0.04, 0}, linear{{0, 1, 0}, {0, 3, 0}, 0, 0.01};
    CHECK(optical_depth(constant, {0, 2, 0}, {50, 2, 0}) == doctest::Approx(2));
    CHECK(optical_depth(constant, {0, 4, 0}, {50, 4, 0}) == 0);
    // In the plane k = 1 (eq. 4): the point counts as fogged. Linear fog is 0 there.
    CHECK(optical_depth(constant, {0, 3, 0}, {50, 3, 0}) == doctest::Approx(2));
    CHECK(optical_depth(linear, {0, 3, 0}, {50, 3, 0}) == 0);
    CHECK(optical_depth(linear, {0, 3, 0}, {0, 3, 0}) == 0);
    // Eq. 5 as printed subtracts 1 - (1 - 2e-6) here.
    const Vector3d up = Vector3d(0.6, 0.8, 0) * 1e6;
    CHECK(optical_depth(constant, {0, 1, 0}, Vector3d(0, 1, 0) + up) ==
          doctest::Approx(0.04 * 2 / 0.8).epsilon(1e-12));
    CHECK(optical_depth(linear, {0, 1, 0}, Vector3d(0, 1, 0) + up) ==
          doctest::Approx(0.01 * 2 / 0.8).epsilon(1e-12));
}

TEST_CASE("models: tau(a, b) = tau(b, a), parts add up, and so do models") {
    Random random(8);
    const auto models = random_models(random);
    for (const auto& [o, p] : model_segments(random, 200)) {
        double sum = 0;
        for (const FogModel& model : models) {
            const double whole = optical_depth(model, o, p);
            const Vector3d m = o + random.uniform() * (p - o);
            CAPTURE(kind_name(model));
            CHECK_LE(std::abs(whole - optical_depth(model, p, o)), 1e-11);
            CHECK_LE(std::abs(whole - optical_depth(model, o, m) - optical_depth(model, m, p)),
                     1e-11);
            sum += whole;
        }
        CHECK(optical_depth(models, o, p) == sum);
    }
}

TEST_CASE("models: waves and domains of thousands of periods") {
    Random random(9);
    // Over whole periods only the constant is left; a repeated domain has its mean.
    const Cosines waves{0.01, {{0.01, {2, 0, 0}, 3.14159265358979323846, 0.3}}};
    CHECK(optical_depth(waves, {0.2, 1, 1}, {5000.2, 1, 1}) == doctest::Approx(50).epsilon(1e-12));
    const Polynomials tiles{
        {{0.01, {0.8, -1, 0, 0, 0, 1}, {1, 0, 0}, {7, 0, 0}, 2, Polynomials::Outside::repeat}}};
    CHECK(optical_depth(tiles, {0.2, 1, 1}, {4000.2, 1, 1}) ==
          doctest::Approx(0.8 * 40).epsilon(1e-12));
    CHECK(optical_depth(tiles, {4000.2, 5, 1}, {0.2, 5, 1}) ==
          doctest::Approx(0.8 * 40).epsilon(1e-12));
}

TEST_CASE("models: every invalid parameter is named") {
    const double nan = std::nan("");
    const Vector3d origin(0, 0, 0);
    CHECK(contains(complaint(Halfspace{{0, 0, 0}, origin, 1, 0}), "normal is [0, 0, 0]"));
    CHECK(contains(complaint(Halfspace{{0, 2, 0}, origin, 1, 0}), "normal has length 2"));
    CHECK(contains(complaint(Halfspace{{0, 1, 0}, {nan, 0, 0}, 1, 0}), "point is [nan"));
    CHECK(contains(complaint(Halfspace{{0, 1, 0}, origin, -1, 0}), "extinction is -1"));
    CHECK(contains(complaint(Halfspace{{0, 1, 0}, origin, 0, -2}), "gradient is -2"));
    using enum Halfspace::Fraction;
    CHECK(contains(complaint(Halfspace{{0, 1, 0}, origin, 1, 0, linear, -3}), "start is -3"));
    CHECK(contains(complaint(Halfspace{{0, 1, 0}, origin, 1, 0, exp2, 3}),
                   "start is 3, which needs the fraction linear"));
    CHECK(contains(complaint(Halfspace{{0, 1, 0}, origin, 1, 1, linear, 3}),
                   "start is 3, which needs constant fog"));
    FogModel tinted = Halfspace{{0, 1, 0}, origin, 1, 0, exp2};
    tinted.channels = {1, 0.5, 0.25};
    CHECK(contains(complaint(tinted), "channels go with the fraction exp alone"));
    CHECK(contains(complaint(Ramp{{{0, 1}}}), "points has 1 entries"));
    CHECK(contains(complaint(Ramp{{{0, 1}, {0, 0}}}), "points[1]: y is 0, after 0"));
    CHECK(contains(complaint(Ramp{{{0, 1}, {1, -1}}}), "points[1]: extinction is -1"));
    CHECK(contains(complaint(ExponentialLayer{1, 0, 0}), "scale is 0"));
    CHECK(contains(complaint(ExponentialLayer{nan, 0, 1}), "extinction is nan"));
    CHECK(contains(complaint(Cosines{1, {}}), "waves is empty"));
    CHECK(contains(complaint(Cosines{1, {{1, {0, 0, 0}, 1, 0}}}), "waves[0].direction is [0"));
    CHECK(contains(complaint(Cosines{0.1, {{0.1, {1, 0, 0}, 1, 0}, {-0.1, {1, 0, 0}, 1, 0}}}),
                   "extinction is 0.1, but the waves take away up to 0.2"));
    CHECK(complaint(Cosines{0.2, {{0.1, {1, 0, 0}, 1, 0}, {-0.1, {1, 0, 0}, 1, 0}}}) == "valid");

    const auto polynomial = [&](const std::vector<double>& c, Polynomials::Outside outside) {
        return complaint(Polynomials{{{1, c, {1, 0, 0}, origin, 5, outside}}});
    };
    using enum Polynomials::Outside;
    CHECK(complaint(Polynomials{}) == "polynomials is empty; give at least one");
    CHECK(polynomial({0.8, -1, 0, 0, 0, 1}, repeat) == "valid");
    CHECK(polynomial({0.5, -1, 0, 0, 0, 1}, repeat).find("negative at u = 0.") !=
          std::string::npos);                                // its least value is 0.5 - 0.535
    CHECK(polynomial({1, 0, -2, 0, 1}, repeat) == "valid");  // touches 0 at both borders
    CHECK(polynomial({0, 0, 1}, zero) == "valid");           // touches 0 inside
    CHECK(contains(polynomial({-1e-3, 0, 1}, zero), "negative at u ="));
    CHECK(contains(polynomial({2, 1}, repeat), "give 1 at u = -1 and 3 at u = 1"));
    CHECK(polynomial({2, 1}, zero) == "valid");
    CHECK(contains(polynomial({}, zero), "polynomials[0].coefficients is empty"));
    CHECK(contains(polynomial(std::vector<double>(11, 1.0), zero), "has 11 entries"));
    CHECK(contains(polynomial({nan}, zero), "coefficients is nan"));
    CHECK(contains(complaint(Polynomials{{{1, {1}, {1, 0, 0}, origin, 0, zero}}}),
                   "half_width is 0"));

    using Kind = Potentials::Object::Kind;
    const auto object = [](const Potentials::Object& o) { return complaint(Potentials{0, {o}}); };
    CHECK(complaint(Potentials{1, {}}) == "objects is empty; give at least one");
    CHECK(contains(object({Kind::sphere, origin, origin, 0, 1, 1}), "objects[0].radius is 0"));
    CHECK(contains(object({Kind::point, origin, origin, 0, 1, 0}), "objects[0].reach is 0"));
    CHECK(contains(object({Kind::point, {0, nan, 0}, origin, 0, 1, 1}),
                   "objects[0].point is [0, nan"));
    CHECK(
        contains(object({Kind::line, origin, origin, 0, 1, 1}), "objects[0].line begins and ends"));
    CHECK(contains(object({Kind::point, origin, origin, 0, -1, 1}), "take away up to 1"));
    CHECK(complaint(Potentials{1, {{Kind::point, origin, origin, 0, -1, 1}}}) == "valid");
}

TEST_CASE("models: scene files hold them beside maps, and mistakes name the key") {
    const TempDir dir;
    const auto load = [&](const std::string& fogs) {
        write_bytes(
            dir / "scene.json",
            R"({"camera": {"eye": [0, 2, 0], "target": [0, 2, -1]}, "fog": [)" + fogs + "]}");
        return load_scene(dir / "scene.json");
    };
    const auto scene = load(R"(
        {"model": "halfspace", "normal": [0, 3, 0], "point": [0, 2, 0], "gradient": 0.01,
         "wind": [[0, 1, 2], [3, 4, 5]]},
        {"model": "layers", "profile": "ramp", "points": [[0, 0.1], [5, 0]]},
        {"model": "layers", "profile": "exponential", "extinction": 0.1, "base": 1, "scale": 4},
        {"model": "layers", "profile": "depth", "surface": 7, "gradient": 0.02},
        {"model": "cosines", "extinction": 0.3,
         "waves": [{"extinction": 0.2, "direction": [0.1, 1, 0], "frequency": 2, "phase": 1}]},
        {"model": "polynomials", "polynomials": [{"extinction": 0.1, "half_width": 5,
         "coefficients": [0.8, -1, 0, 0, 0, 1], "direction": [2, 0, 0], "outside": "repeat"}]},
        {"model": "potentials", "extinction": 0.01, "objects": [
         {"point": [1, 2, 3], "extinction": 0.1, "reach": 4},
         {"line": [[1, 2, 3], [4, 5, 6]], "extinction": -0.01, "reach": 4},
         {"sphere": [1, 2, 3], "radius": 2, "extinction": 0.1, "reach": 4}]})");
    REQUIRE_MESSAGE(scene.has_value(), (scene ? "" : scene.error().message));
    REQUIRE(scene->models.size() == 7);
    REQUIRE(scene->model_motions.size() == 7);
    CHECK(scene->model_motions[0].wind.velocity(3) == Eigen::Vector2d(4, 5));
    CHECK(scene->model_motions[1].wind.calm());
    CHECK(scene->fogs.empty());
    CHECK(std::get<Halfspace>(scene->models[0]).normal == Vector3d(0, 1, 0));
    CHECK(std::get<Halfspace>(scene->models[0]).gradient == 0.01);
    CHECK(std::get<Ramp>(scene->models[1]).points[1].y == 5);
    CHECK(std::get<ExponentialLayer>(scene->models[2]).scale == 4);
    CHECK(extinction(scene->models[3], {100, 4, 9}) == doctest::Approx(0.06));
    CHECK(std::get<Cosines>(scene->models[4]).waves[0].phase == 1);
    CHECK(std::get<Polynomials>(scene->models[5]).terms[0].direction == Vector3d(1, 0, 0));
    CHECK(std::get<Potentials>(scene->models[6]).objects[2].radius == 2);

    for (
        const auto& [fog, message] : {
            std::pair{R"({"model": "smoke"})", "fog[0].model: is \"smoke\"; it must be one of"},
            {R"({"model": "halfspace", "point": [0, 0, 0], "extinction": 1})",
             "fog[0].normal: is missing"},
            {R"({"model": "halfspace", "normal": [0, 0, 0], "point": [0, 0, 0], "extinction": 1})",
             "fog[0]: normal is [0, 0, 0]"},
            {R"({"model": "halfspace", "normal": [0, 1, 0], "point": [0, 0, 0]})",
             "fog[0]: needs \"extinction\""},
            {R"({"model": "halfspace", "normal": [0, 1, 0], "point": [0, 0, 0], "extinction": 1,
                 "fraction": "exp3"})",
             "fog[0].fraction: is \"exp3\"; it must be one of"},
            {R"({"model": "particles", "position": [0, 0, 0], "rate": 9, "radius": [1, 1]})",
             "fog[0].source: is missing"},
            {R"({"model": "particles", "source": "fog", "position": [0, 0, 0], "rate": 9,
                 "radius": [1, 0]})",
             "fog[0]: radius[1] is 0; it must be above 0 (m)"},
            {R"({"model": "particles", "source": "smoke", "position": [0, 0, 0], "rate": 9,
                 "radius": [1, 1], "direction": [0, 0, 0]})",
             "fog[0]: direction is 0"},
            {R"({"model": "cosines", "extinction": 1, "waves": [{"extinction": 1, "direction": [1, 0, 0], "frequency": 1}], "wind": 3})",
             "fog[0].wind: "},
            {R"({"model": "halfspace", "normal": [0, 1, 0], "point": [0, 0, 0], "extinction": -1})",
             "fog[0]: extinction is -1"},
            {R"({"model": "layers", "profile": "ramp", "points": []})", "fog[0]: points has 0"},
            {R"({"model": "layers", "profile": "depth", "surface": 1e400, "gradient": 1})",
             "1e400 is too large a number"},
            {R"({"model": "layers", "profile": "slope"})", "fog[0].profile: is \"slope\""},
            {R"({"model": "layers", "profile": "depth", "surface": 0, "gradient": 1, "base": 2})",
             "fog[0].base: unknown key"},
            {R"({"model": "cosines", "extinction": 1, "waves": []})", "fog[0]: waves is empty"},
            {R"({"model": "polynomials", "polynomials": [{"outside": "wrap"}]})",
             "fog[0].polynomials[0].extinction: is missing"},
            {R"({"model": "potentials", "objects": [{"extinction": 1, "reach": 1}]})",
             "fog[0].objects[0]: needs one of"},
            {R"({"model": "potentials", "objects": [{"sphere": [0, 0, 0], "radius": 0,
                  "extinction": 1, "reach": 1}]})",
             "fog[0]: objects[0].radius is 0"},
        }) {
        const auto result = load(fog);
        REQUIRE_FALSE(result.has_value());
        CHECK(contains(result.error().message, "scene.json: "));
        CHECK_MESSAGE(contains(result.error().message, message), result.error().message);
    }
}
