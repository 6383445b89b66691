#include "token_stream.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <cstring>

#include "context_mixer.h"
#include "vector_clones.h"

namespace wavefog::wfog {

namespace {

using std::size_t;
using std::uint32_t;
using std::uint64_t;
using std::uint8_t;

constexpr unsigned kScaleBits = 12;
constexpr uint32_t kScale = 1u << kScaleBits;
constexpr uint32_t kSlots = kScale - 1;  ///< mask
constexpr uint32_t kLowestState = 1u << 16;
constexpr unsigned kLargest = kTokens - 1;
constexpr unsigned kMaxShift = 20;
constexpr uint32_t kNearlyCertain = 3900;  ///< the frequency of a token

/// One state instead of four where their bytes would weigh.
size_t states_for(size_t count) {
    return count < 4096 ? 1 : 4;
}

struct Frequencies {
    std::array<std::uint16_t, kTokens> frequency, start;
};

Frequencies frequencies_of(const TokenModel& model) {
    Frequencies f;
    float left = 1;
    uint32_t sum = 0;
    size_t largest = 0;
    for (size_t t = 0; t < kTokens; ++t) {
        const float stop =
            t == kLargest
                ? 1.0f
                : mixer_tables().squash[size_t(model.stops[std::min<size_t>(t, 3)]) * 16 + 8];
        const float here = left * stop;
        left = left - here;
        // The last 16 of the scale make sure that every token has one.
        f.frequency[t] =
            static_cast<std::uint16_t>(1 + static_cast<int>(here * float(kScale - 32)));
        sum += f.frequency[t];
        if (f.frequency[t] > f.frequency[largest]) largest = t;
    }
    f.frequency[largest] = static_cast<std::uint16_t>(f.frequency[largest] + kScale - sum);
    sum = 0;
    for (size_t t = 0; t < kTokens; ++t) {
        f.start[t] = static_cast<std::uint16_t>(sum);
        sum += f.frequency[t];
    }
    return f;
}

/// `frequency(c)`: of zeros in context c. How many contexts, from the first on, in which zeros are
/// nearly certain: runs of them are worth a way of their own.
template <class Frequency>
unsigned count_quiet(Frequency frequency) {
    unsigned quiet = 0;
    while (quiet < kTokenContexts && frequency(quiet) >= kNearlyCertain) ++quiet;
    return quiet;
}

/// `counts`: of each token.
TokenModel model_of(const uint32_t* counts, unsigned shift) {
    TokenModel model;
    model.used = true;
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

std::int32_t with_sign(uint32_t magnitude, uint32_t negative) {
    return static_cast<std::int32_t>((magnitude ^ (0 - negative)) + negative);
}
uint32_t sign_of(std::int32_t value) {
    return static_cast<uint32_t>(value) >> 31;
}

/// Contexts below `first` have no shift. Whether eight of them, side by side, are such.
bool unshifted(const uint8_t* eight_contexts, unsigned first) {
    uint64_t eight;
    std::memcpy(&eight, eight_contexts, sizeof eight);
    return ((eight + (0x80 - first) * 0x0101010101010101u) & 0x8080808080808080u) == 0;
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

/// Low byte first; compilers make one load of each.
uint32_t word_at(const uint8_t* bytes) {
    return uint32_t(bytes[0]) | uint32_t(bytes[1]) << 8;
}
uint64_t eight_bytes_at(const uint8_t* bytes) {
    uint64_t value = 0;
    for (unsigned i = 0; i < 8; ++i) value |= uint64_t(bytes[i]) << (8 * i);
    return value;
}

}  // namespace

void write_symbols(std::span<const std::int32_t> values, std::span<const uint8_t> contexts,
                   Scratch& scratch, Bytes& stream) {
    const Scratch::Mark before = scratch.mark();
    const size_t count = values.size();
    const std::span<std::uint16_t> indices = scratch.take<std::uint16_t>(count);
    const bool beyond = find_indices(values.data(), contexts.data(), count, indices.data());
    Counts counts = count_indices(indices);
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

SymbolReader::SymbolReader(View stream, size_t count) : state_count_(states_for(count)) {
    Reader head(stream);
    const uint64_t used = head.length();
    if (used >> kTokenContexts != 0) failed_ = true;
    slots_ = std::make_unique_for_overwrite<uint8_t[]>(
        kScale * (1 + size_t(std::popcount(used & ((1u << kTokenContexts) - 1)))));
    uint8_t* slots = slots_.get();
    std::fill_n(slots, kScale, static_cast<uint8_t>(kTokens));
    for (size_t c = 0; c < kTokenContexts && !failed_; ++c) {
        Context& context = contexts_[c];
        context.tokens = slots_.get();
        context.shares[kTokens].frequency = kScale;  // leaves the state as it is
        if (!(used >> c & 1)) continue;
        TokenModel model;
        model.shift = static_cast<uint8_t>(head.byte());
        for (uint8_t& stop : model.stops) stop = static_cast<uint8_t>(head.byte());
        if (model.shift > kMaxShift) failed_ = true;
        const Frequencies f = frequencies_of(model);
        context.shift = model.shift;
        if (model.shift > 0) first_shifted_ = std::min(first_shifted_, static_cast<unsigned>(c));
        slots += kScale;
        context.tokens = slots;
        for (size_t t = 0; t < kTokens; ++t) {
            context.shares[t] = {f.frequency[t], f.start[t]};
            std::fill_n(slots + f.start[t], f.frequency[t], static_cast<uint8_t>(t));
        }
    }
    quiet_ = count_quiet([&](size_t c) { return contexts_[c].shares[0].frequency; });
    for (size_t c = 0; c < kTokenContexts; ++c)
        others_[c] = kScale - contexts_[c].shares[0].frequency;
    const uint64_t words = head.length();
    for (size_t s = 0; s < state_count_; ++s) states_[s] = static_cast<uint32_t>(head.fixed(4));
    if (head.failed() || words > head.left() / 2) {
        failed_ = true;
        return;
    }
    words_ = head.take(words * 2);
    bits_ = head.take(head.left());
}

void SymbolReader::fill_buffer() {
    if (bit_byte_ + 8 <= bits_.size()) {
        buffer_ |= eight_bytes_at(bits_.data() + bit_byte_) << buffered_;
        const unsigned whole = (63 - buffered_) / 8;
        bit_byte_ += whole;
        buffered_ += 8 * whole;
        return;
    }
    while (buffered_ <= 56) {  // zeros after the end
        const uint64_t byte = bit_byte_ < bits_.size() ? bits_[bit_byte_++] : 0;
        buffer_ |= byte << buffered_;
        buffered_ += 8;
    }
}

inline uint32_t SymbolReader::bits(unsigned count) {
    if (buffered_ < count) fill_buffer();
    const auto value = static_cast<uint32_t>(buffer_ & ((uint64_t(1) << count) - 1));
    buffer_ >>= count;
    buffered_ -= count;
    return value;
}

void SymbolReader::read_tokens(const uint8_t* contexts, size_t count) {
    const auto next = [this](uint32_t x, uint8_t context, uint8_t& token, uint32_t word,
                             unsigned& taken) {
        const Context& c = contexts_[context];
        const uint32_t slot = x & kSlots;
        token = c.tokens[slot];
        const Share share = c.shares[token];
        x = share.frequency * (x >> kScaleBits) + slot - share.start;
        taken = x < kLowestState ? 1 : 0;
        return x << (16 * taken) | (word & (0 - taken));
    };
    const auto one = [&](size_t i) {
        unsigned taken;
        const uint32_t word = word_ + 2 <= words_.size() ? word_at(&words_[word_]) : 0;
        states_[turn_] = next(states_[turn_], contexts[i], tokens_[i], word, taken);
        word_ += 2 * taken;
        turn_ = turn_ + 1 == state_count_ ? 0 : turn_ + 1;
    };
    size_t i = 0;
    if (state_count_ == kStates) {
        for (; turn_ != 0 && i < count; ++i) one(i);
        uint32_t a = states_[0], b = states_[1], c = states_[2], d = states_[3];
        uint8_t* const tokens = tokens_.data();
        const uint8_t* word = words_.data() + std::min(word_, words_.size());
        const uint8_t* const begin = word;
        const uint8_t* const end = words_.data() + words_.size();
        const auto four = [&] {
            unsigned taken;
            a = next(a, contexts[i], tokens[i], word_at(word), taken);
            word += 2 * taken;
            b = next(b, contexts[i + 1], tokens[i + 1], word_at(word), taken);
            word += 2 * taken;
            c = next(c, contexts[i + 2], tokens[i + 2], word_at(word), taken);
            word += 2 * taken;
            d = next(d, contexts[i + 3], tokens[i + 3], word_at(word), taken);
            word += 2 * taken;
        };
        const auto more = [&] {
            return i + kStates <= count && end - word >= std::ptrdiff_t(2 * kStates);
        };
        if (quiet_ == 0) {
            for (; more(); i += kStates) four();
        } else {
            // In quiet contexts, four zeros and no word are foreseen: a step without the tables.
            const uint32_t loud = (0x80 - quiet_) * 0x01010101u;  // sets bit 7 of other contexts
            const auto zeros = [&] {
                uint32_t around;
                std::memcpy(&around, contexts + i, sizeof around);
                if (((around + loud) & 0x80808080) != 0) return false;
                const uint64_t u = others_[contexts[i]], v = others_[contexts[i + 1]],
                               w = others_[contexts[i + 2]], z = others_[contexts[i + 3]];
                const uint64_t p = a - (a >> kScaleBits) * u, q = b - (b >> kScaleBits) * v,
                               r = c - (c >> kScaleBits) * w, s = d - (d >> kScaleBits) * z;
                const uint64_t beyond = ((a & kSlots) + u) | ((b & kSlots) + v) |
                                        ((c & kSlots) + w) | ((d & kSlots) + z);
                const uint64_t below = (p - kLowestState) | (q - kLowestState) |
                                       (r - kLowestState) | (s - kLowestState);
                if (((beyond & kScale) | below >> 63) != 0) return false;
                a = static_cast<uint32_t>(p);
                b = static_cast<uint32_t>(q);
                c = static_cast<uint32_t>(r);
                d = static_cast<uint32_t>(s);
                std::memset(tokens + i, 0, kStates);
                return true;
            };
            for (; more(); i += kStates)
                if (!zeros()) four();
        }
        word_ += size_t(word - begin);
        states_ = {a, b, c, d};
    }
    for (; i < count; ++i) one(i);
}

/// A magnitude whose token is not one itself.
uint32_t SymbolReader::escaped(unsigned token) {
    if (token > kLargest) {  // in a context that the stream says is unused
        failed_ = true;
        return 0;
    }
    const unsigned length = std::max(bits(5), 1u);
    return kLargest - 1 + (1u << (length - 1) | bits(length - 1));
}

void SymbolReader::read_each(const uint8_t* contexts, const uint8_t* tokens, size_t count,
                             std::int32_t* values) {
    for (size_t i = 0; i < count; ++i) {
        const unsigned token = tokens[i];
        uint32_t m = token;
        if (token >= kLargest) [[unlikely]]
            m = escaped(token);
        const unsigned shift = contexts_[contexts[i]].shift;
        m = (m << shift | bits(shift)) & 0x3fffffff;
        values[i] = with_sign(m, bits(m > 0 ? 1 : 0));
    }
}

/// Eight at once where there are no shifts: signs are as good as random, so there are no branches
/// on them.
void SymbolReader::read_values(const uint8_t* contexts, size_t count, std::int32_t* values) {
    constexpr size_t kAtOnce = 8;
    const unsigned first_shifted = first_shifted_;
    size_t i = 0;
    for (; i + kAtOnce <= count; i += kAtOnce) {
        const uint8_t* const tokens = &tokens_[i];
        const uint64_t all = eight_bytes_at(tokens);
        // A byte of 15 or more has bit 4 after 1 is added.
        if (((all + 0x0101010101010101u) & 0x1010101010101010u) != 0 ||
            !unshifted(contexts + i, first_shifted)) {
            read_each(contexts + i, tokens, kAtOnce, values + i);
            continue;
        }
        if (all == 0) {
            std::fill_n(values + i, kAtOnce, 0);
            continue;
        }
        if (buffered_ < kAtOnce) fill_buffer();
        uint64_t signs = buffer_;
        unsigned used = 0;
        for (size_t k = 0; k < kAtOnce; ++k) {
            const uint32_t m = tokens[k];
            const unsigned has_sign = m > 0 ? 1 : 0;
            values[i + k] = with_sign(m, static_cast<uint32_t>(signs) & has_sign);
            signs >>= has_sign;
            used += has_sign;
        }
        buffer_ = signs;
        buffered_ -= used;
    }
    read_each(contexts + i, tokens_.data() + i, count - i, values + i);
}

void SymbolReader::read(const uint8_t* contexts, size_t count, std::int32_t* values) {
    if (failed_) {
        std::fill_n(values, count, 0);
        return;
    }
    if (tokens_.size() < count) tokens_.resize(count);
    read_tokens(contexts, count);
    read_values(contexts, count, values);
}

}  // namespace wavefog::wfog
