#include "transmittance.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

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
    error.rays = static_cast<std::size_t>(std::clamp(400000 / cells, 24.0, 1024.0));
    std::mt19937_64 random(1);
    const auto between = [&](double low, double high) {
        return low + (high - low) * (double(random() >> 11) * 0x1p-53);
    };
    for (std::size_t i = 0; i < error.rays; ++i) {
        Eigen::Vector3d o(between(rect.x0, rect.x1), y, between(rect.z0, rect.z1));
        const double up = std::numbers::pi / 2;
        double angle = between(0, 2 * std::numbers::pi), slope = between(0, up), length = path;
        switch (i % 6) {
            case 0:  // along a row from the map's edge
                o.x() = rect.x0;
                angle = slope = 0;
                break;
            case 1:  // along a column
                o.z() = rect.z0;
                angle = up;
                slope = 0;
                break;
            case 2:
                slope = 0;
                break;
            case 3:
                slope = up;
                break;
            default:
                length *= std::sqrt(between(0, 1));
        }
        const Eigen::Vector3d along(std::cos(angle) * std::cos(slope), std::sin(slope),
                                    std::sin(angle) * std::cos(slope));
        const Eigen::Vector3d p = o + length * along;
        const double difference =
            std::exp(-first.optical_depth(o, p)) - std::exp(-second.optical_depth(o, p));
        error.worst = std::max(error.worst, std::fabs(difference));
    }
    return error;
}

}  // namespace wavefog::cli
