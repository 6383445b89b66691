#include "radial_wedge.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "wavefog/wavelet/cell.h"

namespace wavefog {
namespace {

using Eigen::Vector2d;

// What float32 does to a column's direction, radians, and to places, cells and parts of the way.
constexpr double kDirection = 1e-6, kPlace = 1e-5, kPlacePart = 0x1p-22;
// Texture units may weigh texels in steps of 1/256; float32 coordinates add a little.
constexpr double kWeight = 1.0 / 400;
constexpr double kWidest = 0.2;  // radians
// A column in double goes no farther than this optical depth where nothing behind it counts.
constexpr double kFarEnough = 20;

struct Interval {
    double low, high;
    double largest() const { return std::max(-low, high); }
};
Interval operator*(double a, const Interval& b) {
    return a < 0 ? Interval{a * b.high, a * b.low} : Interval{a * b.low, a * b.high};
}
Interval operator+(const Interval& a, const Interval& b) {
    return {a.low + b.low, a.high + b.high};
}

int cell_of(double u) {
    return static_cast<int>(std::floor(u));
}

}  // namespace

/// A wedge's two rays.
struct RadialWedges::Sides {
    Vector2d ray[2], middle;  ///< unit vectors (x, z)
    double angle = 0;         ///< between them
    // A step of the azimuth coordinate squared over 8, times the largest squared first and second
    // derivative of the angle: (h^2 / 8) |f''|.
    double curving = 0, turning = 0;
    double kinking = 0;  ///< (h / 4) of the same
    bool fan = false;    ///< rays beside one column
};

/// Over the parts of a stretch.
struct RadialWedges::Sum {
    double angular = 0;
    double low = std::numeric_limits<double>::infinity(), high = 0, slope = 0;
};

RadialWedges::RadialWedges(const CellRanges& ranges, const DetailBound& dropped,
                           const shader::RadialBlock& block, const Vector2d& eye, int layer,
                           double stops)
    : ranges_(ranges),
      dropped_(dropped),
      block_(block),
      eye_(eye),
      cell_(static_cast<double>(block.cell.x), static_cast<double>(block.cell.y)),
      layer_(layer),
      start_(static_cast<double>(block.radius.x)),
      stops_(stops) {
    const double per_row = static_cast<double>(block.rows.x);
    const double root0 = 2 * static_cast<double>(block.radius.w);
    for (int row = 0; row < block.size.y; ++row) {
        const double root = per_row * row;
        distance_.push_back(root * (root + root0));
    }
}

// The inverse of radial_coordinate() of fog_radial.glsl.
double RadialWedges::angle(double a) const {
    const double bend = static_cast<double>(block_.axis.z), quarter = 2 / (1 + bend);
    const double turns = block_.axis.w != 0 ? std::floor(a / quarter + 0.5) : 0;
    const double q = a - turns * quarter;
    return std::atan(2 * q / (1 + std::sqrt(std::max(1 - 4 * bend * q * q, 0.0)))) +
           turns * std::numbers::pi / 2;
}

// |d angle / da| and |d^2 angle / da^2| from a to b, at most. a = s / (1 + bend s^2), and with
// y = s^2 the derivative of a by the angle is (1 - bend y) (1 + y) / (1 + bend y)^2.
Vector2d RadialWedges::largest_slopes(double a, double b) const {
    const double bend = static_cast<double>(block_.axis.z), quarter = 2 / (1 + bend);
    const auto turns = [&](double c) {
        return block_.axis.w != 0 ? std::floor(c / quarter + 0.5) : 0.0;
    };
    const auto square = [&](double c) {
        const double q = c - turns(c) * quarter;
        const double s = 2 * q / (1 + std::sqrt(std::max(1 - 4 * bend * q * q, 0.0)));
        return std::pair(s, s * s);
    };
    const auto [s0, y0] = square(a);
    const auto [s1, y1] = square(b);
    const bool turned = turns(a) != turns(b);
    const double low = !turned && s0 * s1 < 0 ? 0 : std::min(y0, y1);
    const double high = turned ? 1 : std::max(y0, y1);
    const double least = (1 - bend * high) * (1 + low) / std::pow(1 + bend * high, 2);
    const auto rise = [&](double y) { return std::abs(1 - 3 * bend - bend * (3 - bend) * y); };
    const double bending = std::max(rise(low), rise(high)) / std::pow(1 + bend * low, 3) * 2 *
                           std::sqrt(high) * (1 + high);
    return {1 / least, bending / std::pow(least, 3)};
}

Vector2d RadialWedges::direction(double angle) const {
    const Vector2d axis(static_cast<double>(block_.axis.x), static_cast<double>(block_.axis.y));
    return (std::cos(angle) * axis + std::sin(angle) * Vector2d(-axis.y(), axis.x())).normalized();
}

bool RadialWedges::narrow() const {
    const double first = static_cast<double>(block_.azimuth.x);
    const double step = static_cast<double>(block_.azimuth.y);
    return block_.size.x > 1 && largest_slopes(first, first + step)[0] * step < kWidest &&
           step < kWidest;
}

RadialWedges::Sides RadialWedges::sides(int wedge) const {
    const double step = static_cast<double>(block_.azimuth.y);
    const auto coordinate = [&](int i) { return static_cast<double>(block_.azimuth.x) + step * i; };
    Sides sides;
    double from, to;
    if (wedge < 0 || wedge >= block_.size.x - 1) {
        sides.fan = true;
        const double at = angle(coordinate(std::max(wedge, 0)));
        from = at - kDirection;
        to = at + kDirection;
    } else {
        const double a = coordinate(wedge), b = coordinate(wedge + 1);
        from = angle(a);
        to = angle(b);
        const Vector2d slopes = largest_slopes(a, b);
        sides.curving = std::pow(step * slopes[0], 2) / 8;
        sides.turning = step * step * slopes[1] / 8;
        sides.kinking = step * slopes[0] / 4;
    }
    sides.angle = std::max(to - from, 0.0);
    sides.ray[0] = direction(from);
    sides.ray[1] = direction(to);
    sides.middle = direction((from + to) / 2);
    return sides;
}

const RadialWedges::Column& RadialWedges::column(int i) {
    const int slot = i & 1;
    if (held_[slot] == i) return columns_[slot];
    held_[slot] = i;
    Column& column = columns_[slot];
    const double a =
        static_cast<double>(block_.azimuth.x) + static_cast<double>(block_.azimuth.y) * i;
    const Vector2d ray = direction(angle(a)), slope = ray.cwiseQuotient(cell_);
    column.a1.assign(distance_.size(), 0);
    column.a2.assign(distance_.size(), 0);
    column.exit = std::numeric_limits<double>::infinity();
    const Vector2d box(ranges_.cells_x(), ranges_.cells_z());
    Vector2d face, next;
    for (int k = 0; k < 2; ++k) {
        const double at = eye_[k] + start_ * slope[k];
        face[k] = slope[k] > 0 ? std::floor(at) + 1 : std::ceil(at) - 1;
        next[k] = slope[k] == 0 ? std::numeric_limits<double>::infinity()
                                : (face[k] - eye_[k]) / slope[k];
        if (slope[k] != 0 && !ranges_.repeat())
            column.exit =
                std::min(column.exit, ((slope[k] > 0 ? box[k] : 0.0) - eye_[k]) / slope[k]);
    }
    const GaussRule& rule = gauss_legendre(3);
    double at = start_, a1 = 0, a2 = 0;
    for (std::size_t row = 1; row < distance_.size(); ++row) {
        const double until = start_ + distance_[row];
        while (at < until && a1 < stops_ + kFarEnough) {
            const double to = std::min({next[0], next[1], until});
            const double d = to - at;
            if (d > 0) {
                const Vector2d middle = eye_ + (at + d / 2) * slope;
                const int x = cell_of(middle.x()), z = cell_of(middle.y());
                double sum = 0, moment = 0;
                for (std::size_t n = 0; n < rule.nodes.size(); ++n) {
                    const double density =
                        rule.weights[n] *
                        ranges_.value(x, z, eye_ + (at + d * rule.nodes[n]) * slope);
                    sum += density;
                    moment += density * (1 - rule.nodes[n]);
                }
                a2 += d * (a1 + d * moment);
                a1 += d * sum;
                at = to;
            }
            for (int k = 0; k < 2; ++k)
                if (next[k] <= at) {
                    face[k] += slope[k] > 0 ? 1 : -1;
                    next[k] = (face[k] - eye_[k]) / slope[k];
                }
        }
        column.a1[row] = a1;
        column.a2[row] = a2;
    }
    return column;
}

// The largest E_l that the table's level at a row reaches in a box of cells.
double RadialWedges::dropped(int row, const Vector2d& low, const Vector2d& high) const {
    int level = block_.size.w + layer_;
    while (level > 0 && row >= block_.level[level].x) --level;
    if (level >= dropped_.levels()) return 0;
    const Grid<float>& grid = dropped_.dropped(level);
    const Vector2d blocks = cell_.cwiseQuotient(Vector2d(dropped_.block_x(), dropped_.block_z()));
    float most = 0;
    const auto place = [&](int k, Eigen::Index count) {
        const int n = static_cast<int>(count);
        return ranges_.repeat() ? (k % n + n) % n : k;
    };
    for (int z = cell_of(low.y() * blocks.y()); z <= cell_of(high.y() * blocks.y()); ++z)
        for (int x = cell_of(low.x() * blocks.x()); x <= cell_of(high.x() * blocks.x()); ++x) {
            const int r = place(z, grid.rows()), c = place(x, grid.cols());
            if (r >= 0 && c >= 0 && r < grid.rows() && c < grid.cols())
                most = std::max(most, grid(r, c));
        }
    return static_cast<double>(most);
}

// One part of a wedge, at most a cell long. The error of interpolating a function f of the azimuth
// coordinate between columns h apart is at most its variation, and (h^2 / 8) |f''| + (h / 4) times
// the jumps of f'. With p across the ray, f = integral of rho dx has the variation integral of
// |rho_p| dA, and f'' by the angle is the integral of x^2 rho_pp - x rho_x.
void RadialWedges::add(const Sides& sides, int row, double from, double to, Sum& sum) const {
    const double outer = to / std::cos(sides.angle / 2);
    const double slack = kPlace + kPlacePart * to / cell_.minCoeff();
    Vector2d low = Vector2d::Constant(std::numeric_limits<double>::infinity()), high = -low;
    for (const Vector2d& ray : sides.ray)
        for (const double x : {from, outer}) {
            const Vector2d at = eye_ + x * ray.cwiseQuotient(cell_);
            low = low.cwiseMin(at);
            high = high.cwiseMax(at);
        }
    low.array() -= slack;
    high.array() += slack;
    const CellRange range =
        ranges_.of(cell_of(low.x()), cell_of(high.x()), cell_of(low.y()), cell_of(high.y()));
    const double d = to - from;
    sum.angular += dropped(row, low, high) * d;
    if (range.high == 0 && range.low == 0) {
        sum.low = std::min(sum.low, 0.0);
        return;
    }

    const Vector2d &ray = sides.middle, across(-ray.y(), ray.x());
    const Interval by_x{static_cast<double>(range.x_low), static_cast<double>(range.x_high)};
    const Interval by_z{static_cast<double>(range.z_low), static_cast<double>(range.z_high)};
    const double aside = sides.angle / 2;  // the wedge's rays are no farther from its middle
    const double turned = aside * (by_x.largest() + by_z.largest());
    const double slope = (ray.x() * by_x + ray.y() * by_z).largest() + turned;
    sum.slope = std::max(sum.slope, slope);

    const double skew = (across.x() * by_x + across.y() * by_z).largest() + turned;

    double least = static_cast<double>(range.low), most = static_cast<double>(range.high);
    if (ranges_.degree() > 0) {
        // In a small part of a cell the density stays near its middle's.
        const Vector2d middle = eye_ + (from + to) / 2 * ray.cwiseQuotient(cell_);
        const double value = ranges_.value(cell_of(middle.x()), cell_of(middle.y()), middle);
        const double off = slope * d / 2 + skew * to * aside +
                           slack * cell_.maxCoeff() * (by_x.largest() + by_z.largest());
        least = std::max(least, value - off);
        most = std::min(most, value + off);
    }
    sum.low = std::min(sum.low, least);
    sum.high = std::max(sum.high, most);

    // Lines of constant x and z: how far a ray's crossing moves along it, at most.
    const int degree = ranges_.degree();
    const bool own = block_.edge.w != 0 && !sides.fan;
    const double width = to * (own && degree == 0 ? 2 * kDirection : sides.angle + 2 * kDirection) +
                         2 * slack * cell_.maxCoeff();
    // The ray's parts across and along such a line.
    const auto crossing = [&](double normal, double along) {
        const double across = std::abs(normal) - aside;
        const double whole = std::abs(along) <= aside ? 2 * d : d;
        return across > 0 ? std::min(width * (std::abs(along) + aside) / across, whole) : whole;
    };
    const double lines_x = range.jump_x > 0 ? crossing(ray.x(), ray.y()) : 0;
    const double lines_z = range.jump_z > 0 ? crossing(ray.y(), ray.x()) : 0;
    const double jump_x = static_cast<double>(range.jump_x) * lines_x;
    const double jump_z = static_cast<double>(range.jump_z) * lines_z;

    const double oscillation = (most - least) * d;
    double variation = oscillation, error = oscillation;
    if (degree == 0) {
        variation = std::min(jump_x + jump_z, oscillation);
        error = variation;
    } else {
        variation = std::min(sides.angle * to * skew * d, oscillation);
        const double px = std::abs(across.x()) + aside, pz = std::abs(across.y()) + aside;
        const double curved = px * px * static_cast<double>(range.xx) +
                              2 * px * pz * static_cast<double>(range.xz) +
                              pz * pz * static_cast<double>(range.zz);
        error = sides.curving * to * (to * curved + slope) * d + sides.turning * to * skew * d +
                sides.kinking * to * (px * jump_x + pz * jump_z);
        error = std::min(error, variation);
    }
    if (sides.fan) {
        sum.angular += variation;
        return;
    }
    const double leak = kWeight + 2 * kDirection / std::max(sides.angle, kDirection);
    sum.angular += (own && degree > 0 ? 0 : error) + std::min(leak, 1.0) * variation;
}

void RadialWedges::walk(int wedge,
                        const std::function<bool(const RadialStretch&, double exit)>& visit) {
    const Sides sides = this->sides(wedge);
    const Column& a = column(std::max(wedge, 0));
    const Column& b = sides.fan ? a : column(wedge + 1);
    const double exit = std::max(std::min(a.exit, b.exit) * std::cos(sides.angle), start_);
    const double cell = cell_.minCoeff();
    double angular = 0, angular_2 = 0;
    for (std::size_t j = 0; j + 1 < distance_.size(); ++j) {
        RadialStretch s;
        s.row = static_cast<int>(j);
        s.near = distance_[j];
        s.far = distance_[j + 1];
        const double d = s.far - s.near;
        const int parts = std::max(1, static_cast<int>(std::ceil(d / cell)));
        Sum sum;
        for (int part = 0; part < parts; ++part)
            add(sides, s.row + 1, start_ + s.near + d * part / parts,
                start_ + s.near + d * (part + 1) / parts, sum);
        s.angular_near = angular;
        s.angular = angular + sum.angular;
        s.density_low = sum.low;
        s.density_high = sum.high;
        s.slope = ranges_.degree() > 0 ? sum.slope : std::numeric_limits<double>::infinity();
        s.mass_low =
            std::max(std::min(a.a1[j + 1] - a.a1[j], b.a1[j + 1] - b.a1[j]) - sum.angular, 0.0);
        s.low = std::max(std::min(a.a1[j], b.a1[j]) - angular, 0.0);
        s.low_2 = std::max(std::min(a.a2[j], b.a2[j]) - angular_2, 0.0);
        s.high = std::max(a.a1[j + 1], b.a1[j + 1]) + s.angular;
        s.high_2 = std::max(a.a2[j + 1], b.a2[j + 1]) + angular_2 + s.angular * d;
        s.missing = std::max(std::max(a.a1[j + 1], b.a1[j + 1]) - stops_, 0.0);

        // rho = its mean over the stretch and a rest, whose integral vanishes at both ends and is
        // at most `rest` between. The means are of 1 / L and 1 / L^2 and of that rest.
        const double oscillation = sum.high - sum.low;
        const bool smooth = ranges_.degree() > 0;
        const double rest =
            smooth ? std::min(oscillation / 4, sum.slope * d / 8) * d : oscillation * d / 4;
        const double uneven = smooth ? std::min(oscillation, sum.slope * d / 2) : oscillation;
        if (j == 0) {
            s.radial = uneven * d / 4 + rest + kWeight * oscillation * d + sum.angular;
            s.radial_2 =
                (uneven * 2 / 27 + kWeight * oscillation) * d * d + rest * d + s.angular * d;
            s.relative = uneven + kWeight * oscillation + s.angular / d;
        } else {
            const double near = s.near, far = s.far, by_one = d * d / (4 * near * far);
            const double by_two = 2 * by_one + by_one * by_one + d * d / (4 * near * near);
            const double high = std::max(a.a1[j], b.a1[j]) + angular;
            const double high_2 = std::max(a.a2[j], b.a2[j]) + angular_2;
            const double one = std::max(high - sum.low * near, sum.high * near - s.low);
            const double two = std::max(high_2 - s.low * near + sum.high * near * near / 2,
                                        high * near - s.low_2 - sum.low * near * near / 2);
            s.radial = one * (by_one + kWeight * d / near) + rest + (1 + by_one) * sum.angular +
                       by_one * s.angular;
            s.radial_2 = two * (by_two + kWeight * (far * far / (near * near) - 1)) +
                         one * far * (by_one + kWeight * d / near) + rest * d +
                         s.angular * ((1 + by_two) * d + by_two * far);
        }
        angular_2 += s.angular * d;
        angular = s.angular;
        if (!visit(s, exit)) return;
    }
}

}  // namespace wavefog
