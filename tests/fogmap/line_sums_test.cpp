// What a field adds up to along lines, against integrals along single ones.
#include "wfog/line_sums.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "support/random.h"

namespace wavefog {
namespace {

using wfog::LineField;

double b_spline(int degree, double x) {
    const double d = std::fabs(x);
    if (degree == 0) return x >= -0.5 && x < 0.5 ? 1 : 0;
    if (degree == 1) return std::max(1 - d, 0.0);
    return d < 0.5 ? 0.75 - d * d : d < 1.5 ? (1.5 - d) * (1.5 - d) / 2 : 0;
}

/// At a place in cells, pixel (0, 0) at 0.
double value_at(const LineField& field, double x, double z) {
    const Eigen::Index width = field.pixels.cols(), height = field.pixels.rows();
    const auto i0 = static_cast<Eigen::Index>(std::floor(x)) - 1;
    const auto j0 = static_cast<Eigen::Index>(std::floor(z)) - 1;
    double sum = 0;
    for (Eigen::Index j = j0; j < j0 + 4; ++j)
        for (Eigen::Index i = i0; i < i0 + 4; ++i) {
            const bool inside = i >= 0 && j >= 0 && i < width && j < height;
            const double pixel =
                field.repeats
                    ? double(field.pixels((j % height + height) % height,
                                          (i % width + width) % width))
                    : double(inside ? field.pixels(j, i) : field.outside);
            sum += pixel * b_spline(field.degree, x - double(i)) *
                   b_spline(field.degree, z - double(j));
        }
    return sum;
}

/// A segment in cells.
struct Segment {
    double x, z, angle, cells;
};

/// By midpoints; for degree 0, whose pixels have edges, off by a sample for each of them.
double integral(const LineField& field, const Segment& segment, int samples_a_cell) {
    const double ux = std::cos(segment.angle), uz = std::sin(segment.angle);
    const int count = std::max(int(std::ceil(segment.cells * samples_a_cell)), 1);
    double sum = 0;
    for (int k = 0; k < count; ++k) {
        const double at = (k + 0.5) / count * segment.cells;
        sum += value_at(field, segment.x + at * ux, segment.z + at * uz);
    }
    return sum / count * segment.cells * std::hypot(ux * field.cell_x, uz * field.cell_z);
}

double metres(const LineField& field, const Segment& segment) {
    return segment.cells * std::hypot(std::cos(segment.angle) * field.cell_x,
                                      std::sin(segment.angle) * field.cell_z);
}

/// The largest integral that random segments and then changes of the best of them find.
double largest_found(const LineField& field, double longest, test::Random& random) {
    const double width = double(field.pixels.cols()), height = double(field.pixels.rows());
    const double all = std::hypot(width, height);
    const auto shorter = [&](Segment s) {
        const double length = metres(field, s);
        if (length > longest) s.cells *= longest / length;
        return s;
    };
    double best = 0;
    Segment at{};
    for (int k = 0; k < 4000; ++k) {
        Segment s{random.uniform(-1, width), random.uniform(-1, height),
                  random.uniform(0, 2 * std::numbers::pi), all * random.uniform(0, 1)};
        // Along rows, columns and diagonals, through pixels, as well.
        if (k % 3 == 0) {
            s.angle = std::numbers::pi / 4 * random.integer(0, 7);
            s.x = std::round(s.x);
            s.z = std::round(s.z);
        }
        if (field.repeats && k % 2 == 0) s.cells = HUGE_VAL;
        if (!std::isfinite(s.cells)) s.cells = longest / std::min(field.cell_x, field.cell_z);
        s = shorter(s);
        if (const double sum = integral(field, s, 4); sum > best) {
            best = sum;
            at = s;
        }
    }
    best = integral(field, at, 16);
    for (int k = 0; k < 1500; ++k) {
        const double reach = std::exp(-k / 250.0);
        Segment s = at;
        const double middle = s.cells / 2;
        // Turned about its middle, moved, longer or shorter.
        s.x += middle * std::cos(s.angle) + reach * random.uniform(-1, 1);
        s.z += middle * std::sin(s.angle) + reach * random.uniform(-1, 1);
        s.angle += reach * random.uniform(-1, 1) / (1 + middle);
        s.cells = std::max(s.cells + 3 * reach * random.uniform(-1, 1), 0.1);
        s.x -= s.cells / 2 * std::cos(s.angle);
        s.z -= s.cells / 2 * std::sin(s.angle);
        s = shorter(s);
        if (const double sum = integral(field, s, 16); sum > best) {
            best = sum;
            at = s;
        }
    }
    return integral(field, at, 64);
}

double bound(const LineField& field, double longest, int parts) {
    return wfog::most_along_lines({&field, 1}, longest, parts, 1, {});
}

}  // namespace

TEST_CASE("line sums: no segment through a random field adds up to more") {
    test::Random random(20261201);
    for (int round = 0; round < 60; ++round) {
        const int width = random.integer(1, 50), height = random.integer(1, 50);
        const double price = random.integer(0, 2) * 0.15;
        Grid<float> pixels(height, width);
        for (Eigen::Index i = 0; i < pixels.size(); ++i)
            pixels.data()[i] = float(random.uniform(-1, 1) - price);
        const LineField field{.pixels = pixels,
                              .outside = -float(price),
                              .repeats = random.integer(0, 1) > 0,
                              .degree = random.integer(0, 2),
                              .cell_x = random.integer(0, 1) > 0 ? 1 : random.uniform(0.3, 3),
                              .cell_z = 1};
        const double longest = random.uniform(0.5, 90);
        const int parts = random.integer(1, 4);
        const double truth = largest_found(field, longest, random);
        const double found = bound(field, longest, parts);
        CAPTURE(width);
        CAPTURE(height);
        CAPTURE(price);
        CAPTURE(field.repeats);
        CAPTURE(field.degree);
        CAPTURE(field.cell_x);
        CAPTURE(longest);
        CAPTURE(parts);
        // 64 samples a cell: edges of pixels are off by less than that.
        CHECK(found >= truth * (field.degree == 0 ? 0.97 : 0.9999));
    }
}

TEST_CASE("line sums: what is alike along any one line counts in full") {
    test::Random random(20261202);
    constexpr int side = 120;
    for (int round = 0; round < 24; ++round) {
        // A streak a pixel wide at a random angle, through noise of a mean of 0.
        const double angle = random.uniform(0, std::numbers::pi);
        const double ux = std::cos(angle), uz = std::sin(angle);
        const double x = random.uniform(40, 80), z = random.uniform(40, 80);
        Grid<float> pixels(side, side);
        for (int j = 0; j < side; ++j)
            for (int i = 0; i < side; ++i) {
                const double off = std::fabs((i - x) * uz - (j - z) * ux);
                pixels(j, i) = off <= 0.6 ? 1.0f : float(random.uniform(-1, 1));
            }
        const double longest = random.uniform(20, 70);
        constexpr double price = 0.4;  // keeps segments from being longer
        pixels -= float(price);
        const LineField field{pixels, -float(price), false, 1, 1, 1};
        const Segment along{x - longest / 2 * ux, z - longest / 2 * uz, angle, longest};
        const double truth = integral(field, along, 64);
        CAPTURE(angle);
        CAPTURE(longest);
        for (const int parts : {1, 2, 4}) {
            const double found = bound(field, longest, parts);
            CHECK(found >= truth);
            // The streak crosses the whole map, and noise is not always against the price.
            const double whole = 120 / std::max(std::fabs(ux), std::fabs(uz)) * (1 - price);
            CHECK(found <= 1.3 * whole + 10);
        }
    }
}

TEST_CASE("line sums: the pixels of one line alone, all others far below") {
    test::Random random(20261204);
    constexpr int side = 150;
    for (int round = 0; round < 40; ++round) {
        // Pixels that a line of any slope crosses in each column, for degree 0.
        const double slope = random.uniform(0, 1), start = random.uniform(0, 3);
        Grid<float> pixels = Grid<float>::Constant(side, side, -30.0f);
        int crossed = 0;
        for (int i = 0; i < side; ++i)
            if (const double z = start + slope * i + 0.5; z < side) {
                pixels(int(z), i) = 1;
                ++crossed;
            }
        CAPTURE(slope);
        CAPTURE(start);
        for (const int parts : {1, 2, 3, 4})
            for (const bool transposed : {false, true}) {
                const Grid<float> turned = pixels.transpose();
                const LineField field{transposed ? turned : pixels, -30, false, 0, 1, 1};
                CHECK(bound(field, 1e3, parts) >= crossed * std::hypot(1, slope) * (1 - 1e-6));
            }
    }
    for (const int apart : {3, 5, 7, 9, 11, 13})
        for (const int climb : {1, 2}) {
            // A line over the middles of pixels, `apart` columns from one another.
            Grid<float> pixels = Grid<float>::Zero(side, side);
            for (int i = 0; i < side; i += apart) {
                pixels.col(i) = -3;
                pixels(i / apart * climb + 1, i) = 1;
            }
            const LineField field{pixels, -3, false, 1, 1, 1};
            const double slope = double(climb) / apart;
            const Segment along{0, 1, std::atan(slope), (side - 1) * std::hypot(1, slope)};
            const double truth = integral(field, along, 64);
            CAPTURE(apart);
            CAPTURE(climb);
            for (const int parts : {1, 2, 3, 4}) CHECK(bound(field, 1e3, parts) >= truth);
        }
}

TEST_CASE("line sums: a field that is the same everywhere, exactly") {
    for (const bool repeats : {false, true})
        for (const int degree : {0, 1, 2})
            for (const double cell : {1.0, 2.5}) {
                const Grid<float> pixels = Grid<float>::Constant(64, 64, 0.5f);
                const LineField field{pixels, 0, repeats, degree, cell, 1};
                const double found = bound(field, 1e3, 2);
                if (repeats) {
                    CHECK(found >= 500);
                } else {
                    // From corner to corner.
                    CHECK(found >= 0.5 * 63 * std::hypot(cell, 1));
                    CHECK(found <= 0.5 * 65 * std::hypot(cell, 1));
                }
                const Grid<float> below = -pixels;
                CHECK(bound({below, -0.5f, repeats, degree, cell, 1}, 1e3, 2) <= 0.1);
            }
}

TEST_CASE("line sums: more parts of a cell bound white noise closer") {
    test::Random random(20261203);
    constexpr int side = 200;
    Grid<float> pixels(side, side);
    for (const double longest : {30.0, 150.0}) {
        const double price = 1.4 / std::sqrt(longest);
        for (Eigen::Index i = 0; i < pixels.size(); ++i)
            pixels.data()[i] = float(random.uniform(-1, 1) - price);
        const LineField field{pixels, -float(price), false, 1, 1, 1};
        const double truth = largest_found(field, longest, random) + price * longest;
        const double whole = bound(field, longest, 1) + price * longest;
        const double halves = bound(field, longest, 2) + price * longest;
        const double quarters = bound(field, longest, 4) + price * longest;
        CAPTURE(longest);
        CHECK(quarters < halves);
        CHECK(halves < whole);
        // The search finds one of the larger segments, not the largest of 1e9.
        CHECK(quarters <= truth * 2);
    }
}

}  // namespace wavefog
