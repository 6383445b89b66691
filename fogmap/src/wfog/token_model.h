// What writer and reader of token streams share: probabilities of tokens, and which of them make
// quick ways worth it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "token_stream.h"

namespace wavefog::wfog {

inline constexpr unsigned kScaleBits = 12;
inline constexpr std::uint32_t kScale = 1u << kScaleBits;
inline constexpr std::uint32_t kSlots = kScale - 1;  ///< mask
inline constexpr std::uint32_t kLowestState = 1u << 16;
inline constexpr unsigned kLargest = kTokens - 1;
inline constexpr unsigned kMaxShift = 20;
inline constexpr std::uint32_t kNearlyCertain = 3900;  ///< the frequency of a token

/// What a stream says of one context. A magnitude m has the token min(m >> shift, 15).
struct TokenModel {
    std::uint8_t shift = 0;
    /// Logit of the probability that the token is i, given that it is at least i; the last for all
    /// larger ones. 16 to 256 steps of MixerTables::squash apart.
    std::array<std::uint8_t, 4> stops{};
};

/// One state instead of four where their bytes would weigh.
inline std::size_t states_for(std::size_t count) {
    return count < 4096 ? 1 : 4;
}

/// Of all tokens of a context, and where theirs begin among kScale slots.
struct Frequencies {
    std::array<std::uint16_t, kTokens> frequency, start;
};

Frequencies frequencies_of(const TokenModel& model);

/// `frequency(c)`: of zeros in context c. How many contexts, from the first on, in which zeros are
/// nearly certain: runs of them are worth a way of their own.
template <class Frequency>
unsigned count_quiet(Frequency frequency) {
    unsigned quiet = 0;
    while (quiet < kTokenContexts && frequency(quiet) >= kNearlyCertain) ++quiet;
    return quiet;
}

/// Contexts below `first` have no shift. Whether eight of them, side by side, are such.
inline bool unshifted(const std::uint8_t* eight_contexts, unsigned first) {
    std::uint64_t eight;
    std::memcpy(&eight, eight_contexts, sizeof eight);
    return ((eight + (0x80 - first) * 0x0101010101010101u) & 0x8080808080808080u) == 0;
}

}  // namespace wavefog::wfog
