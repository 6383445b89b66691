// Tokens of 16 kinds in contexts, by range asymmetric numeral systems (J. Duda, 2009) with tables
// that the stream describes, and plain bits beside them.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "bytes.h"
#include "scratch.h"

namespace wavefog::wfog {

inline constexpr std::size_t kTokens = 16;         ///< magnitudes 0..14, and "larger"
inline constexpr std::size_t kTokenContexts = 20;  ///< classes of activity

/// Appends the code of signed integers, each in a context below kTokenContexts: nothing, if all
/// are 0.
void write_symbols(std::span<const std::int32_t> values, std::span<const std::uint8_t> contexts,
                   Scratch& scratch, Bytes& stream);

/// Reads symbols back in any number of calls.
class SymbolReader {
  public:
    SymbolReader(View stream, std::size_t count);
    bool failed() const { return failed_; }
    /// The next `count` symbols.
    void read(const std::uint8_t* contexts, std::size_t count, std::int32_t* values);

  private:
    static constexpr std::size_t kStates = 4;
    /// Of a token; the one behind the last stands for a context that the stream does not have.
    struct Share {
        std::uint16_t frequency = 0, start = 0;
    };
    struct Context {
        std::array<Share, kTokens + 1> shares;
        const std::uint8_t* tokens = nullptr;  ///< of each of 4096 slots
        unsigned shift = 0;
    };
    void read_tokens(const std::uint8_t* contexts, std::size_t count);
    void read_each(const std::uint8_t* contexts, const std::uint8_t* tokens, std::size_t count,
                   std::int32_t* values);
    void read_values(const std::uint8_t* contexts, std::size_t count, std::int32_t* values);
    std::uint32_t escaped(unsigned token);
    void fill_buffer();
    std::uint32_t bits(unsigned count);

    std::array<Context, kTokenContexts> contexts_;
    std::unique_ptr<std::uint8_t[]> slots_;
    std::vector<std::uint8_t> tokens_;                       ///< of one call
    unsigned first_shifted_ = kTokenContexts;                ///< contexts below have no shift
    std::array<std::uint32_t, kTokenContexts> others_ = {};  ///< frequency of all tokens but zero
    unsigned quiet_ = 0;  ///< so many contexts, from the first on, have hardly anything but zeros
    std::array<std::uint32_t, kStates> states_{};
    View words_, bits_;
    std::size_t word_ = 0, bit_byte_ = 0;
    std::uint64_t buffer_ = 0;
    unsigned buffered_ = 0;
    std::size_t turn_ = 0, state_count_ = kStates;
    bool all_zero_ = false, failed_ = false;
};

}  // namespace wavefog::wfog
