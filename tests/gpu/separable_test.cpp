// The shader's products of tabulated functions, compiled as C++, against their twin in double.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "fogmap/model_support.h"
#include "wavefog/gpu/fog_pass.h"

using namespace wavefog;
using namespace wavefog::test;
using Eigen::Vector3d;

namespace {

// As in models_test.cpp.
constexpr double kMaxError = 2e-6;

double largest_error(const FogModel& model, const std::vector<Segment3>& segments) {
    const auto shader = ModelsOnCpu::create({model});
    REQUIRE_MESSAGE(shader.has_value(), (shader ? "" : shader.error().message));
    double worst = 0;
    for (const auto& [o, p] : segments) {
        const double tau = shader->optical_depth(o, p);
        REQUIRE(std::isfinite(tau));
        worst = std::max(worst, std::abs(std::exp(-tau) - std::exp(-optical_depth(model, o, p))));
    }
    return worst;
}

/// model_segments(), and level and nearly level rays as long as the sky's.
std::vector<Segment3> rays(Random& random, double far, const Vector3d& offset = {0, 0, 0}) {
    auto segments = model_segments(random, 400, offset);
    for (int i = 0; i < 200; ++i) {
        const Vector3d o = offset + random_vector(random, 20);
        Vector3d along = random_direction(random);
        along.y() *= i % 3 == 0 ? 0 : i % 3 == 1 ? 1e-5 : 1;
        segments.emplace_back(o, o + far * along);
    }
    return segments;
}

Separable with(Separable fog, Separable::Integral integral) {
    fog.integral = integral;
    return fog;
}

}  // namespace

TEST_CASE("separable: the shader equals the twin in double, both integrals") {
    Random random(211);
    for (const Vector3d& offset : {Vector3d(0, 0, 0), Vector3d(1e6, 0, -1e6)})
        for (const bool repeat : {false, true})
            for (const auto integral :
                 {Separable::Integral::exact, Separable::Integral::published}) {
                const FogModel fog = with(random_separable(random, offset, repeat), integral);
                const double error = largest_error(fog, rays(random, 4000, offset));
                MESSAGE("repeat ", repeat, ", published ",
                        integral == Separable::Integral::published, ": largest |dT| ", error);
                CHECK_LE(error, kMaxError);
            }
}

TEST_CASE("separable: a table of height keeps its digits at any size and on nearly level rays") {
    Random random(223);
    for (const int values : {2, 3, 40, 1000, 4096})
        for (const double metres : {0.5, 40.0, 3000.0}) {
            const FogModel fog = Separable{
                0.02,
                {AxisTable{}, random_table(random, values, -metres / 2, metres / 2), AxisTable{}},
                Separable::Integral::exact};
            auto segments = rays(random, 1e6);
            // Across the borders of cells by less and less.
            for (int i = 0; i < 400; ++i) {
                const double y =
                    metres * (std::floor(random.uniform(0, values)) / (values - 1) - 0.5);
                const double rise = std::pow(10, random.uniform(-8, 1));
                segments.emplace_back(Vector3d(0, y - rise / 3, 0), Vector3d(300, y + rise, 40));
            }
            const double error = largest_error(fog, segments);
            CAPTURE(values);
            CAPTURE(metres);
            MESSAGE(values, " values over ", metres, " m: largest |dT| ", error);
            CHECK_LE(error, kMaxError);
        }
}

TEST_CASE("separable: rays along the borders of cells, through their corners, of no length") {
    const AxisTable saw{{0, 2, 0, 2, 0}, 0, 4, true};
    const FogModel fog =
        Separable{0.2, {saw, AxisTable{{1, 0}, 0, 4}, saw}, Separable::Integral::exact};
    std::vector<Segment3> segments;
    for (const double y : {0.0, 1.0, 4.0, 5.0})
        for (const double x : {-7.0, 0.0, 1.0, 2.5}) {
            segments.push_back({{x, y, 0}, {x, y, 50}});
            segments.push_back({{x, y, x}, {x + 9, y, x + 9}});
            segments.push_back({{x, y, x}, {x - 9, y - 9, x - 9}});
            segments.push_back({{x, y, 0}, {x, y, 0}});
            segments.push_back({{x, y, 0}, {x, y + 3, 0}});
        }
    CHECK_LE(largest_error(fog, segments), kMaxError);
}
