// Probability of the next binary decision: adaptive estimates of several contexts, mixed in the
// logistic domain by weights that learn (M. Mahoney, "Adaptive weighing of context models for
// lossless data compression", 2005).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

namespace wavefog::wfog {

// Encoder and decoder must compute the same numbers on every machine: only +, -, * of IEEE 754
// floats in a fixed order, no fused operations (see CMakeLists.txt), and tables made of them.
static_assert(std::numeric_limits<float>::is_iec559 && std::numeric_limits<double>::is_iec559);

/// One adaptive estimate: the probability of a 1 and how many decisions it has seen.
struct Estimate {
    std::uint16_t p = 32768;
    std::uint16_t seen = 0;
};

struct MixerTables {
    std::array<float, 4096> stretch;       ///< ln(p / (1 - p)) of p = (i + 0.5) / 4096
    std::array<float, 4096> squash;        ///< 1 / (1 + exp(-x)), x = (i + 0.5 - 2048) / 170
    std::array<std::uint16_t, 256> rates;  ///< step of an estimate after so many decisions
    MixerTables();
};
const MixerTables& mixer_tables();

class ContextMixer {
  public:
    static constexpr int kContexts = 10;
    static constexpr int kNodes = 40;       ///< kinds of decisions
    static constexpr int kFirstSets = 12;   ///< weight sets of the first mixer, per node
    static constexpr int kSecondSets = 24;  ///< and of the second

    explicit ContextMixer(const std::array<std::uint32_t, kContexts>& sizes);

    /// The current context of each kind, below its size.
    std::array<std::uint32_t, kContexts> context{};

    /// Codes one decision of kind `node` and learns from it. A decoder ignores `bit`; both return
    /// the decision.
    template <class Coder>
    int code(Coder& coder, int bit, int node, int first_set, int second_set) {
        const MixerTables& tables = tables_;
        std::array<Estimate*, kContexts> estimates;
        alignas(16) std::array<float, kInputs> in;
        alignas(16) std::array<std::uint16_t, kLanes> p{}, seen{}, rates{};
        for (std::size_t i = 0; i < kContexts; ++i) {
            Estimate& e =
                estimates_[i][context[i] * std::uint32_t(kNodes) + static_cast<unsigned>(node)];
            estimates[i] = &e;
            p[i] = e.p;
            seen[i] = e.seen;
            rates[i] = tables.rates[e.seen];
            // An estimate that has seen little is believed little.
            constexpr float trust[5] = {0.0f, 0.5f, 0.7f, 0.85f, 1.0f};
            in[i] = tables.stretch[e.p >> 4] * trust[e.seen < 4 ? e.seen : 4];
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
        for (std::size_t i = 0; i < kContexts; ++i) *estimates[i] = {p[i], seen[i]};
        return bit;
    }

  private:
    static constexpr std::size_t kInputs = kContexts + 2;
    static constexpr std::size_t kLanes = 16;  ///< contexts, and what fills the vectors
    static constexpr std::uint16_t kMostSeen = 250;

    float squash(float x) const {
        const int i = static_cast<int>(x * 170.0f + 2048.0f);
        return tables_.squash[static_cast<std::size_t>(i < 0 ? 0 : i > 4095 ? 4095 : i)];
    }
    // Four sums side by side: an order that vector units can keep.
    static float dot(const float* a, const float* b) {
        float sum[4] = {0, 0, 0, 0};
        for (std::size_t i = 0; i < kInputs; i += 4)
            for (std::size_t k = 0; k < 4; ++k) sum[k] += a[i + k] * b[i + k];
        return (sum[0] + sum[1]) + (sum[2] + sum[3]);
    }
    static void learn(float* weights, const float* in, float error) {
        // Bounded, so that no input however long can reach infinity.
        for (std::size_t i = 0; i < kInputs; ++i) {
            const float w = weights[i] + error * in[i];
            weights[i] = w > 16.0f ? 16.0f : w < -16.0f ? -16.0f : w;
        }
    }

    const MixerTables& tables_ = mixer_tables();
    std::array<std::vector<Estimate>, kContexts> estimates_;
    std::vector<float> first_, second_;
};

}  // namespace wavefog::wfog
