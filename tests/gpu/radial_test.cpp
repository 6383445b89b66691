// Method radial on the CPU: the shader's own text, against the reference in double.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "fogmap/fog_support.h"
#include "wavefog/fogmap/reference.h"
#include "wavefog/gpu/fog_pass.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

ShaderOnCpu radial_of(const Fog& fog) {
    auto made = ShaderOnCpu::create(fog, {.kind = MethodKind::radial, .radial = {1536, 512}});
    REQUIRE_MESSAGE(made.has_value(), (made ? "" : made.error().message));
    return std::move(*made);
}

double transmittance_error(double tau, double truth) {
    return std::abs(std::exp(-tau) - std::exp(-truth));
}

}  // namespace

TEST_CASE("radial on the CPU: rays in all directions within 1/510 of the reference") {
    Random random(89);
    for (const Boundary boundary : {Boundary::zero, Boundary::repeat})
        for (int degree = 1; degree <= 2; ++degree) {
            Fog fog =
                random_fog(24, 18, {.degree = degree, .levels = 1, .boundary = boundary}, random);
            for (const auto& profile : all_profiles()) {
                fog.profile = profile;
                const Reference reference(fog);
                const ShaderOnCpu shader = radial_of(fog);
                for (int eye = 0; eye < 2; ++eye) {
                    const Eigen::Vector3d o = random_point(random);
                    for (int i = 0; i < 100; ++i) {
                        const Eigen::Vector3d p = random_point(random);
                        CAPTURE(o.transpose());
                        CAPTURE(p.transpose());
                        CAPTURE(degree);
                        CAPTURE(static_cast<int>(profile.kind));
                        CHECK_LE(transmittance_error(shader.optical_depth(o, p),
                                                     reference.optical_depth(o, p)),
                                 1.0 / 510);
                    }
                }
            }
        }
}

TEST_CASE("radial on the CPU: with the exact last step 24 rows leave the azimuths' error alone") {
    Random random(91);
    double plain_worst = 0, worst = 0;
    for (const Boundary boundary : {Boundary::zero, Boundary::repeat})
        for (int degree = 1; degree <= 2; ++degree) {
            Fog fog =
                random_fog(24, 18, {.degree = degree, .levels = 1, .boundary = boundary}, random);
            for (const auto& profile : all_profiles()) {
                fog.profile = profile;
                const Reference reference(fog);
                // 8192 azimuths a turn: what is left of their error is below 5e-4 (measured 1e-4),
                // and the parabolas' of the exponential profile.
                const bool exponential = profile.kind == Profile::Kind::exponential;
                const double limit = exponential ? 1.0 / 510 : 5e-4;
                Method few{.kind = MethodKind::radial, .radial = {8192, 24}};
                const auto plain = ShaderOnCpu::create(fog, few);
                few.radial_step = true;
                const auto step = ShaderOnCpu::create(fog, few);
                REQUIRE(plain.has_value());
                REQUIRE(step.has_value());
                const Eigen::Vector3d o = random_point(random);
                for (int i = 0; i < 200; ++i) {
                    const Eigen::Vector3d p = random_point(random);
                    const double truth = reference.optical_depth(o, p);
                    const double error = transmittance_error(step->optical_depth(o, p), truth);
                    CAPTURE(o.transpose());
                    CAPTURE(p.transpose());
                    CAPTURE(degree);
                    CAPTURE(static_cast<int>(profile.kind));
                    CHECK_LE(error, limit);
                    if (!exponential) worst = std::max(worst, error);
                    plain_worst = std::max(plain_worst,
                                           transmittance_error(plain->optical_depth(o, p), truth));
                }
            }
        }
    MESSAGE("rows interpolated: " << plain_worst << ", walked: " << worst);
    CHECK(plain_worst > 10 * worst);
}

TEST_CASE("radial on the CPU: r -> 0 is finite and continuous, also on cell edges and outside") {
    Random random(97);
    for (int degree = 0; degree <= 2; ++degree) {
        Fog fog = random_fog(48, 36, {.degree = degree, .levels = 2}, random);
        for (const auto& profile : all_profiles()) {
            fog.profile = profile;
            const Reference reference(fog);
            const ShaderOnCpu shader = radial_of(fog);
            for (const Eigen::Vector3d& o :
                 {Eigen::Vector3d(3.3, 8.1, 5.2), Eigen::Vector3d(-2, -3.2, -4),
                  Eigen::Vector3d(28, 8.1, 24), Eigen::Vector3d(90, 8.1, 5)})
                for (const double r : {0.0, 1e-30, 1e-9, 1e-4, 1e-2})
                    for (const double rise : {-14.0, 0.0, 12.5}) {
                        // Towards the map's middle, so that no edge of a Haar cell lies in between.
                        const Eigen::Vector3d p = o + Eigen::Vector3d(-r, rise, -0.5 * r);
                        const double tau = shader.optical_depth(o, p);
                        CAPTURE(degree);
                        CAPTURE(static_cast<int>(profile.kind));
                        CAPTURE(o.transpose());
                        CAPTURE(r);
                        CAPTURE(rise);
                        REQUIRE(std::isfinite(tau));
                        // Straight down an edge, either side's density will do.
                        if (degree == 0 && p.x() == o.x()) continue;
                        // The exponential profile's spline is within 0.3 % and ends at 7 heights.
                        CHECK_LE(transmittance_error(tau, reference.optical_depth(o, p)),
                                 1.0 / 510);
                    }
        }
    }
}

TEST_CASE("radial on the CPU: a constant map has the exponential profile's error alone") {
    Random random(101);
    Fog fog =
        fog_of(make_map<float>(MapKind::constant, 16, 16, random), {.degree = 0, .levels = 1});
    fog.rect = {-200, -200, 200, 200};
    fog.extinction = 0.05;
    fog.profile = {.kind = Profile::Kind::exponential, .base = 1, .scale = 4};
    const Reference reference(fog);
    const ShaderOnCpu shader = radial_of(fog);
    for (const double height : {-3.0, 2.0, 30.0, 90.0, 600.0}) {
        const Eigen::Vector3d o(3.3, height, 5.2);
        for (int i = 0; i < 300; ++i) {
            const Eigen::Vector3d p(random.uniform(-190, 190), random.uniform(-10, 60),
                                    random.uniform(-190, 190));
            const double truth = reference.optical_depth(o, p);
            CAPTURE(height);
            CAPTURE(p.transpose());
            // 5e-5 of what lies more than 10 scale heights up, and float32. From 600 m, 150 scale
            // heights, a row is 3 of them and 115 rows from the eye: its centre of mass is noisy.
            const double relative = height < 600 ? 1e-3 : 1e-2;
            CHECK_LE(std::abs(shader.optical_depth(o, p) - truth), relative * truth + 2e-5);
        }
    }
}

TEST_CASE("radial on the CPU: a step that begins on a line between cells goes on behind it") {
    // Of a constant map azimuths know all; far from the eye float32 has rows on such lines often.
    Fog fog = fog_of(Grid<float>::Ones(1024, 1024), {.degree = 1, .levels = 1});
    fog.rect = {-4200, -4200, 4200, 4200};
    fog.extinction = 0.05;
    fog.profile = {.kind = Profile::Kind::exponential, .base = 0, .scale = 17};
    const Reference reference(fog);
    auto shader = ShaderOnCpu::create(fog, {.kind = MethodKind::radial, .radial_step = true});
    REQUIRE(shader.has_value());
    Random random(239);
    const Eigen::Vector3d eye(-2900, 2644, 1720);
    double worst = 0;
    for (int i = 0; i < 50000; ++i) {
        const Eigen::Vector3d p(random.uniform(-2900, 2900), random.uniform(-50, 50),
                                random.uniform(-2900, 2900));
        worst = std::max(worst, transmittance_error(shader->optical_depth(eye, p),
                                                    reference.optical_depth(eye, p)));
    }
    // Rounding of far moments leaves up to 7e-4; a walk that ends early loses tenths.
    CHECK_LE(worst, 1e-3);
}

TEST_CASE("radial on the CPU: the last eye's table is kept, another eye's is its own") {
    Random random(103);
    const Fog fog = random_fog(24, 18, {.degree = 1, .levels = 1}, random);
    const ShaderOnCpu shader = radial_of(fog);
    const Eigen::Vector3d a(3.3, 2.1, 5.2), b(-7.1, 1, 2), p(12, 3, -4);
    const double from_a = shader.optical_depth(a, p), from_b = shader.optical_depth(b, p);
    CHECK(from_a != from_b);
    CHECK(radial_of(fog).optical_depth(b, p) == from_b);
    CHECK(shader.optical_depth(a, p) == from_a);
    CHECK(shader.optical_depth(b, p) == from_b);
    CHECK(shader.optical_depth(a, a) == 0);
}
