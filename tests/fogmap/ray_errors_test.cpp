// How far errors of a map add up along rays, against fogs where that is known.
#include "wfog/ray_errors.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "support/random.h"
#include "wavefog/fogmap/fog.h"
#include "wavefog/fogmap/reference.h"

namespace wavefog {
namespace {

constexpr double kDensity = 0.5, kError = 0.01;

/// The largest change of exp(-K density s) on segments of up to `path` metres.
double largest_change(double extinction, double path) {
    double worst = 0;
    for (int i = 0; i <= 1000; ++i) {
        const double s = path * i / 1000;
        worst = std::max(
            worst, std::exp(-extinction * kDensity * s) * std::expm1(extinction * kError * s));
    }
    return worst;
}

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
                const double found = wfog::worst_ray_error(*fog, map, error, path, 16);
                CHECK(found >= truth * 0.999);
                // The reserve of a tenth, segments up to a fifth (and one sample) longer than said.
                const double without_depth =
                    std::expm1(extinction * kError * (path * 1.2 + 1) * 1.1);
                CHECK(found <= without_depth);
                // A segment that enters the fog from clear air is rated by the shortest of its
                // class, so depth does not count in full.
                if (extinction * path > 10) CHECK(found <= without_depth * 0.5);
            }
}

TEST_CASE("ray errors: of rays through rough fog, each followed by itself") {
    test::Random random(20261122);
    for (const double path : {12.0, 40.0, 90.0})
        for (const double depth : {0.3, 3.0, 30.0}) {
            // Fog of 0.5 to 1.5, and errors that add up along some rays more than along others, in
            // either direction.
            const double lean = path < 50 ? 0.006 : -0.006;
            Grid<float> map(60, 70), error(60, 70);
            for (Eigen::Index j = 0; j < map.rows(); ++j)
                for (Eigen::Index i = 0; i < map.cols(); ++i) {
                    map(j, i) = float(random.uniform(0.5, 1.5));
                    error(j, i) = float(lean + 0.01 * std::sin(2 * 3.14159265 * double(i) / 70) +
                                        random.uniform(-0.005, 0.005));
                }
            auto first = make_fog(map, {.boundary = Boundary::repeat});
            auto second = make_fog(map + error, {.boundary = Boundary::repeat});
            REQUIRE((first.has_value() && second.has_value()));
            first->extinction = second->extinction = depth / path;
            const Reference of_map(*first), of_both(*second);
            double truth = 0;
            for (int ray = 0; ray < 20000; ++ray) {
                const Eigen::Vector3d o(random.uniform(0, 70), 0, random.uniform(0, 60));
                const double angle = random.uniform(0, 6.2832), rise = random.uniform(0, 0.785);
                const double length = path * std::sqrt(random.uniform(0, 1));
                const Eigen::Vector3d u(std::cos(angle) * std::cos(rise), std::sin(rise),
                                        std::sin(angle) * std::cos(rise));
                const Eigen::Vector3d p = o + length * u;
                truth = std::max(truth, std::fabs(std::exp(-of_map.optical_depth(o, p)) -
                                                  std::exp(-of_both.optical_depth(o, p))));
            }
            const double found = wfog::worst_ray_error(*first, map, error, path, 32);
            CAPTURE(path);
            CAPTURE(depth);
            CHECK(found >= truth);
            // A tenth for rays between lines, lengths in classes a fifth wide, and the worst of all
            // rays against that of 20000. Where a cell is deep itself, the depth of the shortest of
            // a class says little about a segment's.
            if (depth / path < 1) CHECK(found <= truth * (depth < 10 ? 2.0 : 8.0));
        }
}

}  // namespace wavefog
