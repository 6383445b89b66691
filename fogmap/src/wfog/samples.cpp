#include "samples.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <iterator>

#include "vector_clones.h"

namespace wavefog::wfog {

namespace {

constexpr double kMostInteger = (1 << 30) - 1;
constexpr std::int32_t kExactFloats = 1 << 24;
/// Below, products of floats are near enough to the integer that they stand for.
constexpr double kNearIntegers = 1 << 20;

/// Rises with the density.
std::int32_t ordered_bits(float density, unsigned shift = 0) {
    const std::int32_t magnitude = std::bit_cast<std::int32_t>(std::fabs(density)) >> shift;
    return std::signbit(density) ? ~magnitude : magnitude;  // -0 is not 0
}

/// A step of companding: x that grows faster than itself. Of correctly rounded operations alone,
/// like its inverse (of y >= 0), so that both are the same on every machine.
double stretched(double x, double growth) {
    return x + growth * x * std::fabs(x);
}
double unstretched(double y, double growth) {
    return 2 * y / (1 + std::sqrt(1 + 4 * growth * y));
}

/// The real number whose companded density is `scaled` steps.
double uncompanded(double scaled, double growth) {
    const double magnitude = std::fabs(scaled);
    return std::copysign(unstretched(unstretched(magnitude, growth), growth), scaled);
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
        case Kind::companded:
            return static_cast<float>(step * stretched(stretched(k, growth), growth));
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
    const double k = kind == Kind::ratio  ? double(value) * divisor
                     : kind == Kind::step ? double(value) * (1 / step)
                                          : uncompanded(double(value) / step, growth);
    if (!(std::fabs(k) <= kMostInteger)) return {};
    return static_cast<std::int32_t>(k < 0 ? k - 0.5 : k + 0.5);
}

WAVEFOG_VECTOR_CLONES
void Scale::densities(const std::int32_t* from, std::size_t count, float* to) const {
    std::int32_t used = 0;  // bits of the magnitudes, less 1 below 0
    for (std::size_t i = 0; i < count; ++i) used |= from[i] ^ from[i] >> 31;
    if (kind == Kind::ratio && used < kExactFloats && divisor <= kExactFloats) {
        // The quotient of floats, rounded once, is the same: that of doubles is never halfway
        // between two floats, n / 2^s with n odd and above 2^24, as n would divide k. Off by at
        // least 1 / (n divisor) of itself, over 2^-49, it keeps its side when it is rounded to a
        // double.
        const auto by = static_cast<float>(divisor);
        for (std::size_t i = 0; i < count; ++i) to[i] = static_cast<float>(from[i]) / by;
    } else if (kind == Kind::ratio) {
        const double by = divisor;
        for (std::size_t i = 0; i < count; ++i)
            to[i] = static_cast<float>(static_cast<double>(from[i]) / by);
    } else if (kind == Kind::step) {
        const double by = step;
        for (std::size_t i = 0; i < count; ++i)
            to[i] = static_cast<float>(static_cast<double>(from[i]) * by);
    } else if (kind == Kind::companded) {
        for (std::size_t i = 0; i < count; ++i)
            to[i] = static_cast<float>(step * stretched(stretched(from[i], growth), growth));
    } else {
        std::transform(from, from + count, to, [this](std::int32_t k) { return density(k); });
    }
}

WAVEFOG_VECTOR_CLONES
bool Scale::integers(const float* from, std::size_t count, std::int32_t* to) const {
    if (kind == Kind::float_bits || kind == Kind::table)
        return std::all_of(from, from + count, [&](float value) {
            const auto k = integer(value);
            *to++ = k.value_or(0);
            return k.has_value();
        });
    std::int32_t largest = 0;  // of the bits without sign, which rise with the magnitude; NaN last
    for (std::size_t i = 0; i < count; ++i) {
        const std::int32_t bits = std::bit_cast<std::int32_t>(from[i]) & 0x7fffffff;
        largest = largest < bits ? bits : largest;
    }
    // The loops have no branches, so that compilers make vectors of them.
    if (kind == Kind::ratio && divisor < kExactFloats &&
        double(std::bit_cast<float>(largest)) * divisor < kNearIntegers) {
        // Densities of the scale are near an integer; what is not may be rounded either way.
        const auto by = static_cast<float>(divisor);
        for (std::size_t i = 0; i < count; ++i) {
            const float k = from[i] * by;
            to[i] = static_cast<std::int32_t>(k + std::copysign(0.5f, k));
        }
        return true;
    }
    const auto convert = [&](auto scaled) {
        if (scaled(double(std::bit_cast<float>(largest))) <= kMostInteger) {
            for (std::size_t i = 0; i < count; ++i) {
                const double k = scaled(static_cast<double>(from[i]));
                to[i] = static_cast<std::int32_t>(k + std::copysign(0.5, k));
            }
            return true;
        }
        for (std::size_t i = 0; i < count; ++i) {
            const double k = scaled(static_cast<double>(from[i]));
            const bool fits = std::fabs(k) <= kMostInteger;  // NaN does not
            to[i] = static_cast<std::int32_t>(fits ? k + std::copysign(0.5, k) : 0.0);
        }
        return false;
    };
    if (kind == Kind::step) return convert([by = 1 / step](double value) { return value * by; });
    if (kind == Kind::companded)
        return convert(
            [by = step, more = growth](double value) { return uncompanded(value / by, more); });
    return convert([by = static_cast<double>(divisor)](double value) { return value * by; });
}

WAVEFOG_VECTOR_CLONES
float largest_difference(const float* a, const float* b, std::size_t count) {
    // The bits of floats that are not negative rise with them, and compare as fast as integers.
    std::int32_t most = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const auto difference = static_cast<float>(double(a[i]) - double(b[i]));
        const std::int32_t bits = std::bit_cast<std::int32_t>(difference) & 0x7fffffff;
        most = most < bits ? bits : most;
    }
    // A difference is at most the float after the one that it was rounded to.
    return std::bit_cast<float>(most == 0 ? 0 : most + 1);
}

namespace {

/// Every density is one of the scale's, up to `tolerance`.
bool has_all(const Scale& scale, const Grid<float>& map, double tolerance) {
    constexpr std::size_t kBlock = 1024;
    std::array<std::int32_t, kBlock> integers;
    std::array<float, kBlock> back;
    const auto size = static_cast<std::size_t>(map.size());
    for (std::size_t at = 0; at < size; at += kBlock) {
        const float* const values = map.data() + at;
        const std::size_t count = std::min(kBlock, size - at);
        if (!scale.integers(values, count, integers.data())) return false;
        scale.densities(integers.data(), count, back.data());
        if (std::memcmp(back.data(), values, count * sizeof(float)) == 0) continue;
        if (!(double(largest_difference(back.data(), values, count)) <= tolerance)) return false;
    }
    return true;
}

/// The value of that rank, counted from the least; near the last one.
float ranked(const Grid<float>& map, std::size_t rank) {
    const float* const begin = map.data();
    const float* const end = begin + map.size();
    const auto nth = [](std::vector<float>& values, std::size_t n) {
        std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(n),
                         values.end());
        return values[n];
    };
    // A sample tells from where on to look, so that few have to be sorted.
    constexpr std::ptrdiff_t kEvery = 61;
    std::vector<float> some;
    for (const float* value = begin; value < end; value += std::min(kEvery, end - value))
        some.push_back(*value);
    const float from = nth(some, some.size() * 99 / 100);
    some.clear();
    std::copy_if(begin, end, std::back_inserter(some), [&](float value) { return value >= from; });
    const auto below = static_cast<std::size_t>(map.size()) - some.size();
    if (rank >= below) return nth(some, rank - below);
    some.assign(begin, end);
    return nth(some, rank);
}

}  // namespace

std::optional<Scale> ratio_of(const Grid<float>& map, double slack) {
    const double largest = map.size() > 0 ? double(map.abs().maxCoeff()) : 0;
    for (const std::uint32_t divisor : {255u, 1u, 65535u, 10u, 100u, 1000u, 10000u, 2u, 4u, 8u, 16u,
                                        32u, 64u, 128u, 256u, 1024u}) {
        const Scale scale{.kind = Scale::Kind::ratio, .divisor = divisor};
        const double tolerance = largest * slack;
        // A grid finer than the tolerance would fit anything.
        if (tolerance * divisor > 0.1) continue;
        if (!has_all(scale, map, tolerance)) continue;
        if (divisor == 255 || divisor == 65535) return scale;
        // Steps of 4/100 are steps of 1/25.
        for (std::uint32_t fewer = 1; fewer < divisor; ++fewer) {
            const Scale coarser{.kind = Scale::Kind::ratio, .divisor = fewer};
            if (divisor % fewer == 0 && has_all(coarser, map, tolerance)) return coarser;
        }
        return scale;
    }
    return {};
}

Scale companded_scale(double step, double coarseness, double most) {
    // Steps grow by a (of q at k, a = 1 + 2 growth q(k)) times sqrt(2 a - 1) (of q at q(k)).
    double low = 1, high = coarseness;
    for (int i = 0; i < 60; ++i) {
        const double a = (low + high) / 2;
        (a * std::sqrt(2 * a - 1) < coarseness ? low : high) = a;
    }
    const double growth = std::min((low * low - 1) * step / (4 * most), 1.0);
    return {.kind = Scale::Kind::companded, .step = step, .growth = growth};
}

double mean_coarseness(const Scale& companded, const Grid<float>& map) {
    double sum = 0;
    for (Eigen::Index i = 0; i < map.size(); ++i) {
        const double scaled = std::fabs(double(map.data()[i])) / companded.step;
        const double a = std::sqrt(1 + 4 * companded.growth * scaled);
        sum += std::log2(a * std::sqrt(2 * a - 1));
    }
    return map.size() > 0 ? sum / static_cast<double>(map.size()) : 0;
}

Scale exact_scale(const Grid<float>& map, std::size_t uses) {
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
    if (bits.size() <= kMaxTable && bits.size() * uses <= pixels) {
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
    const auto hot = static_cast<std::size_t>(static_cast<double>(map.size()) * 0.999);
    const double range = double(ranked(map, hot)) - least;
    return range > 0 ? range : most - least;
}

}  // namespace wavefog::wfog
