#include "pixel_errors.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace wavefog::wfog {

using std::size_t;

PixelErrors::PixelErrors(const Grid<float>& map, const Grid<float>& error) {
    // One point stands for all whose densities share the upper bits: the least density and the
    // largest error of them, so that no ray is worse.
    constexpr unsigned kLowerBits = 15;
    struct Shared {
        float density = std::numeric_limits<float>::infinity(), error = 0;
    };
    std::vector<Shared> shared(size_t{1} << (31 - kLowerBits));
    for (Eigen::Index i = 0; i < map.size(); ++i) {
        const float off = error.data()[i], less = map.data()[i] + std::min(off, 0.0f);
        const float density = less > 0 ? less : 0.0f;  // not -0, which has other bits
        Shared& point = shared[std::bit_cast<std::uint32_t>(density) >> kLowerBits];
        point.density = std::min(point.density, density);
        point.error = std::max(point.error, std::fabs(off));
    }
    for (const auto& [density, largest] : shared) {
        const Point c{double(density), double(largest)};
        if (!(c.error > (corners_.empty() ? 0 : corners_.back().error))) continue;
        for (; corners_.size() >= 2; corners_.pop_back()) {
            const Point &a = corners_[corners_.size() - 2], &b = corners_.back();
            if ((b.error - a.error) * (c.density - a.density) >
                (c.error - a.error) * (b.density - a.density))
                break;
        }
        corners_.push_back(c);
    }
}

/// Of the ray of any length up to `reach` that stays at the point.
double PixelErrors::change(const Point& point, double reach) {
    // exp(-s density) (1 - exp(-s error)) is largest at this s, and rises up to there.
    const double most = std::log1p(point.error / point.density) / point.error;
    const double s = std::min(most, reach);
    return std::exp(-s * point.density) * -std::expm1(-s * point.error);
}

/// The largest on the way from `a` to `b`. The logarithm of the change is concave along it for
/// every length, so that the largest for all lengths first rises and then falls.
double PixelErrors::change_between(Point a, Point b, double reach) {
    constexpr int kSteps = 40;  // each leaves two thirds of the way
    const auto between = [&](double t) {
        return Point{std::lerp(a.density, b.density, t), std::lerp(a.error, b.error, t)};
    };
    double worst = 0;
    for (int step = 0; step < kSteps; ++step) {
        const Point first = between(1.0 / 3), second = between(2.0 / 3);
        const double of_first = change(first, reach), of_second = change(second, reach);
        worst = std::max({worst, of_first, of_second});
        (of_first < of_second ? a : b) = of_first < of_second ? first : second;
    }
    return worst;
}

double PixelErrors::worst_change(double reach) const {
    double worst = 0;
    for (const Point& corner : corners_) worst = std::max(worst, change(corner, reach));
    for (size_t i = 0; i + 1 < corners_.size(); ++i) {
        const Point &a = corners_[i], &b = corners_[i + 1];
        // Often no point between can be worse.
        if (change({a.density, b.error}, reach) > worst)
            worst = std::max(worst, change_between(a, b, reach));
    }
    return worst;
}

}  // namespace wavefog::wfog
