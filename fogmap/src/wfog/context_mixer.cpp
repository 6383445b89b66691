#include "context_mixer.h"

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
    }
    // An estimate that has seen little is believed little.
    constexpr float trust[5] = {0.0f, 0.5f, 0.7f, 0.85f, 1.0f};
    for (std::size_t n = 0; n < paces.size(); ++n)
        paces[n] = {trust[n < 4 ? n : 4], static_cast<std::uint16_t>(65536 * 5 / (5 * n + 8))};
}

const MixerTables& mixer_tables() {
    static const MixerTables tables;
    return tables;
}

ContextMixer::ContextMixer(const std::array<std::uint32_t, kContexts>& sizes)
    : group_(std::size_t(std::accumulate(sizes.begin(), sizes.end(), 0u)) * kTogether),
      estimates_(group_ * (kNodes / kTogether)),
      first_(kNodes * kFirstSets * kInputs, 0.2f),
      second_(kNodes * kSecondSets * kInputs, 0.2f) {
    static_assert(kNodes % kTogether == 0);
    std::exclusive_scan(sizes.begin(), sizes.end(), starts_.begin(), 0u);
}

[[gnu::always_inline]] inline float ContextMixer::squash(float x) const {
    const int i = static_cast<int>(x * 170.0f + 2048.0f);
    return tables_.squash[static_cast<std::size_t>(i < 0 ? 0 : i > 4095 ? 4095 : i)];
}

// Four sums side by side: an order that vector units can keep.
[[gnu::always_inline]] inline float ContextMixer::dot(const float* a, const float* b) {
    float sum[4] = {0, 0, 0, 0};
    for (std::size_t i = 0; i < kInputs; i += 4)
        for (std::size_t k = 0; k < 4; ++k) sum[k] += a[i + k] * b[i + k];
    return (sum[0] + sum[1]) + (sum[2] + sum[3]);
}

[[gnu::always_inline]] inline void ContextMixer::learn(float* weights, const float* in,
                                                       float error) {
    // Bounded, so that no input however long can reach infinity.
    for (std::size_t i = 0; i < kInputs; ++i) {
        const float w = weights[i] + error * in[i];
        weights[i] = w > 16.0f ? 16.0f : w < -16.0f ? -16.0f : w;
    }
}

template <class Coder>
[[gnu::always_inline]] inline int ContextMixer::code_by(Coder& coder, int bit, int node,
                                                        int first_set, int second_set) {
    const MixerTables& tables = tables_;
    alignas(32) std::array<float, kInputs> in;
    alignas(32) std::array<std::uint16_t, kLanes> p{}, seen{}, rates{};
    Estimate* const estimates = of_node(node);
    for (std::size_t i = 0; i < kContexts; ++i) {
        const Estimate e = estimates[places_[i]];
        const Pace& pace = tables.paces[e.seen];
        p[i] = e.p;
        seen[i] = e.seen;
        rates[i] = pace.rate;
        in[i] = tables.stretch[e.p >> 4] * pace.trust;
    }
    in[kContexts] = 0.4f;
    in[kContexts + 1] = 0.0f;
    float* const first = &first_[std::size_t(node * kFirstSets + first_set) * kInputs];
    float* const second = &second_[std::size_t(node * kSecondSets + second_set) * kInputs];
    const float x = dot(first, in.data()), y = dot(second, in.data());
    const float mixed = squash((x + y) * 0.5f) * 65536.0f;
    const int one = static_cast<int>(mixed);
    bit = coder.code(bit, static_cast<std::uint32_t>(one < 1 ? 1 : one > 65535 ? 65535 : one));

    constexpr float rate = 0.01f;
    const float truth = bit ? 1.0f : 0.0f;
    learn(first, in.data(), (truth - squash(x)) * rate);
    learn(second, in.data(), (truth - squash(y)) * rate);
    // Towards 65535 or 0 by the rate's share of the way, rounded down.
    const auto flip = static_cast<std::uint16_t>(bit ? 0xffff : 0);
    for (std::size_t i = 0; i < kLanes; ++i) {
        const auto q = static_cast<std::uint16_t>(p[i] ^ flip);
        const auto way = static_cast<std::uint16_t>(std::uint32_t(q) * rates[i] >> 16);
        p[i] = static_cast<std::uint16_t>((q - way) ^ flip);
        seen[i] = static_cast<std::uint16_t>(seen[i] + (seen[i] < kMostSeen ? 1 : 0));
    }
    for (std::size_t i = 0; i < kContexts; ++i) estimates[places_[i]] = {p[i], seen[i]};
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
