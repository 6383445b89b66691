// How far errors of a map add up along rays, against fogs where that is known.
#include "wfog/ray_errors.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "wavefog/fogmap/fog.h"

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
                // The reserve of a quarter, segments up to half longer than said.
                const double without_depth = std::expm1(extinction * kError * path * 1.25 * 1.5);
                CHECK(found <= without_depth);
                // A segment that enters the fog from clear air is rated by the shortest of its
                // class, so depth does not count in full.
                if (extinction * path > 10) CHECK(found <= without_depth * 0.5);
            }
}

}  // namespace wavefog
