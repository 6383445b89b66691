#include "ray_errors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace wavefog::wfog {

namespace {

using std::size_t;

constexpr double kBetweenLines = 1.25;
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

/// The largest |sums[j] - sums[i]| with i < j <= i + length, for each of the `lengths` 1, 2, 3, 4,
/// 6, 8, 12 ... and last any other. Extremes of windows come from those of windows half as long.
class Windows {
  public:
    void widen(const std::vector<double>& sums, const std::vector<size_t>& lengths,
               std::vector<double>& worst) {
        const size_t count = sums.size(), last = lengths.back();
        high_.assign(count + last + 1, sums.back());
        std::copy(sums.begin(), sums.end(), high_.begin());
        low_ = high_;
        size_t width = 0;  // extremes of sums[i .. i + width]
        size_t power = 1;
        for (size_t k = 0; k < lengths.size(); ++k) {
            while (power <= lengths[k]) {
                grow(count + last - power, power - width);
                width = power;
                power *= 2;
            }
            // Two windows of `width` cover the length.
            const size_t shift = lengths[k] - width;
            double most = worst[k];
            for (size_t i = 0; i < count; ++i) {
                const double up = std::max(high_[i], high_[i + shift]) - sums[i];
                const double down = sums[i] - std::min(low_[i], low_[i + shift]);
                most = std::max(most, std::max(up, down));
            }
            worst[k] = most;
        }
    }

  private:
    void grow(size_t count, size_t shift) {
        for (size_t i = 0; i < count; ++i) {
            high_[i] = std::max(high_[i], high_[i + shift]);
            low_[i] = std::min(low_[i], low_[i + shift]);
        }
    }

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
            return profile.top - profile.base;
        case Profile::Kind::uniform:
            break;
    }
    return HUGE_VAL;
}

}  // namespace

double worst_ray_error(const Fog& fog, const Grid<float>& error, double path, int angles) {
    const Decomposition<float>& d = fog.decomposition;
    const Field field(error, d.degree(), d.boundary);
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

    std::vector<size_t> lengths;
    const auto most = static_cast<size_t>(std::ceil(longest / step));
    for (size_t n = 1; n < most; n *= 2) {
        lengths.push_back(n);
        if (n > 1 && n / 2 * 3 < most) lengths.push_back(n / 2 * 3);
    }
    lengths.push_back(std::max<size_t>(most, 1));
    std::vector<double> worst(lengths.size(), 0.0), sums;
    Windows windows;
    for (int a = 0; a < angles; ++a) {
        const double angle = std::numbers::pi * (a + 0.25) / angles;
        const double ux = std::cos(angle), uz = std::sin(angle);
        for (double across = -radius; across <= radius; across += spacing) {
            sums.assign(1, 0.0);
            bool inside = false;
            for (double along = -radius; along <= end; along += step) {
                const double value =
                    field.at((width / 2 + along * ux - across * uz) / cell_x - 0.5,
                             (height / 2 + along * uz + across * ux) / cell_z - 0.5);
                inside = inside || value != 0;
                sums.push_back(sums.back() + value * step);
            }
            if (!inside) continue;
            windows.widen(sums, lengths, worst);
        }
    }
    const double largest = error.size() > 0 ? double(error.abs().maxCoeff()) : 0;

    // Every slope: a class of lengths covers a range of them.
    const double upwards = thickness(fog.profile);
    double bound = 0;
    constexpr int kSlopes = 200;
    for (int s = 0; s <= kSlopes; ++s) {
        const double slope = std::numbers::pi / 2 * s / kSlopes;
        if (std::isinf(upwards) && slope > std::numbers::pi / 4 + 1e-9) break;
        const double cosine = std::max(std::cos(slope), 1e-12), sine = std::sin(slope);
        const double length = sine > 0 ? std::min(path, upwards / sine) : path;
        // No segment can hold more than the largest error all along.
        double integral = largest * length;
        for (size_t k = 0; k < lengths.size(); ++k)
            if (static_cast<double>(lengths[k]) * step >= std::min(length * cosine, longest)) {
                integral = std::min(integral, kBetweenLines * pieces * worst[k] / cosine);
                break;
            }
        bound = std::max(bound, integral);
    }
    return fog.extinction * bound;
}

}  // namespace wavefog::wfog
