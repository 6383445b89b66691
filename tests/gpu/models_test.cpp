// The shader's formulas for fog, compiled as C++, against their twin in double.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "fogmap/model_support.h"
#include "wavefog/gpu/fog_pass.h"

using namespace wavefog;
using namespace wavefog::test;
using Eigen::Vector3d;

namespace {

// float32 rounds positions within 100 m of the eye to 4e-6 m and a handful of operations to 1e-6 of
// tau; exp(-tau) loses at most 0.37 of that.
constexpr double kMaxError = 2e-6;

ModelsOnCpu shader_of(const std::vector<FogModel>& models) {
    auto shader = ModelsOnCpu::create(models);
    REQUIRE_MESSAGE(shader.has_value(), (shader ? "" : shader.error().message));
    return *shader;
}

double error(const ModelsOnCpu& shader, const FogModel& model, const Segment3& s) {
    const double tau = shader.optical_depth(s.first, s.second);
    REQUIRE(std::isfinite(tau));
    REQUIRE(tau >= 0);
    return std::abs(std::exp(-tau) - std::exp(-optical_depth(model, s.first, s.second)));
}

void check_models(const std::vector<FogModel>& models, const std::vector<Segment3>& segments) {
    for (const FogModel& model : models) {
        const ModelsOnCpu shader = shader_of({model});
        double worst = 0;
        for (const Segment3& s : segments) {
            const double e = error(shader, model, s);
            CAPTURE(kind_name(model));
            CAPTURE(s.first.transpose());
            CAPTURE(s.second.transpose());
            CHECK_LE(e, kMaxError);
            worst = std::max(worst, e);
        }
        MESSAGE(kind_name(model), ": largest |dT| ", worst);
    }
}

}  // namespace

TEST_CASE("models: random, level, vertical, short and grazing rays") {
    Random random(101);
    for (int round = 0; round < 4; ++round)
        check_models(all_models(random), model_segments(random, 1000));
}

TEST_CASE("models: 1e6 m from the origin") {
    Random random(103);
    const Vector3d offset(1e6, 0, -1e6);
    check_models(all_models(random, offset), model_segments(random, 1000, offset));
}

TEST_CASE("models: in the plane, along borders, of no length") {
    const std::vector<FogModel> models = {
        Halfspace{{0, 1, 0}, {0, 3, 0}, 0.02, 0},
        Halfspace{{0, 1, 0}, {0, 3, 0}, 0, 0.01},
        Ramp{{{0, 0}, {3, 0.02}, {5, 0.02}, {9, 0}}},
        Halfspace{{0, 1, 0}, {0, 3, 0}, 0.02, 0, Halfspace::Fraction::linear, 5},
        Halfspace{{0, 1, 0}, {0, 3, 0}, 0.02, 0, Halfspace::Fraction::exp2},
        ExponentialLayer{0.02, 3, 2},
        Cosines{0.02, {{0.02, {0, 1, 0}, 0.7, 0}}},
        Polynomials{
            {{0.02, {0.8, -1, 0, 0, 0, 1}, {0, 1, 0}, {0, 0, 0}, 3, Polynomials::Outside::repeat}}},
        Potentials{0, {{Potentials::Object::Kind::sphere, {0, 0, 0}, {0, 0, 0}, 3, 0.02, 4}}},
        Potentials{0, {{Potentials::Object::Kind::line, {0, 3, 0}, {9, 3, 0}, 0, 0.02, 4}}}};
    std::vector<Segment3> segments;
    for (const double y : {-3.0, 0.0, 3.0, 5.0, 9.0}) {
        segments.push_back({{-20, y, 0}, {30, y, 0}});  // through the sphere's top and the line
        segments.push_back({{30, y, -7}, {-20, y, 40}});
        segments.push_back({{0, y, 0}, {0, y + 3, 0}});
        segments.push_back({{0, y, 0}, {0, y, 0}});
        segments.push_back({{-20, y, 3}, {30, y + 1e-30, 3}});
    }
    check_models(models, segments);
}

TEST_CASE("models: rays as long as the sky's") {
    Random random(107);
    const auto models = all_models(random);
    std::vector<Segment3> segments;
    for (int i = 0; i < 500; ++i) {
        const Vector3d o = random_vector(random, 20);
        segments.emplace_back(o, o + (i % 2 ? 1e6 : 4e3) * random_direction(random));
    }
    check_models(models, segments);
}

TEST_CASE("models: thin fog keeps its digits") {
    Random random(109);
    for (FogModel& model : random_models(random)) {
        // tau near 1e-6, where |dT| would not show an error: relative to the largest.
        const auto segments = model_segments(random, 200);
        const ModelsOnCpu shader = shader_of({model});
        for (const auto& [o, p] : segments) {
            const Vector3d near = o + (p - o) * 1e-5;
            const double truth = optical_depth(model, o, near);
            CAPTURE(kind_name(model));
            CHECK_LE(std::abs(shader.optical_depth(o, near) - truth),
                     5e-6 * (near - o).norm() * 0.1 + 1e-12);
        }
    }
}

TEST_CASE("models: their sum is the sum of their optical depths") {
    Random random(113);
    const auto models = random_models(random);
    const ModelsOnCpu all = shader_of(models);
    for (const auto& [o, p] : model_segments(random, 500))
        CHECK_LE(
            std::abs(std::exp(-all.optical_depth(o, p)) - std::exp(-optical_depth(models, o, p))),
            kMaxError);
    CHECK(shader_of({}).optical_depth({0, 0, 0}, {1, 2, 3}) == 0);
}

TEST_CASE("models: what is invalid or too much is refused with its name") {
    const auto invalid = ModelsOnCpu::create({Halfspace{{0, 0, 0}, {0, 0, 0}, 1, 0}});
    REQUIRE_FALSE(invalid.has_value());
    CHECK(invalid.error().message.find("normal is [0, 0, 0]") != std::string::npos);
    const Halfspace one{{0, 1, 0}, {0, 0, 0}, 1, 0};
    CHECK(ModelsOnCpu::create(std::vector<FogModel>(8, one)).has_value());
    const auto many = ModelsOnCpu::create(std::vector<FogModel>(9, one));
    REQUIRE_FALSE(many.has_value());
    CHECK(many.error().message.find("9 halfspaces and depth layers, the shader holds 8") !=
          std::string::npos);
}
