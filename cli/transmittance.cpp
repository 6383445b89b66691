#include "transmittance.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "wavefog/fogmap/reference.h"

namespace wavefog::cli {
namespace {

/// Where the rays that climb meet most fog, of those above `ground`.
double lowest_height(const Profile& profile, double path, double ground) {
    switch (profile.kind) {
        case Profile::Kind::slab:
            return std::max(profile.bottom, ground);
        case Profile::Kind::exponential:
        case Profile::Kind::linear:
            return std::max(profile.base - path, ground);
        case Profile::Kind::uniform:
            break;
    }
    return std::max(0.0, ground);
}

/// The pixels that are off by most, and those by most where fog is thin, which hides no errors.
std::vector<Eigen::Index> worst_pixels(const Grid<float>& a, const Grid<float>& b,
                                       std::size_t count) {
    const float thin = std::max(a.abs().maxCoeff() / 64, 1e-30f);
    std::vector<Eigen::Index> worst, all(static_cast<std::size_t>(a.size()));
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<Eigen::Index>(i);
    count = std::min(count, all.size());
    const auto add = [&](auto weight) {
        const auto end = all.begin() + static_cast<std::ptrdiff_t>(count);
        std::partial_sort(all.begin(), end, all.end(),
                          [&](Eigen::Index i, Eigen::Index j) { return weight(i) > weight(j); });
        worst.insert(worst.end(), all.begin(), end);
    };
    const auto off = [&](Eigen::Index i) { return std::fabs(a.data()[i] - b.data()[i]); };
    add(off);
    add([&](Eigen::Index i) { return off(i) / (std::fabs(a.data()[i]) + thin); });
    return worst;
}

}  // namespace

SampledError sampled_transmittance_error(const Fog& a, const Fog& b, double path, double ground) {
    const Reference first(a), second(b);
    const Rect& rect = a.rect;
    if (path == 0) path = std::hypot(rect.x1 - rect.x0, rect.z1 - rect.z0);
    const double y = lowest_height(a.profile, path, ground);
    const Decomposition<float>& d = a.decomposition;
    const double cells = d.boundary == Boundary::repeat ? path / std::min(a.cell_x(), a.cell_z())
                                                        : double(std::max(d.width, d.height));
    SampledError error;
    error.rays = static_cast<std::size_t>(std::clamp(200000 / cells, 24.0, 1024.0));
    const std::vector<Eigen::Index> worst =
        worst_pixels(reconstruct(a.decomposition), reconstruct(b.decomposition), error.rays / 4);
    std::mt19937_64 random(1);
    const auto between = [&](double low, double high) {
        return low + (high - low) * (double(random() >> 11) * 0x1p-53);
    };
    for (std::size_t i = 0; i < error.rays; ++i) {
        Eigen::Vector3d o(between(rect.x0, rect.x1), y, between(rect.z0, rect.z1));
        const Eigen::Index pixel = worst[i / 2 % worst.size()];
        const Eigen::Vector3d there(rect.x0 + (double(pixel % d.width) + 0.5) * a.cell_x(), y,
                                    rect.z0 + (double(pixel / d.width) + 0.5) * a.cell_z());
        const double up = std::numbers::pi / 2;
        double angle = between(0, 2 * std::numbers::pi), slope = 0;
        bool centred = false;
        switch (i % 8) {
            case 0:  // along a row from the map's edge
                o.x() = rect.x0;
                angle = 0;
                break;
            case 1:  // along a column
                o.z() = rect.z0;
                angle = up;
                break;
            case 2:
            case 4:  // straight up
                o = there;
                slope = up;
                break;
            case 3:  // level
                o = there;
                centred = true;
                break;
            case 5:
                slope = up;
                break;
            case 6:
                slope = between(0, up);
                break;
            default:
                break;
        }
        const Eigen::Vector3d along(std::cos(angle) * std::cos(slope), std::sin(slope),
                                    std::sin(angle) * std::cos(slope));
        // What is left of light after a long way through dense fog tells nothing of a short one.
        constexpr int kOctaves = 12;
        double length = path;
        for (int octave = 0; octave < kOctaves; ++octave, length /= 2) {
            const Eigen::Vector3d from = centred ? Eigen::Vector3d(o - along * length / 2) : o;
            const Eigen::Vector3d to = from + along * length;
            const double difference = std::exp(-first.optical_depth(from, to)) -
                                      std::exp(-second.optical_depth(from, to));
            error.worst = std::max(error.worst, std::fabs(difference));
        }
    }
    return error;
}

}  // namespace wavefog::cli
