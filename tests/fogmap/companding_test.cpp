// Steps of density that grow with it.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "support/random.h"
#include "wfog/samples.h"

namespace wavefog {
namespace {

using wfog::Scale;

/// How far apart the densities around `k` are.
double step_at(const Scale& scale, std::int32_t k) {
    return double(scale.density(k + 1)) - double(scale.density(k));
}

}  // namespace

TEST_CASE("companding: densities rise, 0 stays 0, and integers come back") {
    for (const double coarseness : {1.001, 2.0, 16.0, 1000.0})
        for (const double step : {1e-6, 0.01, 3.0}) {
            const Scale scale = wfog::companded_scale(step, coarseness, 2000 * step);
            CAPTURE(coarseness);
            CAPTURE(step);
            CHECK(scale.density(0) == 0);
            CHECK(std::signbit(scale.density(0)) == false);
            for (std::int32_t k = 0; k < 20000; ++k) {
                CHECK(scale.density(k + 1) > scale.density(k));
                CHECK(scale.density(-k) == -scale.density(k));
                CHECK(scale.integer(scale.density(k)) == k);
                CHECK(scale.integer(scale.density(-k)) == -k);
            }
            // As far as they go: they never fall, and what is too large is said to be.
            for (std::int32_t k = 1 << 15; k < 1 << 30; k += k / 7)
                CHECK(scale.density(k + 1) >= scale.density(k));
            CHECK_FALSE(Scale{.kind = Scale::Kind::companded, .step = 1e-30, .growth = 1e-12}
                            .integer(3e38f)
                            .has_value());
        }
}

TEST_CASE("companding: densities by hand") {
    const Scale scale{.kind = Scale::Kind::companded, .step = 2, .growth = 0.5};
    CHECK(scale.density(1) == 5.25f);   // q(1) = 1.5, q(1.5) = 2.625
    CHECK(scale.density(3) == 71.25f);  // q(3) = 7.5, q(7.5) = 35.625
    CHECK(scale.density(-3) == -71.25f);
    CHECK(scale.integer(40.0f) == 2);  // 24 and 71.25 are its neighbours
}

TEST_CASE("companding: steps are as coarse as they should be, and the densities those between") {
    for (const double coarseness : {1.5, 4.0, 64.0}) {
        const double step = 1e-4, most = 3;
        const Scale scale = wfog::companded_scale(step, coarseness, most);
        CHECK(step_at(scale, 0) == doctest::Approx(step).epsilon(0.01));
        const std::int32_t last = *scale.integer(float(most));
        // Two floats near 3 are 2e-7 apart.
        CHECK(step_at(scale, last) == doctest::Approx(coarseness * step).epsilon(0.01));
        // Nearly all of a map at its maximum, or at 0.
        CHECK(wfog::mean_coarseness(scale, Grid<float>::Constant(4, 4, float(most))) ==
              doctest::Approx(std::log2(coarseness)));
        CHECK(wfog::mean_coarseness(scale, Grid<float>::Zero(4, 4)) == 0);
        // Half a step at most from any density.
        for (int i = 0; i <= 1000; ++i) {
            const auto density = float(most * i / 1000);
            const std::int32_t k = *scale.integer(density);
            CHECK(std::fabs(double(scale.density(k)) - double(density)) <=
                  0.51 * step_at(scale, k) + 2e-7);
        }
    }
}

TEST_CASE("companding: rows of densities and integers are those of single ones") {
    test::Random random(20261123);
    const Scale scale = wfog::companded_scale(1e-5, 12, 4);
    std::vector<float> densities(1003), back(densities.size());
    for (float& density : densities) density = float(random.uniform(0, 4) * random.uniform(0, 1));
    densities[17] = 0;
    std::vector<std::int32_t> integers(densities.size());
    CHECK(scale.integers(densities.data(), densities.size(), integers.data()));
    scale.densities(integers.data(), integers.size(), back.data());
    for (std::size_t i = 0; i < densities.size(); ++i) {
        CHECK(integers[i] == *scale.integer(densities[i]));
        CHECK(back[i] == scale.density(integers[i]));
    }
    densities[5] = 1e30f;
    densities[6] = std::nanf("");
    CHECK_FALSE(scale.integers(densities.data(), densities.size(), integers.data()));
}

}  // namespace wavefog
