// How far errors of a map add up along rays, against fogs where that is known.
#include "wfog/ray_errors.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "support/random.h"
#include "wavefog/fogmap/fog.h"
#include "wavefog/fogmap/reference.h"
#include "wfog/pixel_errors.h"

namespace wavefog {
namespace {

constexpr double kDensity = 0.5, kError = 0.01;

/// The largest change of exp(-K density s) on segments of up to `path` metres.
double largest_change(double extinction, double path) {
    double worst = 0;
    for (int i = 0; i <= 1000; ++i) {
        const double s = path * i / 1000;
        worst = std::max(
            worst, std::exp(-extinction * kDensity * s) * -std::expm1(-extinction * kError * s));
    }
    return worst;
}

const Profile kProfiles[] = {{},
                             {.kind = Profile::Kind::exponential, .base = 0, .scale = 9},
                             {.kind = Profile::Kind::linear, .top = 14, .base = 0},
                             {.kind = Profile::Kind::slab, .bottom = 0, .top = 11}};

constexpr double kGrounds[] = {-HUGE_VAL, -25, 0, 6};

/// The promise that is to be proved decides how closely; no bound is below it.
WfogOptions along(double path, double promise, double ground = 0) {
    WfogOptions options;
    options.path = path;
    options.error = promise;
    options.ground = ground;
    return options;
}

/// A ray from the height `lowest` or a little above it, of any slope: often level, or straight up
/// above a pixel's centre.
std::pair<Eigen::Vector3d, Eigen::Vector3d> random_ray(test::Random& random, double path,
                                                       double lowest, int width, int height) {
    Eigen::Vector3d from(random.uniform(0, width), lowest, random.uniform(0, height));
    double rise = std::numbers::pi / 2 * random.uniform(0, 1);
    const int kind = random.integer(0, 5);
    if (kind == 0) rise = 0;
    if (kind == 1) {
        rise = std::numbers::pi / 2;
        from = {std::floor(from.x()) + 0.5, lowest, std::floor(from.z()) + 0.5};
    }
    if (kind == 2) from.y() += random.uniform(0, 5);
    const double angle = random.uniform(0, 2 * std::numbers::pi);
    const Eigen::Vector3d along(std::cos(angle) * std::cos(rise), std::sin(rise),
                                std::sin(angle) * std::cos(rise));
    return {from, from + path * std::sqrt(random.uniform(0, 1)) * along};
}

/// A fog, and the same with an error in its map.
struct Pair {
    Fog fog, both;
    Reference of_map, of_both;

    Pair(const Grid<float>& map, const Grid<float>& error, const FogOptions& options,
         double extinction, const Profile& profile)
        : fog(made(map, options, extinction, profile)),
          both(made(map + error, options, extinction, profile)),
          of_map(fog),
          of_both(both) {}

    double difference(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const {
        return std::fabs(std::exp(-of_map.optical_depth(from, to)) -
                         std::exp(-of_both.optical_depth(from, to)));
    }

    double worst_of_random(test::Random& random, int rays, double path, double lowest) const {
        const Decomposition<float>& d = fog.decomposition;
        double worst = 0;
        for (int ray = 0; ray < rays; ++ray) {
            const auto [from, to] = random_ray(random, path, lowest, d.width, d.height);
            worst = std::max(worst, difference(from, to));
        }
        return worst;
    }

    /// Cells so many metres long along x.
    void stretch_x(double cell) {
        const auto stretched = [&](Fog& of) {
            of.rect.x1 = of.rect.x0 + cell * of.decomposition.width;
            return Reference(of);
        };
        of_map = stretched(fog);
        of_both = stretched(both);
    }

  private:
    static Fog made(const Grid<float>& map, const FogOptions& options, double extinction,
                    const Profile& profile) {
        auto fog = make_fog(map, options);
        REQUIRE(fog.has_value());
        fog->extinction = extinction;
        fog->profile = profile;
        return *fog;
    }
};

}  // namespace

TEST_CASE("ray errors: an error that is the same everywhere, in thin and in dense fog") {
    const Grid<float> map = Grid<float>::Constant(120, 160, float(kDensity));
    const Grid<float> error = Grid<float>::Constant(120, 160, float(kError));
    for (const Profile& profile :
         {Profile{}, Profile{.kind = Profile::Kind::exponential, .base = 0, .scale = 10}})
        for (const double extinction : {0.001, 0.02, 0.1, 1.0})
            for (const double path : {5.0, 60.0, 110.0}) {
                // Tiles: no clear air around, so that depth counts in full.
                auto fog = make_fog(map, {.boundary = Boundary::repeat});
                REQUIRE(fog.has_value());
                fog->extinction = extinction;
                fog->profile = profile;
                CAPTURE(extinction);
                CAPTURE(path);
                const double truth = largest_change(extinction, path);
                // In deep fog the error grows with depth, as steeply as may be: two prices of depth
                // come near to it.
                for (const double more : {0.9, 1.5}) {
                    const double found =
                        wfog::worst_ray_error(*fog, map, error, along(path, more * truth), 2);
                    CHECK(found >= truth * 0.999);
                    if (profile.kind == Profile::Kind::uniform) CHECK(found <= truth * 1.001);
                    if (more > 1) CHECK(found <= more * truth);
                }
            }
}

TEST_CASE("ray errors: of rays of every slope through rough fog, each followed by itself") {
    test::Random random(20261122);
    constexpr int width = 70, height = 60;
    for (const Profile& profile : kProfiles)
        for (const double path : {12.0, 40.0, 90.0})
            for (const double depth : {0.3, 3.0, 30.0}) {
                // Fog of 0.5 to 1.5, and errors that add up along some rays more than along others,
                // in either direction.
                const double lean = path < 50 ? 0.006 : -0.006;
                Grid<float> map(height, width), error(height, width);
                for (Eigen::Index j = 0; j < map.rows(); ++j)
                    for (Eigen::Index i = 0; i < map.cols(); ++i) {
                        map(j, i) = float(random.uniform(0.5, 1.5));
                        error(j, i) =
                            float(lean + 0.01 * std::sin(2 * std::numbers::pi * double(i) / width) +
                                  random.uniform(-0.005, 0.005));
                    }
                const Pair pair(map, error, {.boundary = Boundary::repeat}, depth / path, profile);
                for (const double ground : kGrounds) {
                    // Rays that start a path below the base see as much fog as any.
                    const bool starts = profile.kind == Profile::Kind::slab;
                    const double lowest = std::max(ground, starts ? profile.bottom : -path);
                    const double truth = pair.worst_of_random(random, 20000, path, lowest);
                    CAPTURE(int(profile.kind));
                    CAPTURE(path);
                    CAPTURE(depth);
                    CAPTURE(ground);
                    // The worst of all rays against that of twenty thousand; one price of depth for
                    // all fog that a ray crosses.
                    for (const double more : {0.5, depth < 10 ? 2.0 : 4.0}) {
                        const double found = wfog::worst_ray_error(
                            pair.fog, map, error, along(path, more * truth, ground), 2);
                        CHECK(found >= truth);
                        if (more > 1) CHECK(found <= truth * more);
                    }
                }
            }
}

TEST_CASE("ray errors: alike along rows, columns, diagonals or another line, over a whole map") {
    test::Random random(20261125);
    constexpr int side = 300;
    constexpr double path = 280;
    const Profile slab{.kind = Profile::Kind::slab, .bottom = 0, .top = 1};
    for (const int kind : {0, 1, 2, 3})
        for (const double long_cell : {1.0, 3.0}) {
            std::vector<float> of_line(2 * side);
            for (float& each : of_line) each = float(random.uniform(-0.01, 0.01));
            Grid<float> error(side, side);
            for (int j = 0; j < side; ++j)
                for (int i = 0; i < side; ++i)
                    error(j, i) = of_line[size_t(kind == 0   ? j
                                                 : kind == 1 ? i
                                                 : kind == 2 ? i + j
                                                             : i - j + side)];
            Pair pair(Grid<float>::Constant(side, side, 1.0f), error, {}, 0.001, slab);
            pair.stretch_x(long_cell);
            double truth = 0;
            for (int start = 0; start < side; ++start) {
                // Along the line in cells, through pixel centres.
                const double s = start + 0.5, end = side - 0.5;
                const std::pair<Eigen::Vector3d, Eigen::Vector3d> rays[] = {
                    {{0.5, 0.5, s}, {end, 0.5, s}},
                    {{s, 0.5, 0.5}, {s, 0.5, end}},
                    {{0.5, 0.5, s}, {s, 0.5, 0.5}},
                    {{0.5, 0.5, s}, {side - s, 0.5, end}}};
                auto [from, to] = rays[kind];
                from.x() *= long_cell;
                to.x() *= long_cell;
                const double length = (to - from).norm();
                if (length > path) to = from + (to - from) * (path / length);
                truth = std::max(truth, pair.difference(from, to));
            }
            CAPTURE(kind);
            CAPTURE(long_cell);
            for (const double more : {0.5, 1.5}) {
                const double found =
                    wfog::worst_ray_error(pair.fog, Grid<float>::Constant(side, side, 1), error,
                                          along(path, more * truth), 2);
                // Floats of the map are rounded.
                CHECK(found >= truth * (1 - 1e-5));
                if (more > 1) CHECK(found <= truth * more);
            }
        }
}

TEST_CASE("ray errors: cells a billion times as long as wide take no memory and no time") {
    const Grid<float> map = Grid<float>::Constant(64, 64, 0.5f);
    for (const double long_cell : {1e3, 1e9, 1e15})
        for (const Boundary boundary : {Boundary::zero, Boundary::repeat})
            for (const Profile& profile : kProfiles) {
                Pair pair(map, map * 0.01f, {.boundary = boundary}, 1e-3, profile);
                pair.stretch_x(long_cell);
                const double found =
                    wfog::worst_ray_error(pair.fog, map, map * 0.01f, along(500, 1e-9), 4);
                CHECK(found > 0);
                CHECK(found <= 0.01);
            }
}

TEST_CASE("ray errors: no fog above the ground, no error") {
    const Grid<float> map = Grid<float>::Constant(9, 9, 1.0f);
    for (const Profile& profile : kProfiles) {
        const Pair pair(map, map * 0.1f, {}, 1, profile);
        const bool ends =
            profile.kind == Profile::Kind::slab || profile.kind == Profile::Kind::linear;
        const double found = wfog::worst_ray_error(pair.fog, map, map * 0.1f, along(50, 0.1, 14), 2);
        CHECK((found == 0) == ends);
    }
}

TEST_CASE("ray errors: one wrong pixel is worst straight up") {
    constexpr double path = 90;
    for (const Profile& profile : kProfiles) {
        const Grid<float> map = Grid<float>::Constant(40, 50, 0.1f);
        Grid<float> error = Grid<float>::Zero(40, 50);
        error(20, 30) = 0.05f;
        const Pair pair(map, error, {}, 0.05, profile);
        const Eigen::Vector3d foot(30.5, 0, 20.5), end = foot + path * Eigen::Vector3d::UnitY();
        const double truth = pair.difference(foot, end);
        CAPTURE(int(profile.kind));
        // A ray at an angle stays in the fog for longer, but soon leaves the pixel.
        for (const double promise : {0.9 * truth, 1.1 * truth}) {
            const double found =
                wfog::worst_ray_error(pair.fog, map, error, along(path, promise), 2);
            CHECK(found >= truth * 0.999);
            if (promise > truth) CHECK(found <= promise);
        }
    }
}

TEST_CASE("ray errors: uniform fog is bounded by its pixels, thin ones beside dense ones too") {
    test::Random random(20261123);
    constexpr int width = 40, height = 30;
    for (const int degree : {0, 1, 2})
        for (const double extinction : {0.01, 0.3, 5.0})
            for (const double path : {10.0, 200.0}) {
                Grid<float> map(height, width), error(height, width);
                for (Eigen::Index i = 0; i < map.size(); ++i) {
                    // Clear air to dense fog, and errors that grow with density; never below 0.
                    const double density =
                        random.integer(0, 3) == 0 ? 0 : 2 * std::pow(random.uniform(0, 1), 3);
                    const double off = (0.01 + 0.1 * density) * random.uniform(-1, 1);
                    map.data()[i] = float(density);
                    error.data()[i] = float(std::max(off, -density));
                }
                const Pair pair(map, error, {.degree = degree, .levels = 0}, extinction, {});
                const double truth = pair.worst_of_random(random, 6000, path, 0);
                const double found =
                    wfog::worst_ray_error(pair.fog, map, error, along(path, 1e-9), 1);
                CAPTURE(degree);
                CAPTURE(extinction);
                CAPTURE(path);
                CHECK(found >= truth);
                // Splines of degree 2 smooth the worst pixels; the hull joins thin and dense ones
                // that do not lie side by side, at most 1.4 times too much.
                if (degree < 2) CHECK(found <= truth * 1.4);
            }
}

TEST_CASE("ray errors: the bound of pixels is that of all their means") {
    test::Random random(20261124);
    for (int round = 0; round < 200; ++round) {
        const double extinction = std::exp(random.uniform(-6, 6)), path = random.uniform(1, 9);
        Grid<float> map(1, 6), error(1, 6);
        for (Eigen::Index i = 0; i < map.size(); ++i) {
            map.data()[i] = float(std::exp(random.uniform(-8, 2)) * random.integer(0, 4));
            error.data()[i] = std::max(
                float(std::exp(random.uniform(-9, 0)) * random.uniform(-1, 1)), -map.data()[i]);
        }
        const double found = wfog::PixelErrors(map, error).worst_change(extinction * path);
        double of_pairs = 0;
        // Means of two, of every length.
        for (Eigen::Index a = 0; a < map.size(); ++a)
            for (Eigen::Index b = 0; b <= a; ++b)
                for (int t = 0; t <= 32; ++t)
                    for (int k = 0; k <= 200; ++k) {
                        const double w = t / 32.0, s = extinction * path * std::exp(-k / 20.0);
                        const auto mean = [&](const Grid<float>& of) {
                            return w * double(of.data()[a]) + (1 - w) * double(of.data()[b]);
                        };
                        of_pairs = std::max(of_pairs, std::fabs(std::exp(-s * mean(map)) -
                                                                std::exp(-s * mean(map + error))));
                    }
        // Floats of the sum are rounded.
        CHECK(found >= of_pairs * (1 - 1e-5));
        double reach = 0;  // of the pixels alone
        for (Eigen::Index i = 0; i < map.size(); ++i)
            reach = std::max(reach, double(std::fabs(error.data()[i])));
        CHECK(found <= extinction * path * reach * (1 + 1e-6));
        CHECK(found <= 1);
    }
}

}  // namespace wavefog
