// The certified bound of method radial: no ray's error is above it, and it is not far above.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "fogmap/fog_support.h"
#include "radial_around.h"
#include "wavefog/fogmap/image.h"
#include "wavefog/fogmap/reference.h"
#include "wavefog/gpu/fog_pass.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

// ShaderOnCpu has every azimuth, without a far plane.
constexpr double kFar = 1e6;

struct Figures {
    double measured = 0;
    double bound = 0;
};

/// Of rays from `eye` to `points`.
Figures figures_of(const Fog& fog, const Method& method, const Eigen::Vector3d& eye,
                   const std::vector<Eigen::Vector3d>& points) {
    auto shader = ShaderOnCpu::create(fog, method);
    REQUIRE_MESSAGE(shader.has_value(), (shader ? "" : shader.error().message));
    const Reference reference(fog);
    Figures figures;
    RayLimits limits;
    limits.steepest = 1;
    for (const Eigen::Vector3d& p : points) {
        limits.length = std::max(limits.length, (p - eye).norm());
        limits.rise = std::max(limits.rise, std::abs(p.y() - eye.y()));
        const double ground = std::hypot(p.x() - eye.x(), p.z() - eye.z());
        limits.steepest = std::max(limits.steepest, (p - eye).norm() / ground);
        const double error = std::abs(std::exp(-shader->optical_depth(eye, p)) -
                                      std::exp(-reference.optical_depth(eye, p)));
        figures.measured = std::max(figures.measured, error);
    }
    const DetailBound dropped(fog);
    figures.bound = RadialBound(fog, dropped).impl().around(method, eye, {}, 0, kFar, limits);
    return figures;
}

/// Rays of all directions and lengths, most of them between columns and rows, some along the axes.
std::vector<Eigen::Vector3d> points_around(const Eigen::Vector3d& eye, double farthest, double low,
                                           double high, int count, Random& random) {
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < count; ++i) {
        double angle = random.uniform(0, 2 * std::numbers::pi);
        if (i % 8 == 0)
            angle = std::round(angle / (std::numbers::pi / 4)) * (std::numbers::pi / 4) +
                    random.uniform(-0.01, 0.01);
        const double share = random.uniform(0, 1), r = farthest * share * share;
        points.push_back({eye.x() + r * std::cos(angle), random.uniform(low, high),
                          eye.z() + r * std::sin(angle)});
    }
    return points;
}

struct Named {
    std::string name;
    Grid<float> map;
};

std::vector<Named> hard_maps(Random& random) {
    std::vector<Named> maps;
    for (const MapKind kind : {MapKind::random, MapKind::impulse, MapKind::checkerboard,
                               MapKind::smooth, MapKind::hard_edged})
        maps.push_back({map_name(kind), make_map<float>(kind, 24, 18, random)});
    // One texel wide, along the view and at an angle to it.
    Grid<float> lines = Grid<float>::Zero(18, 24);
    lines.row(8) = 1;
    lines.col(11) = 1;
    maps.push_back({"lines", lines});
    lines.setZero();
    for (int i = 0; i < 24; ++i) lines(i * 17 / 23, i) = 1;
    maps.push_back({"a diagonal", lines});
    return maps;
}

Fog placed(const Grid<float>& map, int degree, int levels) {
    Fog fog = fog_of(map, {.degree = degree, .levels = levels});
    fog.rect = {-20, -12, 28, 24};
    fog.extinction = 0.08;
    return fog;
}

}  // namespace

TEST_CASE("radial bound: above every error of random and adversarial maps") {
    Random random(211);
    double closest = 0;
    for (const Named& named : hard_maps(random))
        for (int degree = 0; degree <= 2; ++degree) {
            Fog fog = placed(named.map, degree, 2);
            for (const Profile& profile : all_profiles()) {
                fog.profile = profile;
                // Inside, on a face between cells, on the map's edge and corner, outside, looking
                // along an edge from outside, and above.
                const double half = degree % 2 == 1 ? 1.0 : 0.0;
                for (const Eigen::Vector3d& eye :
                     {Eigen::Vector3d(3.3, 2.1, 5.2), Eigen::Vector3d(4 + half, 3, 6 + half),
                      Eigen::Vector3d(-20, 1.5, 3.7), Eigen::Vector3d(28, -3, 24),
                      Eigen::Vector3d(-41.3, 4, 44.7), Eigen::Vector3d(-50, 2, 24),
                      Eigen::Vector3d(2.3, 31.1, 4.4)}) {
                    const auto points = points_around(eye, 90, -4, 12, 400, random);
                    for (const Method& method :
                         {Method{.kind = MethodKind::radial, .radial = {301, 70}},
                          Method{.kind = MethodKind::radial,
                          .radial = {301, 24},
                          .radial_step = true}}) {
                        const Figures figures = figures_of(fog, method, eye, points);
                        CAPTURE(named.name);
                        CAPTURE(degree);
                        CAPTURE(static_cast<int>(profile.kind));
                        CAPTURE(eye.transpose());
                        CAPTURE(method.name());
                        CHECK_LE(figures.measured, figures.bound);
                        CHECK_LE(figures.bound, 1);
                        closest = std::max(closest, figures.measured / figures.bound);
                    }
                }
            }
        }
    // Some ray comes near its bound: it is not slack everywhere.
    CHECK_GE(closest, 0.5);
}

TEST_CASE("radial bound: a real map's is small where the error is") {
    const auto read = read_fogmap(std::filesystem::path(WAVEFOG_DATA_DIR) / "weather_crop_64.png");
    REQUIRE(read.has_value());
    Random random(223);
    for (int degree = 0; degree <= 2; ++degree) {
        Fog fog = fog_of(read->pixels, {.degree = degree, .levels = 3});
        fog.rect = {-200, -200, 200, 200};
        fog.extinction = 0.12;
        for (const Profile& profile : all_profiles()) {
            fog.profile = profile;
            if (profile.kind == Profile::Kind::slab) fog.profile.top = 12;
            if (profile.kind == Profile::Kind::linear) fog.profile.top = 20;
            for (const double height : {6.0, 25.0}) {
                const Eigen::Vector3d eye(0, height, 90);
                // No steeper than a camera that looks ahead sees.
                auto points = points_around(eye, 150, -0.5, 0.3, 6000, random);
                for (Eigen::Vector3d& p : points)
                    p.y() = height + p.y() * std::hypot(p.x() - eye.x(), p.z() - eye.z());
                const Figures figures = figures_of(fog, {.kind = MethodKind::radial}, eye, points);
                CAPTURE(degree);
                CAPTURE(static_cast<int>(profile.kind));
                CAPTURE(height);
                CHECK_LE(figures.measured, figures.bound);
                if (figures.measured < 2e-3) CHECK_LE(figures.bound, 0.1);
            }
        }
    }
}

TEST_CASE("radial bound: rays that end inside a row much thicker than the fog there") {
    // A ring around the eye: all azimuths alike, and so tall a scale height that nothing but the
    // last, partial stretch errs.
    Random random(225);
    Grid<float> ring = Grid<float>::Zero(96, 96);
    for (int y = 0; y < 96; ++y)
        for (int x = 0; x < 96; ++x) {
            const double r = std::hypot(x - 47.5, y - 47.5) / 2;
            if (r > 12 && r < 13) ring(y, x) = 1;
        }
    Fog fog = fog_of(ring, {.degree = 1, .levels = 1});
    fog.rect = {-24, -24, 24, 24};
    fog.extinction = 0.4;
    fog.profile = {.kind = Profile::Kind::exponential, .base = 0, .scale = 500};
    const Eigen::Vector3d eye(0, 3, 0);
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 2000; ++i) {
        const double angle = random.uniform(0, 2 * std::numbers::pi), r = random.uniform(8, 18);
        points.push_back({r * std::cos(angle), 3 + random.uniform(-0.1, 0.1), r * std::sin(angle)});
    }
    for (const int rows : {6, 9, 12}) {
        const Figures figures =
            figures_of(fog, {.kind = MethodKind::radial, .radial = {2048, rows}}, eye, points);
        CAPTURE(rows);
        CHECK_LE(figures.measured, figures.bound);
        CHECK_GE(figures.measured, 0.1 * figures.bound);
        MESSAGE("measured ", figures.measured, ", bound ", figures.bound);
    }
}

TEST_CASE("radial bound: coarse approximations, a constant map, and no fog") {
    Random random(227);
    Fog fog = placed(make_map<float>(MapKind::smooth, 24, 18, random), 1, 3);
    const Eigen::Vector3d eye(3.3, 2.1, 5.2);
    const auto points = points_around(eye, 60, -4, 12, 300, random);
    Method method{.kind = MethodKind::radial, .radial = {768, 192}};
    for (const Profile& profile : all_profiles()) {
        fog.profile = profile;
        CAPTURE(static_cast<int>(profile.kind));
        double finer = 0;
        for (const double mu : {1.0, 0.97, 0.5, 0.0}) {
            method.mu = mu;
            CAPTURE(mu);
            const Figures figures = figures_of(fog, method, eye, points);
            CHECK_LE(figures.measured, figures.bound);
            // Every ray with mu below 1 is bounded by more than those with all details.
            if (mu < 1) CHECK_GE(figures.bound, finer);
            if (mu == 1) finer = figures.bound;
            if (figures.measured < 1e-2) CHECK_LT(figures.bound, 1);
        }
        method.mu = 1;
    }

    Fog constant = placed(Grid<float>::Ones(24, 18), 0, 1);
    constant.rect = {-500, -500, 500, 500};
    const Figures exact = figures_of(constant, method, eye, points);
    CHECK_LE(exact.measured, exact.bound);
    CHECK_LE(exact.bound, 1e-4);

    fog.extinction = 0;
    CHECK(figures_of(fog, method, eye, points).bound == 0.0);
}

TEST_CASE(
    "radial bound: repeated fog is bounded where it hides the table's end, or rays are short") {
    Random random(229);
    Fog fog = fog_of(0.25f + 0.75f * make_map<float>(MapKind::random, 16, 12, random),
                     {.degree = 1, .levels = 1, .boundary = Boundary::repeat});
    fog.rect = {-8, -6, 8, 6};
    fog.extinction = 0.05;
    const Eigen::Vector3d eye(3.3, 2.1, 5.2);
    const Method method{.kind = MethodKind::radial, .radial = {1536, 512}};
    const auto points = points_around(eye, 100, -4, 12, 300, random);
    const Figures figures = figures_of(fog, method, eye, points);
    CHECK_LE(figures.measured, figures.bound);
    CHECK_LT(figures.bound, 0.5);
    // Far behind the table's end the mean goes on.
    fog.extinction = 1e-4;
    for (const Profile& profile : all_profiles()) {
        fog.profile = profile;
        const Figures far =
            figures_of(fog, method, eye, points_around(eye, 5000, 2, 3, 50, random));
        CHECK_LE(far.measured, far.bound);
    }
}
