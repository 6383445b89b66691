#include "wavefog/fogmap/models.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "separable.h"
#include "wavefog/wavelet/cell.h"

namespace wavefog {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A segment start + path t, t in [0, 1]. Every model gives its mean extinction over it.
struct Segment {
    Vector3d start, path;

    Segment part(double from, double to) const { return {start + from * path, (to - from) * path}; }
};

/// Where low <= from + slope t < high in [0, 1]; empty if end <= begin.
struct Range {
    double begin, end;
    double length() const { return std::max(end - begin, 0.0); }
};
Range clip(double from, double slope, double low, double high) {
    if (slope == 0) return from >= low && from < high ? Range{0, 1} : Range{0, 0};
    const double a = (low - from) / slope, b = (high - from) / slope;
    return {std::max(0.0, std::min(a, b)), std::min(1.0, std::max(a, b))};
}

/// Mean of exp(-z s) over s in [0, 1].
double mean_decay(double z) {
    return z == 0 ? 1 : -std::expm1(-z) / z;
}

double at(const Halfspace& fog, const Vector3d& x) {
    const double depth = fog.normal.dot(fog.point - x);
    return depth < 0 ? 0 : fog.extinction + fog.gradient * depth;
}

/// Eq. 5 and 13 of the halfspace paper, written with the depths a and b of the segment's ends
/// behind the plane, because both formulas there subtract nearly equal numbers where a long ray
/// leaves the fog at once: the part inside is sat(max(a, b) / |a - b|), and its mean depth
/// (max(a, 0) + max(b, 0)) / 2. In the plane (0 / 0 in the paper) the point counts as fogged.
double mean(const Halfspace& fog, const Segment& segment) {
    const double along = fog.normal.dot(segment.path);
    const double a = fog.normal.dot(fog.point - segment.start), b = a - along;
    const double inside =
        along == 0 ? (a >= 0 ? 1.0 : 0.0) : std::clamp(std::max(a, b) / std::abs(along), 0.0, 1.0);
    return inside * (fog.extinction + fog.gradient * (std::max(a, 0.0) + std::max(b, 0.0)) / 2);
}

/// -log of the transmittance that the fog's fraction has for the optical depth `tau`.
double apparent(const Halfspace& fog, double tau) {
    switch (fog.fraction) {
        case Halfspace::Fraction::exp:
            return tau;
        case Halfspace::Fraction::exp2:
            return tau * tau;
        case Halfspace::Fraction::linear:
            break;
    }
    const double fogged = std::max(tau - fog.extinction * fog.start, 0.0);
    return fogged < 1 ? std::min(-std::log1p(-fogged), Halfspace::kSaturated)
                      : Halfspace::kSaturated;
}

/// Piece i of a ramp lies below point i, the last one above all points.
struct RampPiece {
    double low, high, extinction, slope;  ///< extinction at y is extinction + slope (y - datum)
    double datum;
};
RampPiece ramp_piece(const Ramp& fog, std::size_t i) {
    const auto& points = fog.points;
    if (i == 0) return {-kInfinity, points[0].y, points[0].extinction, 0, 0};
    const Ramp::Point& p = points[i - 1];
    if (i == points.size()) return {p.y, kInfinity, p.extinction, 0, 0};
    const Ramp::Point& q = points[i];
    return {p.y, q.y, p.extinction, (q.extinction - p.extinction) / (q.y - p.y), p.y};
}

double at(const Ramp& fog, const Vector3d& x) {
    for (std::size_t i = 0;; ++i) {
        const RampPiece piece = ramp_piece(fog, i);
        if (x.y() < piece.high || i == fog.points.size())
            return piece.extinction + piece.slope * (x.y() - piece.datum);
    }
}

double mean(const Ramp& fog, const Segment& segment) {
    const double y = segment.start.y(), rise = segment.path.y();
    double sum = 0;
    for (std::size_t i = 0; i <= fog.points.size(); ++i) {
        const RampPiece piece = ramp_piece(fog, i);
        const Range range = clip(y, rise, piece.low, piece.high);
        if (range.length() == 0) continue;
        const double middle = y + rise * (range.begin + range.end) / 2;
        sum += range.length() * (piece.extinction + piece.slope * (middle - piece.datum));
    }
    return sum;
}

double at(const ExponentialLayer& fog, const Vector3d& x) {
    return fog.extinction * std::exp(-std::max(x.y() - fog.base, 0.0) / fog.scale);
}

double mean(const ExponentialLayer& fog, const Segment& segment) {
    const double eta = (segment.start.y() - fog.base) / fog.scale;
    const double rise = std::abs(segment.path.y() / fog.scale);
    const double low = std::min(eta, eta + segment.path.y() / fog.scale);
    const double below = rise == 0 ? (low < 0 ? 1.0 : 0.0) : std::clamp(-low / rise, 0.0, 1.0);
    const double above = 1 - below;
    return fog.extinction *
           (below + above * std::exp(-std::max(low, 0.0)) * mean_decay(above * rise));
}

double at(const Cosines& fog, const Vector3d& x) {
    double sum = fog.extinction;
    for (const auto& wave : fog.waves)
        sum += wave.extinction * std::cos(wave.frequency * wave.direction.dot(x) + wave.phase);
    return sum;
}

/// The mean of a cosine from phase a to phase b is cos((a + b) / 2) sin(h) / h, h = (b - a) / 2:
/// no difference of nearly equal sines on slow rays.
double mean(const Cosines& fog, const Segment& segment) {
    double sum = fog.extinction;
    for (const auto& wave : fog.waves) {
        const double half = wave.frequency * wave.direction.dot(segment.path) / 2;
        const double middle =
            wave.frequency * wave.direction.dot(segment.start) + wave.phase + half;
        sum += wave.extinction * std::cos(middle) * (half == 0 ? 1 : std::sin(half) / half);
    }
    return sum;
}

double polynomial(const std::vector<double>& coefficients, double u) {
    double sum = 0;
    for (auto c = coefficients.rbegin(); c != coefficients.rend(); ++c) sum = sum * u + *c;
    return sum;
}

/// Mean of P from u = a to b inside one domain: five Gauss nodes are exact to degree 9.
double mean_polynomial(const std::vector<double>& coefficients, double a, double b) {
    const GaussRule& rule = gauss_legendre(5);
    double sum = 0;
    for (std::size_t i = 0; i < 5; ++i)
        sum += rule.weights[i] * polynomial(coefficients, a + (b - a) * rule.nodes[i]);
    return sum;
}

double at(const Polynomials::Term& term, const Vector3d& x) {
    double u = term.direction.dot(x - term.centre) / term.half_width;
    if (term.outside == Polynomials::Outside::repeat)
        u -= 2 * std::floor((u + 1) / 2);
    else if (u < -1 || u >= 1)
        return 0;
    return term.extinction * polynomial(term.coefficients, u);
}

/// Of a repeated domain: the part to its border, whole domains by their mean, and the rest.
double mean(const Polynomials::Term& term, const Segment& segment) {
    const auto& c = term.coefficients;
    double u = term.direction.dot(segment.start - term.centre) / term.half_width;
    const double du = term.direction.dot(segment.path) / term.half_width;
    if (term.outside == Polynomials::Outside::zero) {
        const Range range = clip(u, du, -1, 1);
        if (range.length() == 0) return 0;
        return term.extinction * range.length() *
               mean_polynomial(c, u + range.begin * du, u + range.end * du);
    }
    u -= 2 * std::floor((u + 1) / 2);
    const double border = du < 0 ? -1 : 1, to_border = std::abs(border - u);
    if (std::abs(du) <= to_border) return term.extinction * mean_polynomial(c, u, u + du);
    const double left = std::abs(du) - to_border, domains = std::floor(left / 2);
    const double rest = left - 2 * domains;
    const double sum = to_border * mean_polynomial(c, u, border) +
                       2 * domains * mean_polynomial(c, -1, 1) +
                       rest * mean_polynomial(c, -border, -border + rest * border);
    return term.extinction * sum / std::abs(du);
}

double at(const Polynomials& fog, const Vector3d& x) {
    double sum = 0;
    for (const auto& term : fog.terms) sum += at(term, x);
    return sum;
}

double mean(const Polynomials& fog, const Segment& segment) {
    double sum = 0;
    for (const auto& term : fog.terms) sum += mean(term, segment);
    return sum;
}

/// Mean over the segment of 1 / (e + |x|^2 / reach^2), positive on it; `start` counts from the
/// object. With A, C the denominator at the ends, B = e + start . end / reach^2 and D = A C - B^2
/// it is atan(sqrt(D) / B) / sqrt(D), or atanh with -D where D is negative.
double mean_inverse_square(const Segment& s, double e, double reach) {
    const Vector3d w = s.start / reach, v = s.path / reach;
    const double a = e + w.squaredNorm(), c = e + (w + v).squaredNorm(), b = e + w.dot(w + v);
    const double d = e * v.squaredNorm() + w.cross(v).squaredNorm();
    if (const double q = d / (b * b); b > 0 && std::abs(q) < 1e-4)
        return (1 - q * (1.0 / 3 - q * (1.0 / 5 - q * (1.0 / 7)))) / b;
    const double root = std::sqrt(std::abs(d));
    return (d > 0 ? std::atan2(root, b) : std::log((b + root) / std::sqrt(a * c))) / root;
}

double at(const Potentials::Object& object, const Vector3d& x) {
    using Kind = Potentials::Object::Kind;
    Vector3d w = x - object.from;
    double square = w.squaredNorm();
    if (object.kind == Kind::line) {
        const Vector3d line = object.to - object.from;
        w -= std::clamp(w.dot(line) / line.squaredNorm(), 0.0, 1.0) * line;
        square = w.squaredNorm();
    } else if (object.kind == Kind::sphere) {
        square = std::max(square - object.radius * object.radius, 0.0);
    }
    return object.extinction / (1 + square / (object.reach * object.reach));
}

/// Beside a line the distance counts across it, beyond its ends from them; inside a sphere nothing
/// changes.
double mean(const Potentials::Object& object, const Segment& segment) {
    using Kind = Potentials::Object::Kind;
    const Segment s{segment.start - object.from, segment.path};
    double sum = 0;
    const auto add = [&](Range range, double e, const auto& change) {
        if (range.length() > 0)
            sum += range.length() *
                   mean_inverse_square(change(s.part(range.begin, range.end)), e, object.reach);
    };
    const auto same = [](const Segment& part) { return part; };
    if (object.kind == Kind::line) {
        const Vector3d line = object.to - object.from, axis = line.normalized();
        const double from = s.start.dot(axis), slope = s.path.dot(axis);
        add(clip(from, slope, -kInfinity, 0), 1, same);
        add(clip(from, slope, 0, line.norm()), 1, [&](const Segment& part) {
            return Segment{part.start - axis * part.start.dot(axis),
                           part.path - axis * part.path.dot(axis)};
        });
        add(clip(from, slope, line.norm(), kInfinity), 1, [&](const Segment& part) {
            return Segment{part.start - line, part.path};
        });
        return object.extinction * sum;
    }
    Range inside{0, 0};
    if (object.kind == Kind::sphere) {
        const double length = s.path.norm();
        const double half_square =
            object.radius * object.radius - (s.start.cross(s.path) / length).squaredNorm();
        if (half_square > 0) {
            const double middle = -s.start.dot(s.path) / (length * length);
            const double half = std::sqrt(half_square) / length;
            inside = {std::clamp(middle - half, 0.0, 1.0), std::clamp(middle + half, 0.0, 1.0)};
        }
    }
    const double ratio = object.radius / object.reach;
    add({0, inside.begin}, 1 - ratio * ratio, same);
    add({inside.end, 1}, 1 - ratio * ratio, same);
    return object.extinction * (sum + inside.length());
}

double at(const Potentials& fog, const Vector3d& x) {
    double sum = fog.extinction;
    for (const auto& object : fog.objects) sum += at(object, x);
    return sum;
}

double mean(const Potentials& fog, const Segment& segment) {
    double sum = fog.extinction;
    for (const auto& object : fog.objects) sum += mean(object, segment);
    return sum;
}

double at(const Separable& fog, const Vector3d& x) {
    return detail::extinction_at(fog, x);
}

double mean(const Separable& fog, const Segment& segment) {
    return detail::mean_extinction(fog, segment.start, segment.path);
}

}  // namespace

double extinction(const FogModel& model, const Vector3d& point) {
    return std::visit([&](const auto& fog) { return at(fog, point); }, model);
}

double optical_depth(const FogModel& model, const Vector3d& o, const Vector3d& p) {
    const Segment segment{o, p - o};
    const double metres = segment.path.norm();
    if (metres == 0) return 0;
    const double tau =
        metres * std::visit([&](const auto& fog) { return mean(fog, segment); }, model);
    const auto* plane = std::get_if<Halfspace>(&model);
    return plane ? apparent(*plane, tau) : tau;
}

double optical_depth(const std::vector<FogModel>& models, const Vector3d& o, const Vector3d& p) {
    double sum = 0;
    for (const FogModel& model : models) sum += optical_depth(model, o, p);
    return sum;
}

}  // namespace wavefog
