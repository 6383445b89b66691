// Methods paper and paper-scaling (paper 004, algorithm 1 and section 4.4), compiled as C++,
// against the reference and against exact: the three are one function where nothing is clamped.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "fogmap/fog_support.h"
#include "wavefog/fogmap/reference.h"
#include "wavefog/gpu/fog_pass.h"
#include "wavefog/wavelet/path_table.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

// float32: levels cancel where details undo the approximation, so the sum of their magnitudes, up
// to 2.7 times the density (stability.md, row 14), rounds instead of the density.
constexpr double kRounding = 5e-6;

struct Ray {
    Eigen::Vector3d o, p;
};

std::vector<Ray> rays(Random& random, int count) {
    std::vector<Ray> result;
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector3d o = random_point(random), p = random_point(random);
        result.push_back({o, p});
    }
    // Along grid lines, through vertices, inside one cell, vertical, of no length.
    result.push_back({{-19.5, 1, -11.5}, {28, 1, -11.5}});
    result.push_back({{-20, 1, -12}, {16, 1, 24}});
    result.push_back({{3.2, 0, 4.1}, {3.3, 1, 4.3}});
    result.push_back({{3.2, 0, 4.1}, {3.2, 5, 4.1}});
    result.push_back({{3.2, 0, 4.1}, {3.2, 0, 4.1}});
    return result;
}

Fog fog_for(int degree, const char* family, Form form, Boundary boundary, int levels,
            Random& random) {
    FogOptions options;
    options.degree = degree;
    options.family = family;
    options.form = form;
    options.boundary = boundary;
    options.levels = levels;
    return random_fog(48, 32, options, random);
}

ShaderOnCpu shader_of(const Fog& fog, const Method& method) {
    auto shader = ShaderOnCpu::create(fog, method);
    REQUIRE_MESSAGE(shader.has_value(), (shader ? "" : shader.error().message));
    return std::move(*shader);
}

/// Largest |dT| of a method; the reference does not clamp, as the paper does not.
double largest_error(const Fog& fog, const Method& method, const std::vector<Ray>& all) {
    const ShaderOnCpu shader = shader_of(fog, method);
    const Reference reference(fog);
    double largest = 0;
    for (const auto& ray : all) {
        const double tau = shader.optical_depth(ray.o, ray.p);
        REQUIRE(std::isfinite(tau));
        const double truth = std::max(0.0, reference.optical_depth(ray.o, ray.p, method.mu, false));
        largest = std::max(largest, std::abs(std::exp(-tau) - std::exp(-truth)));
    }
    return largest;
}

}  // namespace

TEST_CASE("paper: mean-density tables of degree 0 and 1 are exact in both forms at every mu") {
    Random random(61);
    const auto all = rays(random, 150);
    struct Case {
        int degree;
        const char* family;
    };
    for (const auto& [degree, family] :
         {Case{0, "1,1"}, Case{0, "1,3"}, Case{1, "2,2"}, Case{1, "2,4"}})
        for (const Boundary boundary : {Boundary::zero, Boundary::repeat})
            for (const int levels : {0, 1, 3}) {
                const Fog fog = fog_for(degree, family, Form::wavelet, boundary, levels, random);
                for (const double mu : {1.0, 0.6, 0.0})
                    for (const MethodKind kind : {MethodKind::paper, MethodKind::paper_scaling}) {
                        CAPTURE(std::string(family));
                        CAPTURE(levels);
                        CAPTURE(mu);
                        CAPTURE(static_cast<int>(kind));
                        CAPTURE(static_cast<int>(boundary));
                        CHECK_LE(largest_error(fog, {.kind = kind, .mu = mu}, all), kRounding);
                    }
            }
}

TEST_CASE("paper: quadratic tables miss by no more than their own measured error") {
    Random random(67);
    const auto all = rays(random, 60);
    for (const char* family : {"3,3", "3,5", "3,1"}) {
        const Fog fog = fog_for(2, family, Form::wavelet, Boundary::zero, 2, random);
        for (const MethodKind kind : {MethodKind::paper, MethodKind::paper_scaling}) {
            double before = 1;
            for (const int samples : {4, 16, 64}) {
                CAPTURE(std::string(family));
                CAPTURE(static_cast<int>(kind));
                CAPTURE(samples);
                const double error = largest_error(fog, {.kind = kind, .table = samples}, all);
                // One chord's mean is off by at most 1.7 / (8 (N - 1)^2) of the function's
                // curvature; sums of cells along a ray mostly cancel: 0.2 / (N - 1)^2 holds for
                // all.
                CHECK_LE(error, 0.2 / ((samples - 1) * (samples - 1)) + kRounding);
                CHECK_LT(error, before);
                before = error;
            }
        }
    }
}

TEST_CASE("paper: the perimeter layout errs by O(1/N)") {
    Random random(71);
    const auto all = rays(random, 60);
    for (const int degree : {0, 1, 2}) {
        const Fog fog = fog_for(degree, "", Form::wavelet, Boundary::zero, 1, random);
        double before = 1;
        for (const int samples : {4, 16}) {
            CAPTURE(degree);
            CAPTURE(samples);
            const double error = largest_error(
                fog, {.kind = MethodKind::paper, .table = samples, .layout = PathLayout::perimeter},
                all);
            // stability.md 7: up to 0.25 / N of a cell a chord, with half-texel samples; extinction
            // 0.05 / m and cells of about 1 m on some 60 steps.
            CHECK_LE(error, 0.4 / samples);
            CHECK_LT(error, before);
            before = error;
        }
    }
}

TEST_CASE("paper: agrees with exact at every mu where nothing is clamped") {
    Random random(73);
    const auto all = rays(random, 150);
    for (const int degree : {0, 1}) {
        // Residuals of a positive family keep every partial sum non-negative.
        const Fog fog = fog_for(degree, "positive", Form::scaling, Boundary::zero, 3, random);
        for (const double mu : {1.0, 0.8, 0.4, 0.0}) {
            const ShaderOnCpu exact = shader_of(fog, {.mu = mu});
            const ShaderOnCpu scaling =
                shader_of(fog, {.kind = MethodKind::paper_scaling, .mu = mu});
            for (const auto& ray : all)
                REQUIRE(std::abs(std::exp(-exact.optical_depth(ray.o, ray.p)) -
                                 std::exp(-scaling.optical_depth(ray.o, ray.p))) <= kRounding);
        }
    }
}

TEST_CASE("paper: a slab is exact, a profile that varies is fogged by its mean over each step") {
    Random random(79);
    Fog fog = fog_for(1, "2,2", Form::wavelet, Boundary::zero, 2, random);
    const auto all = rays(random, 150);
    for (const auto& profile : all_profiles()) {
        fog.profile = profile;
        const bool exact =
            profile.kind == Profile::Kind::uniform || profile.kind == Profile::Kind::slab;
        for (const MethodKind kind : {MethodKind::paper, MethodKind::paper_scaling}) {
            CAPTURE(static_cast<int>(profile.kind));
            // Density and height vary together inside a step of the coarsest level (4 m): measured
            // 4e-2.
            CHECK_LE(largest_error(fog, {.kind = kind}, all), exact ? kRounding : 0.08);
        }
    }
}

TEST_CASE("paper: errors say what to do") {
    Random random(83);
    const Fog scaling = fog_for(1, "2,2", Form::scaling, Boundary::zero, 2, random);
    auto shader = ShaderOnCpu::create(scaling, {.kind = MethodKind::paper});
    REQUIRE(!shader.has_value());
    CHECK(shader.error().kind == ErrorKind::usage);
    CHECK(shader.error().message.find("--form wavelet") != std::string::npos);
    const Fog interval = fog_for(1, "chui-wang", Form::wavelet, Boundary::zero, 2, random);
    shader = ShaderOnCpu::create(interval, {.kind = MethodKind::paper});
    REQUIRE(!shader.has_value());
    CHECK(shader.error().message.find("paper-scaling") != std::string::npos);
    CHECK(ShaderOnCpu::create(interval, {.kind = MethodKind::paper_scaling}).has_value());
    CHECK(!make_path_table(parse_family("2,2", 1).value(), 1, PathLayout::mean, true).has_value());
    CHECK(!make_path_table(parse_family("3,7", 2).value(), 128, PathLayout::perimeter, true)
               .has_value());
}
