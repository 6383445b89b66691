#include "context_mixer.h"

#include <algorithm>
#include <cstring>
#include <numeric>

#include "vector_clones.h"

namespace wavefog::wfog {

namespace {

// exp and ln from basic operations: the C library's may differ in the last bit.

double exponential(double x) {
    double sum = 1, term = 1;
    const double part = x / 64;  // |part| < 0.2
    for (int n = 1; n < 16; ++n) {
        term = term * part / n;
        sum = sum + term;
    }
    for (int i = 0; i < 6; ++i) sum = sum * sum;
    return sum;
}

double logarithm(double x) {
    constexpr double ln2 = 0.69314718055994531;
    double result = 0;
    for (; x > 1.5; x = x / 2) result = result + ln2;
    for (; x < 0.75; x = x * 2) result = result - ln2;
    const double z = (x - 1) / (x + 1);
    double power = z;
    for (int n = 1; n < 40; n += 2) {
        result = result + 2 * power / n;
        power = power * z * z;
    }
    return result;
}

}  // namespace

MixerTables::MixerTables() {
    for (std::size_t i = 0; i < stretch.size(); ++i) {
        const double p = (static_cast<double>(i) + 0.5) / 4096;
        stretch[i] = static_cast<float>(logarithm(p / (1 - p)));
        squash[i] =
            static_cast<float>(1 / (1 + exponential((2047.5 - static_cast<double>(i)) / 170)));
        chances[i] = static_cast<std::uint16_t>(std::max(squash[i] * 65536.0f, 1.0f));
    }
    // An estimate that has seen little is believed little.
    constexpr float trust[5] = {0.0f, 0.5f, 0.7f, 0.85f, 1.0f};
    for (std::size_t n = 0; n < paces.size(); ++n)
        paces[n] = {trust[n < 4 ? n : 4], static_cast<std::uint32_t>(65536 * 5 / (5 * n + 8))};
}

const MixerTables& mixer_tables() {
    static const MixerTables tables;
    return tables;
}

ContextMixer::ContextMixer(const std::array<std::uint32_t, kContexts>& sizes)
    : group_(std::size_t(std::accumulate(sizes.begin(), sizes.end(), 0u)) * kTogether),
      estimates_(group_ * (kNodes / kTogether), kNew),
      first_(kNodes * kFirstSets * kInputs, 0.2f),
      second_(kNodes * kSecondSets * kInputs, 0.2f) {
    static_assert(kNodes % kTogether == 0);
    std::exclusive_scan(sizes.begin(), sizes.end(), starts_.begin(), 0u);
}

// Vectors are made in registers: numbers that are stored one by one and loaded as a vector wait for
// each other.
using Floats = float __attribute__((vector_size(16)));
using Words = std::uint32_t __attribute__((vector_size(16)));
using Integers = std::int32_t __attribute__((vector_size(16)));

namespace {

constexpr std::size_t kVectors = 3;

/// The place of x in a table of 4096. Kept within by floats: the next decision waits for it.
[[gnu::always_inline]] inline std::size_t place_of(float x) {
    float i = x * 170.0f + 2048.0f;
    i = i > 0.0f ? i : 0.0f;
    i = i < 4095.0f ? i : 4095.0f;
    return static_cast<std::size_t>(static_cast<int>(i));
}

[[gnu::always_inline]] inline Floats load(const float* from) {
    Floats four;
    std::memcpy(&four, from, sizeof four);
    return four;
}

[[gnu::always_inline]] inline float dot(const float* weights, const Floats* in) {
    const Floats sum =
        load(weights) * in[0] + load(weights + 4) * in[1] + load(weights + 8) * in[2];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

[[gnu::always_inline]] inline void learn(float* weights, const Floats* in, float error) {
    // Bounded, so that no input however long can reach infinity.
    constexpr Floats most = {16, 16, 16, 16};
    for (std::size_t k = 0; k < kVectors; ++k) {
        Floats w = load(weights + 4 * k) + error * in[k];
        w = w > most ? most : w;
        w = w < -most ? -most : w;
        std::memcpy(weights + 4 * k, &w, sizeof w);
    }
}

}  // namespace

template <class Coder>
[[gnu::always_inline]] inline int ContextMixer::code_by(Coder& coder, int bit, int node,
                                                        int first_set, int second_set) {
    static_assert(kContexts == 10 && kInputs == 4 * kVectors);
    Estimate* const estimates = of_node(node);
    const auto estimate = [&](std::size_t i) -> Estimate& { return estimates[places_[i]]; };
    Words e[kVectors] = {{estimate(0), estimate(1), estimate(2), estimate(3)},
                         {estimate(4), estimate(5), estimate(6), estimate(7)},
                         {estimate(8), estimate(9), kNew, kNew}};
    const auto stretch = [&](std::size_t i) {
        return tables_.stretch[(estimate(i) & 0xffff) >> 4];
    };
    const auto trust = [&](std::size_t i) { return tables_.paces[estimate(i) >> 16].trust; };
    const auto rate = [&](std::size_t i) { return tables_.paces[estimate(i) >> 16].rate; };
    const Floats in[kVectors] = {
        Floats{stretch(0), stretch(1), stretch(2), stretch(3)} *
            Floats{trust(0), trust(1), trust(2), trust(3)},
        Floats{stretch(4), stretch(5), stretch(6), stretch(7)} *
            Floats{trust(4), trust(5), trust(6), trust(7)},
        Floats{stretch(8), stretch(9), 0.4f, 0.0f} * Floats{trust(8), trust(9), 1.0f, 1.0f}};
    const Words rates[kVectors] = {{rate(0), rate(1), rate(2), rate(3)},
                                   {rate(4), rate(5), rate(6), rate(7)},
                                   {rate(8), rate(9), 0, 0}};
    float* const first = &first_[std::size_t(node * kFirstSets + first_set) * kInputs];
    float* const second = &second_[std::size_t(node * kSecondSets + second_set) * kInputs];
    const float x = dot(first, in), y = dot(second, in);
    bit = coder.code(bit, tables_.chances[place_of((x + y) * 0.5f)]);

    constexpr float pace = 0.01f;
    const float truth = bit ? 1.0f : 0.0f;
    learn(first, in, (truth - tables_.squash[place_of(x)]) * pace);
    learn(second, in, (truth - tables_.squash[place_of(y)]) * pace);
    // Towards 65535 or 0 by the rate's share of the way, rounded down.
    const std::uint32_t flip = bit ? 0xffff : 0;
    for (std::size_t k = 0; k < kVectors; ++k) {
        const Words q = (e[k] & 0xffff) ^ flip, seen = e[k] >> 16;
        const Words way = (q * rates[k]) >> 16;
        const Words more = Words(Integers(seen) < kMostSeen) & 1;
        e[k] = ((q - way) ^ flip) | (seen + more) << 16;
    }
    for (std::size_t i = 0; i < kContexts; ++i) estimate(i) = e[i / 4][i % 4];
    return bit;
}

WAVEFOG_VECTOR_CLONES
int ContextMixer::code(RangeEncoder& coder, int bit, int node, int first_set, int second_set) {
    return code_by(coder, bit, node, first_set, second_set);
}

WAVEFOG_VECTOR_CLONES
int ContextMixer::code(RangeDecoder& coder, int bit, int node, int first_set, int second_set) {
    return code_by(coder, bit, node, first_set, second_set);
}

}  // namespace wavefog::wfog
