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
constexpr double kMostSamples = 6e7;

/// The error field at a place in cells, pixel (0, 0) at 0. For degrees above 1 the field is an
/// average of shifted copies of this one, so that no ray through it is worse.
class Field {
  public:
    Field(const Grid<float>& map, int degree, Boundary boundary)
        : map_(map), nearest_(degree == 0), repeats_(boundary == Boundary::repeat) {}

    double at(double x, double z) const {
        if (nearest_) return pixel(std::floor(x + 0.5), std::floor(z + 0.5));
        const double i = std::floor(x), j = std::floor(z), a = x - i, b = z - j;
        return (pixel(i, j) * (1 - a) + pixel(i + 1, j) * a) * (1 - b) +
               (pixel(i, j + 1) * (1 - a) + pixel(i + 1, j + 1) * a) * b;
    }

  private:
    double pixel(double i, double j) const {
        auto x = static_cast<Eigen::Index>(i), z = static_cast<Eigen::Index>(j);
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

/// Largest |sum[j] - sum[i]| with 0 < j - i <= length.
double widest(const std::vector<double>& sums, size_t length, std::vector<size_t>& queue) {
    double worst = 0;
    for (const double sign : {1.0, -1.0}) {
        queue.clear();  // places of rising values among the last `length`
        size_t first = 0;
        for (size_t j = 0; j < sums.size(); ++j) {
            while (first < queue.size() && queue[first] + length < j) ++first;
            if (first < queue.size())
                worst = std::max(worst, sign * (sums[j] - sums[queue[first]]));
            while (queue.size() > first && sign * sums[queue.back()] >= sign * sums[j])
                queue.pop_back();
            queue.push_back(j);
        }
    }
    return worst;
}

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
    const double longest = d.boundary == Boundary::repeat ? path : std::min(path, 2 * radius);
    const double end = d.boundary == Boundary::repeat ? radius + path : radius;
    const double per_line = (radius + end) / step;
    const double lines = 2 * radius / step;
    const double spacing = step * std::max(1.0, per_line * lines * angles / kMostSamples);

    // Segments of 1, 2, 4 ... steps, and the longest.
    std::vector<size_t> lengths;
    const auto most = static_cast<size_t>(std::ceil(longest / step));
    for (size_t n = 1; n < most; n *= 2) lengths.push_back(n);
    lengths.push_back(std::max<size_t>(most, 1));
    std::vector<double> worst(lengths.size(), 0.0), sums;
    std::vector<size_t> queue;
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
            for (size_t k = 0; k < lengths.size(); ++k)
                worst[k] = std::max(worst[k], widest(sums, lengths[k], queue));
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
                integral = std::min(integral, kBetweenLines * worst[k] / cosine);
                break;
            }
        bound = std::max(bound, integral);
    }
    return fog.extinction * bound;
}

}  // namespace wavefog::wfog
