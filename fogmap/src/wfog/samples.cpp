#include "samples.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <numeric>

namespace wavefog::wfog {

namespace {

constexpr double kMostInteger = (1 << 30) - 1;

/// Rises with the density.
std::int32_t ordered_bits(float density, unsigned shift = 0) {
    const std::int32_t magnitude = std::bit_cast<std::int32_t>(std::fabs(density)) >> shift;
    return std::signbit(density) ? ~magnitude : magnitude;  // -0 is not 0
}

}  // namespace

float Scale::density(std::int32_t k) const {
    switch (kind) {
        case Kind::ratio:
            return static_cast<float>(static_cast<double>(k) / divisor);
        case Kind::step:
            return static_cast<float>(static_cast<double>(k) * step);
        case Kind::float_bits: {
            const float magnitude =
                std::bit_cast<float>(static_cast<std::uint32_t>(k < 0 ? ~k : k) << shift);
            return k < 0 ? -magnitude : magnitude;
        }
        case Kind::table:
            return k >= 0 && static_cast<std::size_t>(k) < values.size()
                       ? values[static_cast<std::size_t>(k)]
                       : 0.0f;
    }
    return 0;
}

std::optional<std::int32_t> Scale::integer(float value) const {
    if (kind == Kind::float_bits) return ordered_bits(value, shift);
    if (kind == Kind::table) {
        const auto at = std::lower_bound(values.begin(), values.end(), value, [](float a, float b) {
            return ordered_bits(a) < ordered_bits(b);
        });
        if (at == values.end() || ordered_bits(*at) != ordered_bits(value)) return {};
        return static_cast<std::int32_t>(at - values.begin());
    }
    const double k = kind == Kind::ratio ? double(value) * divisor : double(value) / step;
    if (!(std::fabs(k) <= kMostInteger)) return {};
    return static_cast<std::int32_t>(k < 0 ? k - 0.5 : k + 0.5);
}

std::optional<Scale> ratio_of(const Grid<float>& map, double slack) {
    const double largest = map.size() > 0 ? double(map.abs().maxCoeff()) : 0;
    for (const std::uint32_t divisor : {255u, 1u, 65535u, 10u, 100u, 1000u, 10000u, 2u, 4u, 8u, 16u,
                                        32u, 64u, 128u, 256u, 1024u}) {
        const Scale scale{.kind = Scale::Kind::ratio, .divisor = divisor};
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
        if (!fits) continue;
        if (divisor == 255 || divisor == 65535) return scale;
        // Steps of 4/100 are steps of 1/25.
        std::uint32_t common = divisor;
        for (Eigen::Index i = 0; common > 1 && i < map.size(); ++i)
            common =
                std::gcd(common, static_cast<std::uint32_t>(std::abs(*scale.integer(begin[i]))));
        if (common > 1 && largest > 0)
            return Scale{.kind = Scale::Kind::ratio, .divisor = divisor / common};
        return scale;
    }
    return {};
}

Scale exact_scale(const Grid<float>& map) {
    std::vector<std::int32_t> bits(static_cast<std::size_t>(map.size()));
    std::transform(map.data(), map.data() + map.size(), bits.begin(),
                   [](float value) { return ordered_bits(value); });
    std::uint32_t used = 0;
    for (const std::int32_t each : bits)
        used |= static_cast<std::uint32_t>(each < 0 ? ~each : each);
    std::sort(bits.begin(), bits.end());
    const std::size_t pixels = bits.size();
    bits.erase(std::unique(bits.begin(), bits.end()), bits.end());
    Scale scale{.kind = Scale::Kind::float_bits};
    if (bits.size() <= kMaxTable && bits.size() * 8 <= pixels) {
        scale.kind = Scale::Kind::table;
        for (const std::int32_t each : bits)
            scale.values.push_back(each < 0 ? -std::bit_cast<float>(~each)
                                            : std::bit_cast<float>(each));
    } else if (used != 0) {
        scale.shift = static_cast<unsigned>(std::countr_zero(used));
    }
    return scale;
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
