#include "ray_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "pixel_errors.h"

namespace wavefog::wfog {

namespace {

using std::size_t;

constexpr double kBetweenLines = 1.1;
/// Samples of one estimate at most: larger maps get fewer lines.
constexpr double kMostSamples = 1e7;

/// The error field at a place in cells, pixel (0, 0) at 0. For degrees above 1 the field is an
/// average of shifted copies of this one, so that no ray through it is worse.
class Field {
  public:
    Field(const Grid<float>& map, int degree, Boundary boundary)
        : map_(map), nearest_(degree == 0), repeats_(boundary == Boundary::repeat) {}

    double at(double x, double z) const {
        if (nearest_)
            return pixel(static_cast<Eigen::Index>(std::floor(x + 0.5)),
                         static_cast<Eigen::Index>(std::floor(z + 0.5)));
        // Truncation rounds down: all places inside are above -kPast.
        const auto i = static_cast<Eigen::Index>(x + kPast) - kPast;
        const auto j = static_cast<Eigen::Index>(z + kPast) - kPast;
        const double a = x - double(i), b = z - double(j);
        return (pixel(i, j) * (1 - a) + pixel(i + 1, j) * a) * (1 - b) +
               (pixel(i, j + 1) * (1 - a) + pixel(i + 1, j + 1) * a) * b;
    }

  private:
    static constexpr Eigen::Index kPast = 1 << 20;

    double pixel(Eigen::Index x, Eigen::Index z) const {
        if (repeats_) {
            x = (x % map_.cols() + map_.cols()) % map_.cols();
            z = (z % map_.rows() + map_.rows()) % map_.rows();
        }
        if (x < 0 || z < 0 || x >= map_.cols() || z >= map_.rows()) return 0;
        return double(map_(z, x));
    }

    const Grid<float>& map_;
    const bool nearest_, repeats_;
};

/// The segments of lines, by length and optical depth: how far the map's error can add up.
class Segments {
  public:
    /// Lengths 1, 2, 3, 4 ... 10, 12, 14, 16, 19 ... samples of a line, each at most a fifth more
    /// than the one before from 5 on, and last `most`.
    Segments(size_t most, double depth_of_sum) : depth_of_sum_(depth_of_sum) {
        for (size_t n = 1; n < most; n += std::max<size_t>(n / 5, 1)) lengths_.push_back(n);
        lengths_.push_back(std::max<size_t>(most, 1));
        worst_.resize(lengths_.size());
    }

    /// Running sums along a line: of the error, and of the density.
    void add_line(const std::vector<double>& sums, const std::vector<double>& density) {
        const size_t count = sums.size(), last = lengths_.back();
        high_.assign(count + 2 * last + 2, sums.back());
        std::copy(sums.begin(), sums.end(), high_.begin());
        low_ = high_;
        size_t width = 0;  // extremes of sums[i .. i + width]
        for (size_t k = 0; k < lengths_.size(); ++k) {
            // The ends of segments longer than those of the class before, up to this one's length:
            // two windows of `width` cover them. Extremes come from those of half the width.
            const size_t shortest = k == 0 ? 0 : lengths_[k - 1];
            const size_t ends = lengths_[k] - shortest;
            for (size_t more; more = std::max<size_t>(width, 1), width + more <= ends;) {
                grow(high_.size() - more, more);
                width += more;
            }
            const size_t shift = shortest + ends - width;
            for (size_t i = 0; i < count; ++i) {
                const double up = std::max(high_[i + shortest], high_[i + shift]) - sums[i];
                const double down = sums[i] - std::min(low_[i + shortest], low_[i + shift]);
                const double least_depth =
                    (density[std::min(i + shortest, count - 1)] - density[i]) * depth_of_sum_;
                double& most = worst_[k][depth_class(least_depth)];
                most = std::max(most, std::max(up, down));
            }
        }
    }

    /// The largest |dT| of a segment of up to `length` samples whose error and density are both
    /// `stretch` times those of the lines; `reserve` more of the error.
    double worst_change(double length, double stretch, double reserve) const {
        std::array<double, kDepths> worst{};
        for (size_t k = 0; k < lengths_.size(); ++k) {
            for (size_t t = 0; t < kDepths; ++t) worst[t] = std::max(worst[t], worst_[k][t]);
            if (static_cast<double>(lengths_[k]) >= length) break;
        }
        // A ray under a height profile is a mean of segments from one end, and so its depth and its
        // error are means of theirs: a point below the hull of (depth, error) of segments.
        make_concave(worst);
        double change = 0;
        for (size_t t = 0; t < kDepths; ++t)
            change = std::max(change, std::exp(-stretch * depth_of(t)) *
                                          std::expm1(stretch * reserve * depth_of_sum_ * worst[t]));
        return change;
    }

  private:
    static constexpr size_t kDepths = 193;
    static constexpr double kDepthStep = 1.0 / 16;

    static size_t depth_class(double depth) {
        return static_cast<size_t>(std::clamp(depth / kDepthStep, 0.0, double(kDepths - 1)));
    }
    static double depth_of(size_t t) { return static_cast<double>(t) * kDepthStep; }

    /// The least concave sequence that is nowhere below.
    static void make_concave(std::array<double, kDepths>& values) {
        std::vector<size_t> corners;
        for (size_t t = 0; t < kDepths; ++t) {
            while (corners.size() >= 2) {
                const size_t a = corners[corners.size() - 2], b = corners.back();
                if ((values[b] - values[a]) * double(t - a) >
                    (values[t] - values[a]) * double(b - a))
                    break;
                corners.pop_back();
            }
            corners.push_back(t);
        }
        for (size_t c = 0; c + 1 < corners.size(); ++c)
            for (size_t a = corners[c], b = corners[c + 1], t = a + 1; t < b; ++t)
                values[t] = std::lerp(values[a], values[b], double(t - a) / double(b - a));
    }

    void grow(size_t count, size_t shift) {
        for (size_t i = 0; i < count; ++i) {
            high_[i] = std::max(high_[i], high_[i + shift]);
            low_[i] = std::min(low_[i], low_[i + shift]);
        }
    }

    double depth_of_sum_;
    std::vector<size_t> lengths_;
    std::vector<std::array<double, kDepths>> worst_;  ///< by class of length, then of depth
    std::vector<double> high_, low_;
};

/// The integral of h upwards from where it is 1, metres.
double thickness(const Profile& profile) {
    switch (profile.kind) {
        case Profile::Kind::slab:
            return profile.top - profile.bottom;
        case Profile::Kind::exponential:
            return profile.scale;
        case Profile::Kind::linear:
            return (profile.top - profile.base) / 2;
        case Profile::Kind::uniform:
            break;
    }
    return HUGE_VAL;
}

}  // namespace

double worst_ray_error(const Fog& fog, const Grid<float>& map, const Grid<float>& error,
                       double path, int angles) {
    const PixelErrors pixels(map, error);
    // Straight up, a ray stays over one pixel: no other can be worse.
    if (fog.profile.kind == Profile::Kind::uniform)
        return pixels.worst_change(fog.extinction * path);
    const Decomposition<float>& d = fog.decomposition;
    const Field field(error, d.degree(), d.boundary), densities(map, d.degree(), d.boundary);
    const double cell_x = fog.cell_x(), cell_z = fog.cell_z();
    const double step = std::min(cell_x, cell_z);
    const double width = cell_x * d.width, height = cell_z * d.height;
    const double radius = std::hypot(width, height) / 2 + step;
    // Over tiles, a very long ray is several long ones.
    const bool repeats = d.boundary == Boundary::repeat;
    const double longest = std::min(path, (repeats ? 8 : 2) * radius);
    const double pieces = repeats ? std::ceil(path / longest) : 1;
    const double end = repeats ? radius + longest : radius;
    const double per_line = (radius + end) / step;
    const double lines = 2 * radius / step;
    const double spacing = step * std::max(1.0, per_line * lines * angles / kMostSamples);

    Segments segments(static_cast<size_t>(std::ceil(longest / step)), fog.extinction * step);
    std::vector<double> sums, depths;
    for (int a = 0; a < angles; ++a) {
        const double angle = std::numbers::pi * (a + 0.25) / angles;
        const double ux = std::cos(angle), uz = std::sin(angle);
        for (double across = -radius; across <= radius; across += spacing) {
            sums.assign(1, 0.0);
            depths.assign(1, 0.0);
            bool inside = false;
            for (double along = -radius; along <= end; along += step) {
                const double x = (width / 2 + along * ux - across * uz) / cell_x - 0.5;
                const double z = (height / 2 + along * uz + across * ux) / cell_z - 0.5;
                const double value = field.at(x, z);
                inside = inside || value != 0;
                sums.push_back(sums.back() + value);
                depths.push_back(depths.back() + std::max(densities.at(x, z), 0.0));
            }
            if (inside) segments.add_line(sums, depths);
        }
    }

    // Every slope: a class of lengths covers a range of them.
    const double upwards = thickness(fog.profile);
    double worst = 0;
    constexpr int kSlopes = 200;
    for (int s = 0; s <= kSlopes; ++s) {
        const double slope = std::numbers::pi / 2 * s / kSlopes;
        const double cosine = std::max(std::cos(slope), 1e-12), sine = std::sin(slope);
        const double length = sine > 0 ? std::min(path, upwards / sine) : path;
        const double found = segments.worst_change(std::min(length * cosine, longest) / step,
                                                   pieces / cosine, kBetweenLines);
        // A steep ray crosses few pixels, so that none of their errors may even out.
        if (found > worst)
            worst = std::max(worst, std::min(found, pixels.worst_change(fog.extinction * length)));
    }
    return worst;
}

}  // namespace wavefog::wfog
