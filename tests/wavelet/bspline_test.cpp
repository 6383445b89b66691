#include "wavefog/wavelet/bspline.h"

#include <doctest/doctest.h>

#include <cmath>

#include "support/random.h"
#include "wavefog/wavelet/cell.h"

using namespace wavefog;
using wavefog::test::Random;

// Values are sums of d + 1 products of numbers <= 1, so 1e-14 is dozens of roundings.
constexpr double kRounding = 1e-14;

TEST_CASE("B-splines of degree 0 to 3 have their textbook values") {
    CHECK(bspline(0, 0) == 1);
    CHECK(bspline(0, 1) == 0);
    CHECK(bspline(0, 0.999) == 1);
    CHECK(bspline(1, 1) == 1);
    CHECK(bspline(1, 0.25) == doctest::Approx(0.25));
    CHECK(bspline(2, 1.5) == doctest::Approx(0.75));
    CHECK(bspline(2, 1) == doctest::Approx(0.5));
    CHECK(bspline(3, 2) == doctest::Approx(2.0 / 3));
    CHECK(bspline(3, 1) == doctest::Approx(1.0 / 6));
    for (int d = 0; d <= 8; ++d) {
        CHECK(bspline(d, -1e-9) == 0);
        CHECK(bspline(d, d + 1) == 0);
    }
}

TEST_CASE("B-splines are a partition of unity, symmetric and non-negative") {
    Random random(11);
    for (int d = 0; d <= 12; ++d)
        for (int trial = 0; trial < 200; ++trial) {
            const double x = random.uniform();
            double sum = 0;
            for (int k = 0; k <= d; ++k) {
                const double value = bspline(d, x + k);
                CHECK(value >= 0);
                CHECK(value == doctest::Approx(bspline(d, d + 1 - (x + k))).epsilon(1e-12));
                sum += value;
            }
            CHECK(std::abs(sum - 1) <= kRounding);
        }
}

TEST_CASE("B-splines obey the two-scale relation with taps of sum 2") {
    Random random(12);
    for (int d = 0; d <= 10; ++d) {
        const auto p = two_scale(d);
        REQUIRE(p.size() == static_cast<std::size_t>(d + 2));
        double sum = 0;
        for (const double tap : p) sum += tap;
        CHECK(sum == 2);  // exact: dyadic fractions
        for (int trial = 0; trial < 100; ++trial) {
            const double x = random.uniform(-0.5, d + 1.5);
            double refined = 0;
            for (int k = 0; k <= d + 1; ++k)
                refined += p[static_cast<std::size_t>(k)] * bspline(d, 2 * x - k);
            CHECK(std::abs(refined - bspline(d, x)) <= kRounding);
        }
    }
}

TEST_CASE("Polynomial pieces equal the recurrence") {
    Random random(13);
    for (int d = 0; d <= 10; ++d) {
        const Eigen::MatrixXd pieces = bspline_pieces(d);
        for (int p = 0; p <= d; ++p)
            for (int trial = 0; trial < 20; ++trial) {
                const double t = random.uniform();
                double value = 0;
                for (int n = d; n >= 0; --n) value = value * t + pieces(n, p);
                // Monomial terms cancel: they reach (d + 1)^d / d! times the sum.
                const double terms = std::pow(d + 1, d) / std::tgamma(d + 1);
                CHECK(std::abs(value - bspline(d, p + t)) <= kRounding * terms);
            }
    }
}

TEST_CASE("Integrals of B-splines equal Gauss-Legendre on each piece") {
    Random random(14);
    for (int d = 0; d <= 8; ++d) {
        CHECK(bspline_integral(d, -1) == 0);
        CHECK(bspline_integral(d, 0) == 0);
        CHECK(bspline_integral(d, d + 1) == 1);
        CHECK(bspline_integral(d, 1e300) == 1);
        const GaussRule& rule = gauss_legendre(d / 2 + 1);  // exact for the piece's degree
        for (int trial = 0; trial < 100; ++trial) {
            const double x = random.uniform(0, d + 1);
            double integral = 0;
            for (int p = 0; p < x; ++p) {
                const double length = std::min(1.0, x - p);
                for (std::size_t i = 0; i < rule.nodes.size(); ++i)
                    integral += length * rule.weights[i] * bspline(d, p + length * rule.nodes[i]);
            }
            CHECK(std::abs(integral - bspline_integral(d, x)) <= kRounding);
        }
    }
}
