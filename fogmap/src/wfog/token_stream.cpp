#include "token_stream.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdlib>

#include "context_mixer.h"

namespace wavefog::wfog {

namespace {

using std::size_t;
using std::uint32_t;
using std::uint64_t;
using std::uint8_t;

constexpr unsigned kScaleBits = 12;
constexpr uint32_t kScale = 1u << kScaleBits;
constexpr uint32_t kLowestState = 1u << 16;
constexpr unsigned kLargest = kTokens - 1;
constexpr unsigned kMaxShift = 20;

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

TokenModel model_of(const std::array<uint32_t, kTokens>& counts, unsigned shift) {
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

/// How many of each token in each context.
using Counts = std::array<std::array<uint32_t, kTokens>, kTokenContexts>;

/// Four tables side by side: runs of one token do not wait for each other's sums.
class Counter {
  public:
    void add(size_t place, unsigned context, uint32_t token) {
        ++parts_[place % parts_.size()][context][token];
    }
    Counts sum() const {
        Counts counts = parts_[0];
        for (size_t p = 1; p < parts_.size(); ++p)
            for (size_t c = 0; c < kTokenContexts; ++c)
                for (size_t t = 0; t < kTokens; ++t) counts[c][t] += parts_[p][c][t];
        return counts;
    }

  private:
    std::array<Counts, 4> parts_{};
};

class BitWriter {
  public:
    /// At most 32 bits; those above `count` are 0.
    void put(uint32_t value, unsigned count) {
        buffer_ |= uint64_t(value) << filled_;
        filled_ += count;
        if (filled_ >= 32) flush();
    }
    Bytes finish() {
        for (unsigned done = 0; done < filled_; done += 8, buffer_ >>= 8)
            bytes_.push_back(static_cast<uint8_t>(buffer_ & 0xff));
        return std::move(bytes_);
    }

  private:
    void flush() {
        for (int i = 0; i < 4; ++i, buffer_ >>= 8)
            bytes_.push_back(static_cast<uint8_t>(buffer_ & 0xff));
        filled_ -= 32;
    }

    Bytes bytes_;
    uint64_t buffer_ = 0;
    unsigned filled_ = 0;
};

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

/// Writes downwards from `word`, or leaves it where it is; what it would write there is
/// overwritten.
inline void take_in(uint32_t& state, const Step& step, std::uint16_t*& word) {
    uint32_t x = state;
    const unsigned full = x >= step.limit ? 1 : 0;
    word[-1] = static_cast<std::uint16_t>(x & 0xffff);
    word -= full;
    x >>= 16 * full;
    const auto quotient = static_cast<uint32_t>(Wide(x) * step.inverse >> 64);
    state = x + step.bias + quotient * step.complement;
}

/// Indices into `steps`; backwards, so that a decoder reads forwards. Returns where words begin.
std::uint16_t* take_in_all(const std::uint16_t* indices, size_t count, const Step* steps,
                           std::array<uint32_t, 4>& states, size_t state_count,
                           std::uint16_t* word) {
    size_t i = count;
    if (state_count == 1) {
        for (; i > 0; --i) take_in(states[0], steps[indices[i - 1]], word);
        return word;
    }
    for (; i % 4 != 0; --i) take_in(states[(i - 1) % 4], steps[indices[i - 1]], word);
    auto [a, b, c, d] = states;
    for (; i > 0; i -= 4) {
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

Bytes write_symbols(std::span<const std::int32_t> values, std::span<const uint8_t> contexts) {
    const size_t count = values.size();
    Counter plain;
    std::array<uint64_t, kTokenContexts> sums{}, seen{};
    for (size_t i = 0; i < count; ++i) {
        const uint32_t m = magnitude_of(values[i]);
        plain.add(i, contexts[i], std::min(m, uint32_t(kLargest)));
        if (m > kLargest) sums[contexts[i]] += m - kLargest;
    }
    Counts counts = plain.sum();
    // How large the magnitudes of each context are decides its shift.
    std::array<unsigned, kTokenContexts> shifts{};
    bool shifted = false;
    for (size_t c = 0; c < kTokenContexts; ++c) {
        for (size_t t = 0; t < kTokens; ++t) {
            seen[c] += counts[c][t];
            sums[c] += uint64_t(counts[c][t]) * t;
        }
        while (shifts[c] < kMaxShift && (sums[c] >> shifts[c]) > 5 * seen[c]) ++shifts[c];
        shifted = shifted || shifts[c] > 0;
    }
    if (shifted) {
        Counter again;
        for (size_t i = 0; i < count; ++i)
            again.add(i, contexts[i],
                      std::min(magnitude_of(values[i]) >> shifts[contexts[i]], uint32_t(kLargest)));
        counts = again.sum();
    }

    const auto indices = std::make_unique_for_overwrite<std::uint16_t[]>(count);
    BitWriter bits;
    for (size_t i = 0; i < count; ++i) {
        const unsigned c = contexts[i], shift = shifts[c];
        const uint32_t m = magnitude_of(values[i]);
        const uint32_t token = std::min(m >> shift, uint32_t(kLargest));
        indices[i] = static_cast<std::uint16_t>(c * kTokens + token);
        if (token == kLargest) {
            const uint32_t rest = (m >> shift) - kLargest + 1;
            const auto length = static_cast<unsigned>(std::bit_width(rest));
            bits.put(length, 5);
            bits.put(rest & ((1u << (length - 1)) - 1), length - 1);
        }
        if (shifted) bits.put(m & ((1u << shift) - 1), shift);
        bits.put(values[i] < 0 ? 1 : 0, m > 0 ? 1 : 0);
    }

    Writer stream;
    uint32_t used = 0;
    for (size_t c = 0; c < kTokenContexts; ++c) used |= seen[c] > 0 ? 1u << c : 0u;
    stream.length(used);
    std::array<Step, kTokenContexts * kTokens> steps;
    for (size_t c = 0; c < kTokenContexts; ++c) {
        if (seen[c] == 0) continue;
        const TokenModel model = model_of(counts[c], shifts[c]);
        const Frequencies f = frequencies_of(model);
        for (size_t t = 0; t < kTokens; ++t)
            steps[c * kTokens + t] = step_of(f.frequency[t], f.start[t]);
        stream.byte(model.shift);
        for (const uint8_t stop : model.stops) stream.byte(stop);
    }

    const size_t state_count = states_for(count);
    std::array<uint32_t, 4> states;
    states.fill(kLowestState);
    const auto words = std::make_unique_for_overwrite<std::uint16_t[]>(count + 1);
    std::uint16_t* const end = words.get() + count + 1;
    const std::uint16_t* const begin =
        take_in_all(indices.get(), count, steps.data(), states, state_count, end);
    stream.length(size_t(end - begin));
    for (size_t s = 0; s < state_count; ++s) stream.fixed(states[s], 4);
    Bytes& bytes = stream.bytes;
    const size_t at = bytes.size();
    bytes.resize(at + 2 * size_t(end - begin));
    uint8_t* to = bytes.data() + at;
    for (const std::uint16_t* word = begin; word != end; ++word, to += 2) {
        to[0] = static_cast<uint8_t>(*word & 0xff);
        to[1] = static_cast<uint8_t>(*word >> 8);
    }
    stream.append(bits.finish());
    return std::move(stream.bytes);
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
        shifts_ = shifts_ || model.shift > 0;
        slots += kScale;
        context.tokens = slots;
        for (size_t t = 0; t < kTokens; ++t) {
            context.shares[t] = {f.frequency[t], f.start[t]};
            std::fill_n(slots + f.start[t], f.frequency[t], static_cast<uint8_t>(t));
        }
    }
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

uint32_t SymbolReader::bits(unsigned count) {
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
        const uint32_t slot = x & (kScale - 1);
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
        auto [a, b, c, d] = states_;
        uint8_t* const tokens = tokens_.data();
        const uint8_t* word = words_.data() + std::min(word_, words_.size());
        const uint8_t* const begin = word;
        const uint8_t* const end = words_.data() + words_.size();
        unsigned taken;
        for (; i + kStates <= count && end - word >= std::ptrdiff_t(2 * kStates); i += kStates) {
            a = next(a, contexts[i], tokens[i], word_at(word), taken);
            word += 2 * taken;
            b = next(b, contexts[i + 1], tokens[i + 1], word_at(word), taken);
            word += 2 * taken;
            c = next(c, contexts[i + 2], tokens[i + 2], word_at(word), taken);
            word += 2 * taken;
            d = next(d, contexts[i + 3], tokens[i + 3], word_at(word), taken);
            word += 2 * taken;
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

template <bool kShifts>
void SymbolReader::read_values(const uint8_t* contexts, size_t count, std::int32_t* values) {
    for (size_t i = 0; i < count; ++i) {
        const unsigned token = tokens_[i];
        uint32_t m = token;
        if (token >= kLargest) [[unlikely]]
            m = escaped(token);
        if constexpr (kShifts) {
            const unsigned shift = contexts_[contexts[i]].shift;
            m = m << shift | bits(shift);
        }
        m &= 0x3fffffff;
        // Signs are as good as random: no branches on them.
        if (buffered_ == 0) fill_buffer();
        const unsigned has_sign = m > 0 ? 1 : 0;
        const auto negative = static_cast<uint32_t>(buffer_) & has_sign;
        buffer_ >>= has_sign;
        buffered_ -= has_sign;
        values[i] = static_cast<std::int32_t>((m ^ (0 - negative)) + negative);
    }
}

void SymbolReader::read(const uint8_t* contexts, size_t count, std::int32_t* values) {
    if (failed_) {
        std::fill_n(values, count, 0);
        return;
    }
    if (tokens_.size() < count) tokens_.resize(count);
    read_tokens(contexts, count);
    if (shifts_)
        read_values<true>(contexts, count, values);
    else
        read_values<false>(contexts, count, values);
}

}  // namespace wavefog::wfog
