#include "samples.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

namespace wavefog::wfog {

namespace {

constexpr double kMostInteger = (1 << 30) - 1;

std::int32_t ordered_bits(float density) {
    const std::int32_t magnitude = std::bit_cast<std::int32_t>(std::fabs(density));
    return std::signbit(density) ? ~magnitude : magnitude;  // -0 is not 0
}

}  // namespace

float Scale::density(std::int32_t k) const {
    switch (kind) {
        case Kind::ratio:
            return static_cast<float>(static_cast<double>(k) / divisor);
        case Kind::step:
            return static_cast<float>(static_cast<double>(k) * step);
        case Kind::float_bits:
            return k < 0 ? -std::bit_cast<float>(~k) : std::bit_cast<float>(k);
    }
    return 0;
}

std::optional<std::int32_t> Scale::integer(float value) const {
    if (kind == Kind::float_bits) return ordered_bits(value);
    const double k = kind == Kind::ratio ? double(value) * divisor : double(value) / step;
    if (!(std::fabs(k) <= kMostInteger)) return {};
    return static_cast<std::int32_t>(std::lround(k));
}

std::optional<Scale> ratio_of(const Grid<float>& map, double slack) {
    const double largest = map.size() > 0 ? double(map.abs().maxCoeff()) : 0;
    for (const std::uint32_t divisor : {255u, 1u, 65535u, 10u, 100u, 1000u, 10000u, 2u, 4u, 8u, 16u,
                                        32u, 64u, 128u, 256u, 1024u}) {
        const Scale scale{Scale::Kind::ratio, divisor, 1};
        const double tolerance = largest * slack;
        // A grid finer than the tolerance would fit anything.
        if (tolerance * divisor > 0.1) continue;
        const float* const begin = map.data();
        const bool fits = std::all_of(begin, begin + map.size(), [&](float value) {
            const auto k = scale.integer(value);
            if (!k) return false;
            const float back = scale.density(*k);
            return std::bit_cast<std::uint32_t>(back) == std::bit_cast<std::uint32_t>(value) ||
                   std::fabs(double(back) - double(value)) <= tolerance;
        });
        if (fits) return scale;
    }
    return {};
}

double full_scale(const Grid<float>& map, const std::optional<Scale>& ratio) {
    if (ratio && ratio->divisor == 255) return 1;
    const double least = map.minCoeff(), most = map.maxCoeff();
    if (ratio && ratio->divisor == 65535) return most - least;
    std::vector<float> sorted(map.data(), map.data() + map.size());
    const auto hot = static_cast<std::ptrdiff_t>(static_cast<double>(sorted.size()) * 0.999);
    std::nth_element(sorted.begin(), sorted.begin() + hot, sorted.end());
    const double range = double(sorted[static_cast<std::size_t>(hot)]) - least;
    return range > 0 ? range : most - least;
}

}  // namespace wavefog::wfog
