// Probability of the next binary decision: adaptive estimates of several contexts, mixed in the
// logistic domain by weights that learn (M. Mahoney, "Adaptive weighing of context models for
// lossless data compression", 2005).
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "range_coder.h"

namespace wavefog::wfog {

// Encoder and decoder must compute the same numbers on every machine: only +, -, *, / of IEEE 754
// floats in a fixed order, no fused operations (see CMakeLists.txt), and tables made of them.
static_assert(std::numeric_limits<float>::is_iec559 && std::numeric_limits<double>::is_iec559);

/// What an estimate does after so many decisions.
struct Pace {
    float trust;         ///< how far it is believed
    std::uint32_t rate;  ///< its step
};

struct MixerTables {
    std::array<float, 4096> stretch;          ///< ln(p / (1 - p)) of p = (i + 0.5) / 4096
    std::array<float, 4096> squash;           ///< 1 / (1 + exp(-x)), x = (i + 0.5 - 2048) / 170
    std::array<std::uint16_t, 4096> chances;  ///< the same of 65536, at least 1
    std::array<Pace, 256> paces;
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
    ContextMixer(const ContextMixer&) = delete;
    ContextMixer& operator=(const ContextMixer&) = delete;

    /// Codes one decision of kind `node` and learns from it. A decoder ignores `bit`; both return
    /// the decision.
    int code(RangeEncoder& coder, int bit, int node, int first_set, int second_set);
    int code(RangeDecoder& coder, int bit, int node, int first_set, int second_set);

    /// The context of a kind, below its size, until the next.
    void set(std::size_t kind, std::uint32_t context) { places_[kind] = place(kind, context); }
    /// The context will soon be set, for a decision of kind `node`.
    void expect(std::size_t kind, std::uint32_t context, int node) {
#ifdef __GNUC__
        __builtin_prefetch(of_node(node) + place(kind, context));
#endif
    }

  private:
    static constexpr std::size_t kInputs = kContexts + 2;
    static constexpr std::int32_t kMostSeen = 250;
    /// An adaptive estimate: the probability of a 1, of 65536, and in the bits above how many
    /// decisions it has seen.
    using Estimate = std::uint32_t;
    static constexpr Estimate kNew = 32768;

    // Those of a few kinds of decisions lie together for all contexts: most pixels need no others,
    // and all contexts' together are more than a cache holds.
    static constexpr int kTogether = 4;
    std::uint32_t place(std::size_t kind, std::uint32_t context) const {
        return (starts_[kind] + context) * std::uint32_t(kTogether);
    }
    Estimate* of_node(int node) {
        return estimates_.data() + std::size_t(node / kTogether) * group_ + node % kTogether;
    }
    template <class Coder>
    int code_by(Coder& coder, int bit, int node, int first_set, int second_set);

    const MixerTables& tables_ = mixer_tables();
    std::array<std::uint32_t, kContexts> starts_{}, places_{};  ///< of each kind, of its context
    std::size_t group_;                                         ///< estimates that lie together
    std::vector<Estimate> estimates_;
    std::vector<float> first_, second_;
};

}  // namespace wavefog::wfog
