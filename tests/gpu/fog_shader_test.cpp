// The fog shader's GLSL, compiled as C++, against the double-precision reference: the failure
// catalogue of stability.md, section 8 (row numbers in the names).
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "fogmap/fog_support.h"
#include "wavefog/fogmap/reference.h"
#include "wavefog/gpu/fog_pass.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

// float32 keeps a position inside a map of 64 cells to 4e-6 cells and a sum of some hundred steps
// to 1e-6 of tau; exp(-tau) then loses at most tau exp(-tau) <= 0.37 of that.
constexpr double kMaxError = 2e-6;

ShaderOnCpu shader_of(const Fog& fog, const Method& method) {
    auto shader = ShaderOnCpu::create(fog, method);
    REQUIRE_MESSAGE(shader.has_value(), (shader ? "" : shader.error().message));
    return std::move(*shader);
}

using Segment = std::pair<Eigen::Vector3d, Eigen::Vector3d>;

struct Evaluators {
    Reference reference;
    ShaderOnCpu shader;
    double mu;
    Evaluators(const Fog& fog, double keep)
        : reference(fog), shader(shader_of(fog, {.mu = keep})), mu(keep) {}
    double error(const Segment& s) const {
        const double truth = std::exp(-reference.optical_depth(s.first, s.second, mu));
        const double tau = shader.optical_depth(s.first, s.second);
        REQUIRE_MESSAGE(std::isfinite(tau), "tau is not finite");
        REQUIRE(tau >= 0);
        return std::abs(std::exp(-tau) - truth);
    }
};

double worst(const Fog& fog, const std::vector<Segment>& segments, double mu = 1) {
    const Evaluators both(fog, mu);
    double largest = 0;
    const Segment* at = nullptr;
    for (const auto& s : segments)
        if (const double e = both.error(s); e > largest) {
            largest = e;
            at = &s;
        }
    if (at && largest > kMaxError) {
        INFO("from " << at->first.transpose() << " to " << at->second.transpose());
        CHECK_LE(largest, kMaxError);
    }
    return largest;
}

std::vector<Segment> random_segments(Random& random, int count) {
    std::vector<Segment> segments;
    for (int i = 0; i < count; ++i)
        segments.emplace_back(random_point(random), random_point(random));
    return segments;
}

FogOptions options_of(int degree, Boundary boundary = Boundary::zero, int levels = 3) {
    FogOptions options;
    options.degree = degree;
    options.boundary = boundary;
    options.levels = levels;
    return options;
}

// Mostly empty, so that the walk takes long steps (FOG_SKIP).
Fog sparse_fog(const FogOptions& options) {
    Grid<float> map = Grid<float>::Zero(64, 64);
    for (int j = 40; j < 50; ++j)
        for (int i = 10; i < 25; ++i) map(j, i) = 1.0f;
    map(5, 60) = 0.5f;
    Fog fog = fog_of(map, options);
    fog.rect = {-32, -32, 32, 32};
    fog.extinction = 0.1;
    return fog;
}

}  // namespace

TEST_CASE("shader: random rays, every basis, profile and border, mu 1 to 0") {
    Random random(2026);
    const auto segments = random_segments(random, 400);
    for (const Boundary boundary : {Boundary::zero, Boundary::repeat})
        for (int degree = 0; degree <= 2; ++degree) {
            Fog fog = random_fog(48, 32, options_of(degree, boundary), random);
            for (const auto& profile : all_profiles())
                for (const double mu : {1.0, 0.7, 0.3, 0.0}) {
                    fog.profile = profile;
                    CAPTURE(degree);
                    CAPTURE(static_cast<int>(profile.kind));
                    CAPTURE(mu);
                    CHECK_LE(worst(fog, segments, mu), kMaxError);
                }
        }
}

TEST_CASE("shader: sparse maps take long steps and lose nothing") {
    Random random(7);
    for (const Boundary boundary : {Boundary::zero, Boundary::repeat})
        for (int degree = 0; degree <= 2; ++degree)
            for (const auto& profile : all_profiles()) {
                Fog fog = sparse_fog(options_of(degree, boundary, 4));
                fog.profile = profile;
                for (const double mu : {1.0, 0.5}) {
                    CAPTURE(degree);
                    CAPTURE(static_cast<int>(profile.kind));
                    CAPTURE(mu);
                    CHECK_LE(worst(fog, random_segments(random, 300), mu), kMaxError);
                }
            }
}

TEST_CASE("shader: families with negative approximations, clamped step by step") {
    Random random(11);
    const auto segments = random_segments(random, 300);
    for (const char* family : {"2,2", "2,4", "chui-wang", "positive"}) {
        FogOptions options = options_of(1);
        options.family = family;
        options.form = Form::scaling;
        const Grid<float> map = make_map<float>(MapKind::hard_edged, 64, 48, random);
        Fog fog = fog_of(map, options);
        fog.rect = {-20, -12, 28, 24};
        fog.extinction = 0.1;
        for (const auto& profile : all_profiles()) {
            fog.profile = profile;
            for (const double mu : {1.0, 0.8, 0.4, 0.0}) {
                CAPTURE(std::string(family));
                CAPTURE(static_cast<int>(profile.kind));
                CAPTURE(mu);
                CHECK_LE(worst(fog, segments, mu), kMaxError);
            }
        }
    }
}

TEST_CASE(
    "shader: rows 1-3: axis-parallel, diagonal, vertex, grid-line, zero-length, grazing rays") {
    Random random(3);
    for (int degree = 0; degree <= 2; ++degree) {
        Fog fog = fog_of(0.25f + 0.75f * make_map<float>(MapKind::random, 32, 32, random),
                         options_of(degree, Boundary::zero, 2));
        fog.rect = {0, 0, 32, 32};
        fog.extinction = 0.04;
        // Knots lie at integer u = x + d / 2.
        const double knot = degree % 2 ? 0.5 : 0.0;
        std::vector<Segment> segments;
        for (const double z : {7.3, 7.0 + knot, 16.0 + knot, 0.0, 31.9})
            for (const double y : {1.0, 4.0}) {
                segments.push_back({{-5, 1, z}, {40, y, z}});
                segments.push_back({{40, 1, z}, {-5, y, z}});
                segments.push_back({{z, 1, 40}, {z, y, -5}});
                segments.push_back({{8 + knot, 1, z}, {25, y, z}});
            }
        for (const double shift : {0.0, knot, 0.3}) {
            segments.push_back({{-4 + shift, 0, -4 + shift}, {36 + shift, 2, 36 + shift}});
            segments.push_back({{36, 0, -4 + shift}, {-4, 2, 36 + shift}});
        }
        segments.push_back({{8, 1, 8}, {8, 1, 8}});
        segments.push_back({{8 + knot, 1, 8 + knot}, {8 + knot, 9, 8 + knot}});
        for (const auto& profile : all_profiles()) {
            fog.profile = profile;
            CAPTURE(degree);
            CAPTURE(static_cast<int>(profile.kind));
            CHECK_LE(worst(fog, segments), kMaxError);
        }
        // Grazing the box: degree >= 1 ends at zero there; Haar may fall to either side of its
        // jump.
        const double edge = degree / 2.0;
        const Segment grazing{{-5, 1, 32 + edge - 2e-5}, {40, 1, 32 + edge + 2e-5}};
        const Evaluators both(fog, 1);
        const double tau = both.shader.optical_depth(grazing.first, grazing.second);
        CHECK(std::isfinite(tau));
        if (degree > 0) CHECK_LE(both.error(grazing), kMaxError);
        // A zero-length segment.
        CHECK(both.shader.optical_depth({8, 1, 8}, {8, 1, 8}) == 0);
    }
}

TEST_CASE("shader: rows 4-6: world offset 1e6 m, eye 1e5 cells away, tiny cells and rays") {
    Random random(5);
    for (int degree = 0; degree <= 2; ++degree) {
        Fog fog = random_fog(48, 32, options_of(degree), random);
        CAPTURE(degree);
        Fog far_fog = fog;
        far_fog.rect = {fog.rect.x0 + 1e6, fog.rect.z0 - 1e6, fog.rect.x1 + 1e6, fog.rect.z1 - 1e6};
        std::vector<Segment> shifted;
        const Eigen::Vector3d offset(1e6, 0, -1e6);
        for (const auto& s : random_segments(random, 300))
            shifted.emplace_back(s.first + offset, s.second + offset);
        CHECK_LE(worst(far_fog, shifted), kMaxError);

        std::vector<Segment> from_afar;
        for (int i = 0; i < 300; ++i)
            from_afar.emplace_back(Eigen::Vector3d(-1e5, 30 + i, random.uniform(-1e4, 1e4)),
                                   random_point(random));
        CHECK_LE(worst(fog, from_afar), kMaxError);

        Fog tiny = fog;
        tiny.rect = {0, 0, 48e-4, 32e-4};
        tiny.extinction = 500;
        std::vector<Segment> small;
        for (int i = 0; i < 300; ++i) {
            const Eigen::Vector3d o(random.uniform(0, 48e-4), 0, random.uniform(0, 32e-4));
            small.emplace_back(o, o + 1e-5 * Eigen::Vector3d(random.normal(), 0, random.normal()));
        }
        CHECK_LE(worst(tiny, small), kMaxError);
    }
}

TEST_CASE("shader: rows 7-8: tau above 100 and far below 1") {
    Random random(13);
    Fog fog = random_fog(48, 32, options_of(1), random);
    fog.extinction = 100;
    const Segment through{{-30, 0, 3}, {40, 0, 7}};
    const Evaluators dense(fog, 1);
    // The walk stops at tau = 14.6, where T = 4.6e-7.
    CHECK_GE(dense.shader.optical_depth(through.first, through.second), 14.6);
    CHECK_LE(dense.error(through), kMaxError);
    for (const double extinction : {1e-4, 1e-7, 1e-12}) {
        fog.extinction = extinction;
        const Evaluators thin(fog, 1);
        const double truth = thin.reference.optical_depth(through.first, through.second);
        CHECK_LE(std::abs(thin.shader.optical_depth(through.first, through.second) - truth),
                 2e-6 * truth);
    }
}

TEST_CASE("shader: row 9: with details dropped T stays in [0,1] and falls along the ray") {
    Random random(17);
    FogOptions options = options_of(1, Boundary::zero, 3);
    Fog fog = fog_of(make_map<float>(MapKind::hard_edged, 64, 64, random), options);
    fog.rect = {0, 0, 64, 64};
    fog.extinction = 0.2;
    const ShaderOnCpu shader = shader_of(fog, {.kind = MethodKind::exact, .mu = 0});
    for (int i = 0; i < 200; ++i) {
        // The approximation's knots lie 8 cells apart; whole steps can only add.
        const double z = random.uniform(0, 64);
        double before = 0;
        for (double u = 8; u <= 64; u += 8) {
            const double tau = shader.optical_depth({-1, 0, z}, {u - 0.5, 0, z});
            REQUIRE(tau >= before - 2e-6 * (1 + before));  // float32 rounding of the sum
            before = tau;
        }
        const Eigen::Vector3d o(random.uniform(0, 64), 0, random.uniform(0, 64));
        const Eigen::Vector3d d(random.normal(), 0, random.normal());
        REQUIRE(shader.optical_depth(o, o + 20 * d) >= 0);
    }
}

TEST_CASE("shader: rows 14 and 19: empty air stays empty, a constant map equals homogeneous fog") {
    Random random(19);
    for (int degree = 0; degree <= 2; ++degree) {
        Fog sparse = sparse_fog(options_of(degree, Boundary::zero, 4));
        const ShaderOnCpu shader = shader_of(sparse, {});
        // Rows -30..-10 hold no fog.
        CHECK_LE(shader.optical_depth({-30, 0, -12}, {20, 0, -14}), 1e-6);

        Fog constant = fog_of(make_map<float>(MapKind::constant, 40, 40, random),
                              options_of(degree, Boundary::repeat, 3));
        constant.rect = {0, 0, 40, 40};
        constant.extinction = 0.03;
        const ShaderOnCpu flat = shader_of(constant, {});
        for (int i = 0; i < 100; ++i) {
            const Eigen::Vector3d o(random.uniform(-100, 100), random.uniform(-9, 9),
                                    random.uniform(-100, 100));
            const Eigen::Vector3d p(random.uniform(-100, 100), random.uniform(-9, 9),
                                    random.uniform(-100, 100));
            const double tau = 0.03 * (p - o).norm();
            CHECK_LE(std::abs(std::exp(-flat.optical_depth(o, p)) - std::exp(-tau)), kMaxError);
        }
    }
}

TEST_CASE("shader: rows 17-18: vertical and horizontal rays, any scale height, eye far below") {
    Random random(23);
    for (int degree = 0; degree <= 2; ++degree) {
        Fog fog = random_fog(48, 32, options_of(degree), random);
        for (const double scale : {0.01, 1.0, 8.0, 1e4}) {
            fog.profile = {.kind = Profile::Kind::exponential, .base = 0, .scale = scale};
            std::vector<Segment> segments;
            for (int i = 0; i < 50; ++i) {
                const Eigen::Vector3d o = random_point(random);
                segments.push_back({o, o + Eigen::Vector3d(0, random.uniform(-50, 50), 0)});
                segments.push_back({o, o + Eigen::Vector3d(0, 5e-12, 0)});
                Eigen::Vector3d level = random_point(random);
                level.y() = o.y();
                segments.push_back({o, level});
                segments.push_back({o - Eigen::Vector3d(0, 1e4, 0), level});
                segments.push_back({level + Eigen::Vector3d(0, 1e3, 0), o});
            }
            CAPTURE(degree);
            CAPTURE(scale);
            CHECK_LE(worst(fog, segments), kMaxError);
        }
    }
}

TEST_CASE("shader: tau(a,b) = tau(b,a), and the parts add up") {
    Random random(29);
    for (int degree = 0; degree <= 2; ++degree) {
        const Fog fog = random_fog(48, 32, options_of(degree), random);
        const ShaderOnCpu shader = shader_of(fog, {});
        for (const auto& s : random_segments(random, 200)) {
            const double whole = shader.optical_depth(s.first, s.second);
            CHECK_LE(std::abs(whole - shader.optical_depth(s.second, s.first)), 2e-6 * (1 + whole));
            const Eigen::Vector3d middle = s.first + random.uniform() * (s.second - s.first);
            CHECK_LE(std::abs(whole - shader.optical_depth(s.first, middle) -
                              shader.optical_depth(middle, s.second)),
                     4e-6 * (1 + whole));
        }
    }
}

TEST_CASE("shader: march:N converges to exact on linear fog with N") {
    Random random(31);
    const Fog fog = random_fog(48, 32, options_of(1), random);
    const ShaderOnCpu exact = shader_of(fog, {});
    const auto segments = random_segments(random, 50);
    double before = 1;
    for (const int samples : {16, 256, 4096}) {
        const ShaderOnCpu march = shader_of(fog, {.kind = MethodKind::march, .samples = samples});
        double largest = 0;
        for (const auto& s : segments)
            largest = std::max(largest, std::abs(march.optical_depth(s.first, s.second) -
                                                 exact.optical_depth(s.first, s.second)));
        CHECK_LT(largest, before);
        before = largest;
    }
    // 4096 mid-points: (h^2 / 24) of slope jumps of 1 per cell, and float32 sums of 4096 terms.
    CHECK_LE(before, 1e-4);
}
