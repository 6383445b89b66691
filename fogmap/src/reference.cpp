#include "wavefog/fogmap/reference.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "wavefog/wavelet/bspline.h"
#include "wavefog/wavelet/cell.h"

namespace wavefog {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr int kMaxOrder = kMaxDegree + 1;

template <class T>
Band<double> widened(const Band<T>& band) {
    return {band.values.template cast<double>(), band.start_x, band.start_z};
}

Decomposition<double> widened(const Decomposition<float>& from) {
    Decomposition<double> to;
    to.family = from.family;
    to.form = from.form;
    to.boundary = from.boundary;
    to.width = from.width;
    to.height = from.height;
    to.approximation = widened(from.approximation);
    for (const Detail<float>& detail : from.details)
        to.details.push_back({widened(detail.phi_psi), widened(detail.psi_phi),
                              widened(detail.psi_psi), widened(detail.residual)});
    return to;
}

// exp(-s t) on [0, 1] differs from its best polynomial of degree k by at most
// (s/2)^(k+1) / (2^k (k+1)!) of its middle value. With m nodes more than the spline needs, k = 2m +
// 1; kNodeLimit[m] is the largest s for which that is 1e-17.
constexpr int kExtraNodes = 7;
const std::array<double, kExtraNodes + 1> kNodeLimit = [] {
    std::array<double, kExtraNodes + 1> limit{};
    for (int m = 0; m <= kExtraNodes; ++m) {
        const int k = 2 * m + 1;
        limit[std::size_t(m)] =
            2 * std::pow(1e-17 * std::ldexp(std::tgamma(k + 2.0), k), 1.0 / (k + 1));
    }
    return limit;
}();
constexpr double kMaxPieceDecay = 2;  // below kNodeLimit[7] = 2.25
// exp(-80) = 2e-35: a spline that grows like t^30 from the lower end still leaves nothing above it.
constexpr double kMaxDecay = 80 + 4 * 30;

int extra_nodes(double decay) {
    int m = 0;
    while (m < kExtraNodes && decay > kNodeLimit[std::size_t(m)]) ++m;
    return decay > 0 ? m : 0;
}

int wrapped(double index, int period) {
    return static_cast<int>(index - std::floor(index / period) * period);
}

}  // namespace

struct Reference::Range {
    double begin = 0, end = 0;
    bool empty() const { return !(begin < end); }
};

struct Reference::Line {
    double u0, v0, y0;
    double du, dv, dy;

    double u(double t) const { return u0 + t * du; }
    double v(double t) const { return v0 + t * dv; }
    double y(double t) const { return y0 + t * dy; }

    Line(const Reference& map, const Eigen::Vector3d& from, const Eigen::Vector3d& along)
        : u0((from.x() - map.origin_x_) / map.cell_x_ + map.degree_ / 2.0),
          v0((from.z() - map.origin_z_) / map.cell_z_ + map.degree_ / 2.0),
          y0(from.y()),
          du(along.x() / map.cell_x_),
          dv(along.z() / map.cell_z_),
          dy(along.y()) {}
};

Reference::Reference(const Fog& fog, double seconds)
    : origin_x_(fog.rect.x0),
      origin_z_(fog.rect.z0),
      cell_x_(fog.cell_x()),
      cell_z_(fog.cell_z()),
      extinction_(fog.extinction),
      channels_(fog.channels),
      profile_(fog.profile),
      degree_(fog.degree()),
      pyramid_(approximations(widened(fog.decomposition))) {
    const Eigen::Vector2d moved =
        wind_offset(fog.wind, fog.rect, fog.decomposition.boundary, seconds);
    origin_x_ += moved.x();
    origin_z_ += moved.y();
    const Eigen::MatrixXd pieces = bspline_pieces(degree_);
    for (int p = 0; p <= degree_; ++p)
        for (int n = 0; n <= degree_; ++n) pieces_.push_back(pieces(n, p));
}

namespace {

/// The part of [begin, end] where low <= a + t * slope <= high; half-open for a constant.
void clip_axis(double a, double slope, double low, double high, double& begin, double& end) {
    if (slope == 0) {
        if (!(a >= low && a < high)) end = begin;
        return;
    }
    double first = (low - a) / slope, last = (high - a) / slope;
    if (first > last) std::swap(first, last);
    begin = std::max(begin, first);
    end = std::min(end, last);
}

}  // namespace

Reference::Range Reference::clip(const Line& line, double begin, double end) const {
    if (pyramid_.boundary == Boundary::zero) {
        clip_axis(line.u0, line.du, 0, pyramid_.width + degree_, begin, end);
        clip_axis(line.v0, line.dv, 0, pyramid_.height + degree_, begin, end);
    }
    switch (profile_.kind) {
        case Profile::Kind::slab: {
            // The top belongs to the slab, so a horizontal ray on it must not be cut away.
            const double top = std::nextafter(profile_.top, kInfinity);
            clip_axis(line.y0, line.dy, profile_.bottom, line.dy == 0 ? top : profile_.top, begin,
                      end);
            break;
        }
        case Profile::Kind::linear:
            clip_axis(line.y0, line.dy, -kInfinity, profile_.top, begin, end);
            break;
        case Profile::Kind::uniform:
        case Profile::Kind::exponential:
            break;
    }
    return {begin, end};
}

double Reference::optical_depth(const Eigen::Vector3d& o, const Eigen::Vector3d& p, double mu,
                                bool clamp) const {
    const Eigen::Vector3d along = p - o;
    const double length = along.norm();
    if (!std::isfinite(length) || !o.allFinite()) return kNaN;
    if (length == 0) return 0;
    const Line line(*this, o, along);
    const Range inside = clip(line, 0, 1);
    if (inside.empty()) return 0;

    double corner = inside.end;  // where the profile's formula changes
    const bool has_corner =
        profile_.kind == Profile::Kind::exponential || profile_.kind == Profile::Kind::linear;
    if (has_corner && line.dy != 0)
        corner = std::clamp((profile_.base - line.y0) / line.dy, inside.begin, inside.end);

    double sum = 0;
    const int finest = pyramid_.detail_levels();
    for (int level = finest; level >= 0; --level) {
        const double begin = level == finest ? 0 : std::pow(mu, level + 1);
        const double end = level == 0 ? 1 : std::pow(mu, level);
        const Range used{std::max(begin, inside.begin), std::min(end, inside.end)};
        sum += integrate_level(line, {used.begin, std::min(used.end, corner)}, level, clamp);
        sum += integrate_level(line, {std::max(used.begin, corner), used.end}, level, clamp);
    }
    return sum * extinction_ * length;
}

double Reference::integrate_level(const Line& line, Range range, int level, bool clamp) const {
    if (range.empty()) return 0;
    // Cell coordinates of this level: the scaling by a power of two is exact.
    const double scale = std::ldexp(1.0, level - pyramid_.detail_levels());
    const double u0 = line.u0 * scale, du = line.du * scale;
    const double v0 = line.v0 * scale, dv = line.dv * scale;

    // The next grid line along each axis by its integer index: no error accumulates, and t_of is
    // monotone in the index, so the walk cannot turn back.
    const auto next_index = [&](double a, double slope) {
        const double at = a + range.begin * slope;
        return slope > 0 ? std::floor(at) + 1 : std::ceil(at) - 1;
    };
    const auto t_of = [](double index, double a, double slope) {
        return slope == 0 ? kInfinity : (index - a) / slope;
    };
    double index_u = next_index(u0, du), index_v = next_index(v0, dv);
    double next_u = t_of(index_u, u0, du), next_v = t_of(index_v, v0, dv);
    // Layers of one scale height above the base, counted in eta = (y - base) / scale; above the
    // last one (1e-28) there is nothing to clamp.
    constexpr double kTopLayer = 64;
    const bool layered = profile_.kind == Profile::Kind::exponential && line.dy != 0;
    const double eta0 = (line.y0 - profile_.base) / profile_.scale;
    const double deta = line.dy / profile_.scale;
    double layer = layered ? next_index(eta0, deta) : 0;
    layer = deta > 0 ? std::max(layer, 0.0) : std::min(layer, kTopLayer);
    const auto layer_t = [&] {
        return layered && layer >= 0 && layer <= kTopLayer ? t_of(layer, eta0, deta) : kInfinity;
    };
    double next_layer = layer_t();

    double sum = 0;
    for (double t = range.begin; t < range.end;) {
        const double next = std::min({next_u, next_v, next_layer, range.end});
        if (next > t) {
            const double middle = t + (next - t) / 2;
            const double step = integrate_step(line, {t, next}, level, std::floor(u0 + middle * du),
                                               std::floor(v0 + middle * dv));
            sum += clamp ? std::max(0.0, step) : step;
            t = next;
        }
        // Steps behind t are skipped one index at a time; both axes may step at a vertex.
        if (next_u <= t) next_u = t_of(index_u += du > 0 ? 1 : -1, u0, du);
        if (next_v <= t) next_v = t_of(index_v += dv > 0 ? 1 : -1, v0, dv);
        if (next_layer <= t) {
            layer += deta > 0 ? 1 : -1;
            next_layer = layer_t();
        }
    }
    return sum;
}

double Reference::integrate_step(const Line& line, Range range, int level, double cell_u,
                                 double cell_v) const {
    std::array<double, kMaxOrder * kMaxOrder> coefficients;
    gather(level, cell_u, cell_v, coefficients.data());

    const double scale = std::ldexp(1.0, level - pyramid_.detail_levels());
    const auto mean = [&](double begin, double end, int nodes, auto&& profile) {
        const GaussRule& rule = gauss_legendre(nodes);
        double sum = 0;
        for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
            const double t = begin + (end - begin) * rule.nodes[i];
            const double u = std::clamp(line.u(t) * scale - cell_u, 0.0, 1.0);
            const double v = std::clamp(line.v(t) * scale - cell_v, 0.0, 1.0);
            sum += rule.weights[i] * density(coefficients.data(), u, v) * profile(t);
        }
        return sum;
    };

    const double length = range.end - range.begin;
    const bool above = line.y(range.begin + length / 2) > profile_.base;
    if (profile_.kind == Profile::Kind::linear && above)
        return length * mean(range.begin, range.end, degree_ + 1, [&](double t) {
                   return std::max(0.0,
                                   (profile_.top - line.y(t)) / (profile_.top - profile_.base));
               });
    if (profile_.kind != Profile::Kind::exponential || !above)
        return length * mean(range.begin, range.end, degree_ + 1, [](double) { return 1.0; });

    // exp(-(y - base) / scale), with its value at the lower end factored out: the rest decays
    // from 1.
    const bool rising = line.dy >= 0;
    const double low = rising ? range.begin : range.end;
    const double foot = std::exp(-std::max(0.0, line.y(low) - profile_.base) / profile_.scale);
    const double rate = std::abs(line.dy) / profile_.scale;  // per unit of t
    const double used = std::min(length, rate > 0 ? kMaxDecay / rate : length);
    const int pieces = std::max(1, static_cast<int>(std::ceil(used * rate / kMaxPieceDecay)));
    const int nodes = degree_ + 1 + extra_nodes(used * rate / pieces);
    double sum = 0;
    for (int k = 0; k < pieces; ++k) {
        const double near_end = used * k / pieces, far_end = used * (k + 1) / pieces;
        const double begin = rising ? low + near_end : low - far_end;
        const double end = rising ? low + far_end : low - near_end;
        sum +=
            mean(begin, end, nodes, [&](double t) { return std::exp(-rate * std::abs(t - low)); });
    }
    return foot * sum * used / pieces;
}

void Reference::gather(int level, double cell_u, double cell_v, double* coefficients) const {
    const Band<double>& band = pyramid_.levels[std::size_t(level)];
    // Piece p of phi_d(u - k) lies in cell k + p.
    std::array<int, kMaxOrder> column, row;
    const auto place = [&](double index, int start, int count) {
        const double k = index - start;
        if (pyramid_.boundary == Boundary::repeat) return wrapped(k, count);
        return k >= 0 && k < count ? static_cast<int>(k) : -1;
    };
    for (int p = 0; p <= degree_; ++p) {
        column[std::size_t(p)] = place(cell_u - p, band.start_x, band.width());
        row[std::size_t(p)] = place(cell_v - p, band.start_z, band.height());
    }
    for (int q = 0; q <= degree_; ++q)
        for (int p = 0; p <= degree_; ++p) {
            const int i = column[std::size_t(p)], j = row[std::size_t(q)];
            *coefficients++ = i >= 0 && j >= 0 ? band.values(j, i) : 0.0;
        }
}

double Reference::density(const double* coefficients, double u, double v) const {
    const int order = degree_ + 1;
    std::array<double, kMaxOrder> along_u, along_v;
    for (int p = 0; p < order; ++p) {
        const double* const piece = pieces_.data() + p * order;
        double x = 0, z = 0;
        for (int n = degree_; n >= 0; --n) {
            x = x * u + piece[n];
            z = z * v + piece[n];
        }
        along_u[std::size_t(p)] = x;
        along_v[std::size_t(p)] = z;
    }
    double sum = 0;
    for (int q = 0; q < order; ++q) {
        double row = 0;
        for (int p = 0; p < order; ++p) row += *coefficients++ * along_u[std::size_t(p)];
        sum += row * along_v[std::size_t(q)];
    }
    return sum;
}

double Reference::extinction(const Eigen::Vector3d& point) const {
    const Line at(*this, point, Eigen::Vector3d::Zero());
    if (pyramid_.boundary == Boundary::zero && !(at.u0 >= 0 && at.u0 < pyramid_.width + degree_ &&
                                                 at.v0 >= 0 && at.v0 < pyramid_.height + degree_))
        return 0;
    std::array<double, kMaxOrder * kMaxOrder> coefficients;
    const double cell_u = std::floor(at.u0), cell_v = std::floor(at.v0);
    gather(pyramid_.detail_levels(), cell_u, cell_v, coefficients.data());
    return extinction_ * density(coefficients.data(), at.u0 - cell_u, at.v0 - cell_v) *
           profile_(point.y());
}

double Reference::far_end(const Eigen::Vector3d& o, const Eigen::Vector3d& d, double limit) const {
    const Range inside = clip(Line(*this, o, d), 0, limit);
    return inside.empty() ? 0 : inside.end;
}

}  // namespace wavefog
