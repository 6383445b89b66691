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
        for (std::size_t i = 0; i < kContexts; ++i) {
            Estimate& e =
                estimates_[i][context[i] * std::uint32_t(kNodes) + static_cast<unsigned>(node)];
            estimates[i] = &e;
            // An estimate that has seen little is believed little.
            constexpr float trust[4] = {0.0f, 0.5f, 0.7f, 0.85f};
            const float stretched = tables.stretch[e.p >> 4];
            in[i] = e.seen < 4 ? stretched * trust[e.seen] : stretched;
        }
        in[kContexts] = 0.4f;
        in[kContexts + 1] = 0.0f;
        float* const first = &first_[std::size_t(node * kFirstSets + first_set) * kInputs];
        float* const second = &second_[std::size_t(node * kSecondSets + second_set) * kInputs];
        const float x = dot(first, in.data()), y = dot(second, in.data());
        const float mixed = squash((x + y) * 0.5f) * 65536.0f;
        const int p = static_cast<int>(mixed);
        bit = coder.code(bit, static_cast<std::uint32_t>(p < 1 ? 1 : p > 65535 ? 65535 : p));

        constexpr float rate = 0.01f;
        const float truth = bit ? 1.0f : 0.0f;
        learn(first, in.data(), (truth - squash(x)) * rate);
        learn(second, in.data(), (truth - squash(y)) * rate);
        const int target = bit ? 65535 : 0;
        for (Estimate* e : estimates) {
            const int step = (target - int(e->p)) * int(tables.rates[e->seen]) / 65536;
            e->p = static_cast<std::uint16_t>(int(e->p) + step);
            if (e->seen < kMostSeen) ++e->seen;
        }
        return bit;
    }

  private:
    static constexpr std::size_t kInputs = kContexts + 2;
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
