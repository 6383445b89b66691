#include "wavefog/wavelet/cell.h"

#include <doctest/doctest.h>

#include <cmath>

#include "fields.h"
#include "support/random.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

Band<double> random_band(int width, int height, int start_x, int start_z, Random& random) {
    Band<double> band{Grid<double>(height, width), start_x, start_z};
    for (double& value : band.values.reshaped()) value = random.uniform();
    return band;
}

double evaluate(const std::vector<double>& polynomial, int degree, double u, double v) {
    double value = 0;
    for (int m = degree; m >= 0; --m) {
        double row = 0;
        for (int n = degree; n >= 0; --n)
            row = row * u + polynomial[static_cast<std::size_t>(m * (degree + 1) + n)];
        value = value * v + row;
    }
    return value;
}

std::size_t terms(int degree) {
    return static_cast<std::size_t>((degree + 1) * (degree + 1));
}

}  // namespace

TEST_CASE("Gauss-Legendre rules are exact to degree 2n - 1, and not beyond") {
    for (int n = 1; n <= 64; ++n) {
        const GaussRule& rule = gauss_legendre(n);
        REQUIRE(rule.nodes.size() == static_cast<std::size_t>(n));
        double before = 0;
        for (const double node : rule.nodes) {
            CHECK(node > before);
            CHECK(node < 1);
            before = node;
        }
        const auto moment = [&](int power) {
            double sum = 0;
            for (std::size_t i = 0; i < rule.nodes.size(); ++i)
                sum += rule.weights[i] * std::pow(rule.nodes[i], power);
            return sum;
        };
        // n roundings of terms that sum to at most 1.
        for (int power = 0; power < 2 * n; ++power)
            CHECK(std::abs(moment(power) - 1.0 / (power + 1)) <= 1e-15 * (2 + n));
        if (n <= 10)  // later the first wrong moment falls below rounding
            CHECK(std::abs(moment(2 * n) - 1.0 / (2 * n + 1)) > 1e-13);
    }
}

TEST_CASE("A cell's polynomial is the field inside it, zero extension") {
    Random random(41);
    for (int degree = 0; degree <= 6; ++degree) {
        const Band<double> band = random_band(5, 4, -2, 1, random);
        std::vector<double> polynomial(terms(degree));
        for (int cz = -1; cz <= 5 + degree; ++cz)
            for (int cx = -4; cx <= 4 + degree; ++cx) {
                cell_polynomial(band, degree, Boundary::zero, cx, cz, polynomial.data());
                const double u = random.uniform(), v = random.uniform();
                // Monomial coefficients reach ((d+1)^d / d!)^2 = 545 at degree 6.
                CHECK(std::abs(evaluate(polynomial, degree, u, v) -
                               scaling_field(band, degree, 1, cx + u, cz + v)) <= 1e-12);
            }
    }
}

TEST_CASE("A cell's polynomial wraps with repeat, also where the map is smaller than the spline") {
    Random random(42);
    for (int degree = 0; degree <= 3; ++degree)
        for (const auto& [width, height] : {std::pair{5, 3}, {1, 2}}) {
            const Band<double> band = random_band(width, height, 0, 0, random);
            Band<double> tiled{Grid<double>(7 * height, 7 * width), -3 * width, -3 * height};
            for (int j = 0; j < tiled.height(); ++j)
                for (int i = 0; i < tiled.width(); ++i)
                    tiled.values(j, i) = band.values(j % height, i % width);
            std::vector<double> polynomial(terms(degree));
            for (int cz = 0; cz < height; ++cz)
                for (int cx = 0; cx < width; ++cx) {
                    cell_polynomial(band, degree, Boundary::repeat, cx, cz, polynomial.data());
                    const double u = random.uniform(), v = random.uniform();
                    CHECK(std::abs(evaluate(polynomial, degree, u, v) -
                                   scaling_field(tiled, degree, 1, cx + u, cz + v)) <= 1e-13);
                }
        }
}

TEST_CASE("cell_polynomials lists the cells row by row") {
    Random random(43);
    const Band<float> band{random_band(6, 5, -1, -1, random).values.cast<float>(), -1, -1};
    for (int degree = 0; degree <= 3; ++degree) {
        const int cells_x = 5 + degree, cells_z = 4 + degree;
        const auto all = cell_polynomials(band, degree, Boundary::zero, cells_x, cells_z);
        REQUIRE(all.size() == static_cast<std::size_t>(cells_x * cells_z) * terms(degree));
        std::vector<double> one(terms(degree));
        for (int cz = 0; cz < cells_z; ++cz)
            for (int cx = 0; cx < cells_x; ++cx) {
                cell_polynomial(band, degree, Boundary::zero, cx, cz, one.data());
                for (std::size_t t = 0; t < one.size(); ++t)
                    CHECK(all[static_cast<std::size_t>(cz * cells_x + cx) * terms(degree) + t] ==
                          static_cast<float>(one[t]));
            }
    }
}

TEST_CASE("segment_mean equals Gauss-Legendre with d + 1 nodes") {
    Random random(44);
    for (int degree = 0; degree <= 8; ++degree) {
        const GaussRule& rule = gauss_legendre(degree + 1);
        for (int trial = 0; trial < 200; ++trial) {
            std::vector<double> polynomial(terms(degree));
            double size = 0;
            for (double& c : polynomial) size += std::abs(c = random.uniform(-1, 1));
            const double u0 = random.uniform(), v0 = random.uniform();
            double u1 = random.uniform(), v1 = random.uniform();
            if (trial % 4 == 0) u1 = u0;          // axis-parallel
            if (trial % 8 == 0) v1 = v0;          // zero length
            if (trial % 5 == 0) v1 = v0 + 1e-13;  // nearly so
            double mean = 0;
            for (std::size_t i = 0; i < rule.nodes.size(); ++i)
                mean +=
                    rule.weights[i] * evaluate(polynomial, degree, u0 + rule.nodes[i] * (u1 - u0),
                                               v0 + rule.nodes[i] * (v1 - v0));
            CHECK(std::abs(segment_mean(polynomial.data(), degree, u0, v0, u1, v1) - mean) <=
                  1e-15 * (4 + size));
        }
    }
}

TEST_CASE("bspline_segment_mean equals fine midpoint sums of the tensor B-spline") {
    Random random(45);
    for (int degree = 0; degree <= 4; ++degree)
        for (int trial = 0; trial < 20; ++trial) {
            const double u0 = random.uniform(-1, degree + 2), v0 = random.uniform(-1, degree + 2);
            const double u1 = random.uniform(-1, degree + 2), v1 = random.uniform(-1, degree + 2);
            constexpr int steps = 4000;
            double sum = 0;
            for (int i = 0; i < steps; ++i) {
                const double s = (i + 0.5) / steps;
                sum += bspline(degree, u0 + s * (u1 - u0)) * bspline(degree, v0 + s * (v1 - v0));
            }
            // The midpoint rule is O(h) at the jumps of degree 0 and O(h^2) for the others.
            CHECK(std::abs(bspline_segment_mean(degree, u0, v0, u1, v1) - sum / steps) <=
                  (degree == 0 ? 3.0 / steps : 1e-6));
        }
    // Along a row of cells through the middle: the integral of phi_d is 1, its peak value is known.
    CHECK(bspline_segment_mean(1, 0, 1, 2, 1) == doctest::Approx(0.5));
    CHECK(bspline_segment_mean(2, 0, 1.5, 3, 1.5) == doctest::Approx(0.75 / 3));
    CHECK(bspline_segment_mean(2, 1.5, 1.5, 1.5, 1.5) == doctest::Approx(0.75 * 0.75));
    CHECK(bspline_segment_mean(2, -1, 0, -1, 3) == 0);
}
