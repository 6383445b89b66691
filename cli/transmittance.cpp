#include "transmittance.h"

#include <algorithm>
#include <cmath>
#include <random>

#include "wavefog/fogmap/reference.h"

namespace wavefog::cli {
namespace {

/// A height at which h(y) = 1.
double dense_height(const Profile& profile) {
    switch (profile.kind) {
        case Profile::Kind::slab:
            return (profile.bottom + profile.top) / 2;
        case Profile::Kind::exponential:
        case Profile::Kind::linear:
            return profile.base;
        case Profile::Kind::uniform:
            break;
    }
    return 0;
}

}  // namespace

SampledError sampled_transmittance_error(const Fog& a, const Fog& b, double path) {
    const Reference first(a), second(b);
    const double y = dense_height(a.profile);
    const int side = std::max(a.decomposition.width, a.decomposition.height);
    SampledError error;
    error.rays = static_cast<std::size_t>(std::clamp(400000 / side, 64, 1024));
    std::mt19937_64 random(1);
    const auto between = [&](double low, double high) {
        return low + (high - low) * (double(random() >> 11) * 0x1p-53);
    };
    for (std::size_t i = 0; i < error.rays; ++i) {
        const Eigen::Vector3d o(between(a.rect.x0, a.rect.x1), y, between(a.rect.z0, a.rect.z1));
        Eigen::Vector3d p(between(a.rect.x0, a.rect.x1), y, between(a.rect.z0, a.rect.z1));
        const double length = (p - o).norm();
        if (path > 0 && length > path) p = o + (p - o) * (path / length);
        const double difference =
            std::exp(-first.optical_depth(o, p)) - std::exp(-second.optical_depth(o, p));
        error.worst = std::max(error.worst, std::fabs(difference));
    }
    return error;
}

}  // namespace wavefog::cli
