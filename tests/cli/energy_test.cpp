#include "energy.h"

#include <doctest/doctest.h>

#include <cmath>
#include <numeric>

#include "support/maps.h"
#include "wavefog/wavelet/bspline.h"

using namespace wavefog;

namespace {

/// Integral of the squared spline surface, by midpoint sums over a fine grid: independent of the
/// Gram matrix.
double squared_norm_by_sampling(const Band<float>& band, int degree) {
    constexpr int steps = 40;
    double sum = 0;
    for (int j = 0; j < (band.height() + degree) * steps; ++j)
        for (int i = 0; i < (band.width() + degree) * steps; ++i) {
            const double u = (i + 0.5) / steps, v = (j + 0.5) / steps;
            double value = 0;
            for (int b = 0; b < band.height(); ++b)
                for (int a = 0; a < band.width(); ++a)
                    value +=
                        double(band.values(b, a)) * bspline(degree, u - a) * bspline(degree, v - b);
            sum += value * value;
        }
    return sum / (steps * steps);
}

}  // namespace

TEST_CASE("the norm of a spline surface is its integral") {
    test::Random random(4711);
    for (const int degree : {0, 1, 2}) {
        const Band<float> band{test::make_map<float>(test::MapKind::random, 3, 2, random), -1, 0};
        const double expected = squared_norm_by_sampling(band, degree);
        // The midpoint rule errs by about 1/(24 * 40^2) of the second derivative.
        CHECK(cli::squared_norm(band, degree, Boundary::zero) ==
              doctest::Approx(expected).epsilon(1e-3));
    }
}

TEST_CASE("a repeated constant has its square as norm, whatever the period") {
    for (const int degree : {0, 1, 2, 3})
        for (const int side : {1, 2, 3, 8}) {
            Band<float> band;
            band.values = Grid<float>::Constant(side, side, 0.5f);
            CHECK(cli::squared_norm(band, degree, Boundary::repeat) ==
                  doctest::Approx(0.25 * side * side).epsilon(1e-12));
        }
}

TEST_CASE("energy shares add up and follow the map") {
    test::Random random(4712);
    const auto shares_of = [&](test::MapKind kind, int degree, Boundary boundary) {
        const auto map = test::make_map<float>(kind, 32, 32, random);
        const auto d =
            decompose(map, default_family(degree, Form::wavelet), 3, Form::wavelet, boundary);
        REQUIRE(d);
        return cli::energy_shares(*d);
    };
    for (const int degree : {0, 1, 2}) {
        const auto constant = shares_of(test::MapKind::constant, degree, Boundary::repeat);
        REQUIRE(constant.size() == 4);
        CHECK(constant[0] == doctest::Approx(1));
        const auto noise = shares_of(test::MapKind::random, degree, Boundary::zero);
        CHECK(std::accumulate(noise.begin(), noise.end(), 0.0) == doctest::Approx(1));
    }
    // A checkerboard has its mean and its finest details, nothing between.
    const auto checkerboard = shares_of(test::MapKind::checkerboard, 0, Boundary::repeat);
    CHECK(checkerboard[0] == doctest::Approx(0.5));
    CHECK(checkerboard[1] == doctest::Approx(0));
    CHECK(checkerboard[2] == doctest::Approx(0));
    CHECK(checkerboard[3] == doctest::Approx(0.5));
    const auto empty =
        decompose<float>(Grid<float>::Zero(4, 4), default_family(1, Form::wavelet), 1);
    REQUIRE(empty);
    CHECK(cli::energy_shares(*empty) == std::vector<double>{0, 0});
}

TEST_CASE("energy shares do not depend on the form") {
    test::Random random(4713);
    const auto map = test::make_map<float>(test::MapKind::smooth, 31, 17, random);
    const auto wavelet = decompose(map, {Family::Kind::cdf, 1, 2}, 3);
    REQUIRE(wavelet);
    const auto a = cli::energy_shares(*wavelet), b = cli::energy_shares(to_scaling_form(*wavelet));
    for (std::size_t l = 0; l < a.size(); ++l) CHECK(a[l] == doctest::Approx(b[l]).epsilon(1e-6));
}
