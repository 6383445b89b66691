#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>

#include "token_model.h"
#include "token_stream.h"
#include "vector_clones.h"

namespace wavefog::wfog {

namespace {

using std::size_t;
using std::uint32_t;
using std::uint64_t;
using std::uint8_t;

/// `counts`: of each token.
TokenModel model_of(const uint32_t* counts, unsigned shift) {
    TokenModel model;
    model.shift = static_cast<uint8_t>(shift);
    std::array<double, 4> stopped{}, seen{};
    double at_least = 0;
    for (size_t t = kTokens; t-- > 0;) {
        at_least += counts[t];
        const size_t i = std::min<size_t>(t, 3);
        if (t == kLargest) continue;
        stopped[i] += counts[t];
        seen[i] += at_least;
    }
    for (size_t i = 0; i < 4; ++i) {
        const double p = (stopped[i] + 0.4) / (seen[i] + 0.8);
        const double place = (std::log(p / (1 - p)) * 170 + 2047.5 - 8) / 16;
        model.stops[i] = static_cast<uint8_t>(std::clamp(std::lround(place), 0l, 255l));
    }
    return model;
}

uint32_t magnitude_of(std::int32_t value) {
    return static_cast<uint32_t>(std::abs(value));
}

constexpr size_t kIndices = kTokenContexts * kTokens;

/// An index is context * kTokens + token. Returns whether any magnitude is above kLargest.
WAVEFOG_VECTOR_CLONES
bool find_indices(const std::int32_t* __restrict values, const uint8_t* __restrict contexts,
                  size_t count, std::uint16_t* __restrict indices) {
    std::int32_t beyond = 0;
    for (size_t i = 0; i < count; ++i) {
        const std::int32_t m = std::abs(values[i]);
        const std::int32_t token = m < std::int32_t(kLargest) ? m : std::int32_t(kLargest);
        beyond |= m - token;
        indices[i] = static_cast<std::uint16_t>(contexts[i] * std::int32_t(kTokens) + token);
    }
    return beyond != 0;
}

/// How many of each index.
using Counts = std::array<uint32_t, kIndices>;

Counts count_indices(std::span<const std::uint16_t> indices) {
    // Four tables side by side: runs of one index do not wait for each other's sums.
    std::array<Counts, 4> parts{};
    size_t i = 0;
    for (; i + 8 <= indices.size(); i += 8) {
        std::array<uint64_t, 2> eight;
        std::memcpy(eight.data(), &indices[i], sizeof eight);
        if (eight[0] == eight[1] && eight[0] == indices[i] * uint64_t(0x0001000100010001)) {
            parts[0][indices[i]] += 8;
            continue;
        }
        for (size_t p = 0; p < 8; ++p) ++parts[p % 4][indices[i + p]];
    }
    for (; i < indices.size(); ++i) ++parts[0][indices[i]];
    Counts counts{};
    for (size_t k = 0; k < kIndices; ++k)
        counts[k] = parts[0][k] + parts[1][k] + parts[2][k] + parts[3][k];
    return counts;
}

/// Plain bits, low first.
class BitWriter {
  public:
    BitWriter(size_t most_bytes, Scratch& scratch)
        : bytes_(scratch.take<uint8_t>(most_bytes + 8)), at_(bytes_.data()) {}

    /// At most 32 bits; those above `count` are 0.
    void put(uint32_t value, unsigned count) {
        buffer_ |= uint64_t(value) << filled_;
        filled_ += count;
        if (filled_ >= 32) {
            for (int i = 0; i < 4; ++i) at_[i] = static_cast<uint8_t>(buffer_ >> (8 * i) & 0xff);
            at_ += 4;
            buffer_ >>= 32;
            filled_ -= 32;
        }
    }
    View finish() {
        for (unsigned done = 0; done < filled_; done += 8, buffer_ >>= 8)
            *at_++ = static_cast<uint8_t>(buffer_ & 0xff);
        return {bytes_.data(), at_};
    }

  private:
    std::span<uint8_t> bytes_;
    uint8_t* at_;
    uint64_t buffer_ = 0;
    unsigned filled_ = 0;
};

/// The bits of a magnitude whose token is the last.
void put_escaped(uint32_t shifted_magnitude, BitWriter& bits) {
    const uint32_t rest = shifted_magnitude - kLargest + 1;
    const auto length = static_cast<unsigned>(std::bit_width(rest));
    bits.put(length, 5);
    bits.put(rest & ((1u << (length - 1)) - 1), length - 1);
}

uint32_t sign_of(std::int32_t value) {
    return static_cast<uint32_t>(value) >> 31;
}

/// One symbol's signs, and what its token leaves open; the token follows from the shift.
void put_rest(std::int32_t value, uint8_t context, unsigned shift, std::uint16_t& index,
              BitWriter& bits) {
    const uint32_t m = magnitude_of(value);
    const uint32_t token = std::min(m >> shift, uint32_t(kLargest));
    index = static_cast<std::uint16_t>(context * kTokens + token);
    if (token == kLargest) put_escaped(m >> shift, bits);
    bits.put(m & ((1u << shift) - 1), shift);
    bits.put(sign_of(value), m > 0 ? 1 : 0);
}

/// Signs and what tokens leave open. Indices are those without shifts, and become those with.
void put_plain_bits(std::span<const std::int32_t> values, const uint8_t* contexts,
                    const std::array<unsigned, kTokenContexts>& shifts, unsigned first_shifted,
                    std::uint16_t* indices, BitWriter& writer) {
    BitWriter bits = writer;  // nobody else sees it: it may live in registers
    constexpr size_t kAtOnce = 8;
    const auto put_each = [&](size_t begin, size_t end) {
        for (size_t k = begin; k < end; ++k)
            put_rest(values[k], contexts[k], shifts[contexts[k]], indices[k], bits);
    };
    size_t i = 0;
    for (; i + kAtOnce <= values.size(); i += kAtOnce) {
        unsigned some = 0, last = 0;
        for (size_t k = i; k < i + kAtOnce; ++k) {
            const unsigned token = indices[k] % kTokens;
            some |= token;
            last |= token == kLargest ? 1 : 0;
        }
        if (last != 0 || !unshifted(contexts + i, first_shifted)) {
            put_each(i, i + kAtOnce);
            continue;
        }
        if (some == 0) continue;
        uint32_t signs = 0;
        unsigned count = 0;
        for (size_t k = i; k < i + kAtOnce; ++k) {
            signs |= sign_of(values[k]) << count;
            count += values[k] != 0 ? 1 : 0;
        }
        bits.put(signs, count);
    }
    put_each(i, values.size());
    writer = bits;
}

/// How a state takes in a token: x / frequency * kScale + start + x % frequency without a division
/// (F. Giesen, "Interleaved entropy coders", 2014).
struct Step {
    uint64_t inverse = 0;  ///< 2^64 / frequency, rounded up: its product with 32 bits is exact
    uint32_t limit = 0;    ///< a state from here on gives 16 bits away first
    uint32_t bias = 0, complement = 0;
};

Step step_of(uint32_t frequency, uint32_t start) {
    Step step;
    step.limit = frequency << (32 - kScaleBits);
    step.complement = kScale - frequency;
    // 2^64 is too large for itself: one less makes quotients one too small.
    step.inverse = frequency == 1 ? ~uint64_t(0) : ~uint64_t(0) / frequency + 1;
    step.bias = frequency == 1 ? start + kScale - 1 : start;
    return step;
}

__extension__ using Wide = unsigned __int128;

/// By a token, a state that has room for it.
inline uint32_t taken_in(uint32_t state, const Step& step) {
    const auto quotient = static_cast<uint32_t>(Wide(state) * step.inverse >> 64);
    return state + step.bias + quotient * step.complement;
}

/// Writes downwards from `word`, or leaves it where it is; what it would write there is
/// overwritten.
inline void take_in(uint32_t& state, const Step& step, std::uint16_t*& word) {
    uint32_t x = state;
    const unsigned full = x >= step.limit ? 1 : 0;
    word[-1] = static_cast<std::uint16_t>(x & 0xffff);
    word -= full;
    x >>= 16 * full;
    state = taken_in(x, step);
}

/// Indices into `steps`; backwards, so that a decoder reads forwards. Returns where words begin.
/// `quiet`: as count_quiet() says.
std::uint16_t* take_in_all(const std::uint16_t* indices, size_t count, const Step* steps,
                           unsigned quiet, std::array<uint32_t, 4>& states, size_t state_count,
                           std::uint16_t* word) {
    size_t i = count;
    if (state_count == 1) {
        for (; i > 0; --i) take_in(states[0], steps[indices[i - 1]], word);
        return word;
    }
    for (; i % 4 != 0; --i) take_in(states[(i - 1) % 4], steps[indices[i - 1]], word);
    auto [a, b, c, d] = states;
    for (; i > 0; i -= 4) {
        uint64_t four;
        std::memcpy(&four, indices + i - 4, sizeof four);
        // Bit 15: a context that is not quiet. Lowest bits: tokens.
        if (((four + (0x8000 - quiet * kTokens) * 0x0001000100010001) & 0x800f800f800f800f) == 0) {
            // That a state is full is rare.
            const Step &of_a = steps[indices[i - 4]], &of_b = steps[indices[i - 3]],
                       &of_c = steps[indices[i - 2]], &of_d = steps[indices[i - 1]];
            if (a < of_a.limit && b < of_b.limit && c < of_c.limit && d < of_d.limit) [[likely]] {
                a = taken_in(a, of_a);
                b = taken_in(b, of_b);
                c = taken_in(c, of_c);
                d = taken_in(d, of_d);
                continue;
            }
        }
        take_in(d, steps[indices[i - 1]], word);
        take_in(c, steps[indices[i - 2]], word);
        take_in(b, steps[indices[i - 3]], word);
        take_in(a, steps[indices[i - 4]], word);
    }
    states = {a, b, c, d};
    return word;
}

}  // namespace

void write_symbols(std::span<const std::int32_t> values, std::span<const uint8_t> contexts,
                   Scratch& scratch, Bytes& stream) {
    const Scratch::Mark before = scratch.mark();
    const size_t count = values.size();
    const std::span<std::uint16_t> indices = scratch.take<std::uint16_t>(count);
    const bool beyond = find_indices(values.data(), contexts.data(), count, indices.data());
    Counts counts = count_indices(indices);
    size_t zeros_of_all = 0;
    for (size_t c = 0; c < kTokenContexts; ++c) zeros_of_all += counts[c * kTokens];
    if (zeros_of_all == count) {
        scratch.release(before);
        return;
    }
    // How large the magnitudes of each context are decides its shift.
    std::array<uint64_t, kTokenContexts> sums{}, seen{};
    if (beyond)
        for (size_t i = 0; i < count; ++i) {
            const uint32_t m = magnitude_of(values[i]);
            if (m > kLargest) sums[contexts[i]] += m - kLargest;
        }
    std::array<unsigned, kTokenContexts> shifts{};
    unsigned first_shifted = kTokenContexts;
    for (size_t c = kTokenContexts; c-- > 0;) {
        for (size_t t = 0; t < kTokens; ++t) {
            seen[c] += counts[c * kTokens + t];
            sums[c] += uint64_t(counts[c * kTokens + t]) * t;
        }
        while (shifts[c] < kMaxShift && (sums[c] >> shifts[c]) > 5 * seen[c]) ++shifts[c];
        if (shifts[c] > 0) first_shifted = static_cast<unsigned>(c);
    }
    // Signs and shifted bits of all, and of the last tokens up to 36 more; shifts make them fewer.
    uint64_t most_bits = 0;
    for (size_t c = 0; c < kTokenContexts; ++c)
        most_bits += seen[c] * (1 + shifts[c]) + counts[c * kTokens + kLargest] * uint64_t(36);
    BitWriter bits(most_bits / 8 + 1, scratch);
    put_plain_bits(values, contexts.data(), shifts, first_shifted, indices.data(), bits);
    if (first_shifted < kTokenContexts) counts = count_indices(indices);

    Writer head;
    uint32_t used = 0;
    for (size_t c = 0; c < kTokenContexts; ++c) used |= seen[c] > 0 ? 1u << c : 0u;
    head.length(used);
    std::array<Step, kIndices> steps;
    std::array<uint32_t, kTokenContexts> zeros{};
    for (size_t c = 0; c < kTokenContexts; ++c) {
        if (seen[c] == 0) continue;
        const TokenModel model = model_of(&counts[c * kTokens], shifts[c]);
        const Frequencies f = frequencies_of(model);
        zeros[c] = f.frequency[0];
        for (size_t t = 0; t < kTokens; ++t)
            steps[c * kTokens + t] = step_of(f.frequency[t], f.start[t]);
        head.byte(model.shift);
        for (const uint8_t stop : model.stops) head.byte(stop);
    }

    const unsigned quiet = count_quiet([&](size_t c) { return zeros[c]; });
    const size_t state_count = states_for(count);
    std::array<uint32_t, 4> states;
    states.fill(kLowestState);
    const std::span<std::uint16_t> words = scratch.take<std::uint16_t>(count + 1);
    std::uint16_t* const end = words.data() + words.size();
    const std::uint16_t* const begin =
        take_in_all(indices.data(), count, steps.data(), quiet, states, state_count, end);
    head.length(size_t(end - begin));
    for (size_t s = 0; s < state_count; ++s) head.fixed(states[s], 4);
    const View plain = bits.finish();
    stream.reserve(stream.size() + head.bytes.size() + 2 * size_t(end - begin) + plain.size());
    stream.insert(stream.end(), head.bytes.begin(), head.bytes.end());
    const size_t at = stream.size();
    stream.resize(at + 2 * size_t(end - begin));
    uint8_t* to = stream.data() + at;
    for (const std::uint16_t* word = begin; word != end; ++word, to += 2) {
        to[0] = static_cast<uint8_t>(*word & 0xff);
        to[1] = static_cast<uint8_t>(*word >> 8);
    }
    stream.insert(stream.end(), plain.begin(), plain.end());
    scratch.release(before);
}

}  // namespace wavefog::wfog
