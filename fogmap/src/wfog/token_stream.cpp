#include "token_stream.h"

#include <algorithm>
#include <bit>
#include <cmath>
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

class BitWriter {
  public:
    void put(uint32_t value, unsigned count) {
        buffer_ |= uint64_t(value) << filled_;
        for (filled_ += count; filled_ >= 8; filled_ -= 8, buffer_ >>= 8)
            bytes_.push_back(static_cast<uint8_t>(buffer_ & 0xff));
    }
    Bytes finish() {
        if (filled_ > 0) bytes_.push_back(static_cast<uint8_t>(buffer_ & 0xff));
        return std::move(bytes_);
    }

  private:
    Bytes bytes_;
    uint64_t buffer_ = 0;
    unsigned filled_ = 0;
};

}  // namespace

Bytes write_symbols(const Symbols& symbols) {
    const size_t count = symbols.values.size();
    // How large the magnitudes of each context are decides its shift.
    std::array<uint64_t, kTokenContexts> sums{}, seen{};
    for (size_t i = 0; i < count; ++i) {
        sums[symbols.contexts[i]] += magnitude_of(symbols.values[i]);
        ++seen[symbols.contexts[i]];
    }
    std::array<unsigned, kTokenContexts> shifts{};
    for (size_t c = 0; c < kTokenContexts; ++c)
        while (shifts[c] < kMaxShift && (sums[c] >> shifts[c]) > 5 * seen[c]) ++shifts[c];

    std::vector<uint8_t> tokens(count);
    std::array<std::array<uint32_t, kTokens>, kTokenContexts> counts{};
    BitWriter bits;
    for (size_t i = 0; i < count; ++i) {
        const unsigned c = symbols.contexts[i], shift = shifts[c];
        const uint32_t m = magnitude_of(symbols.values[i]);
        const uint32_t token = std::min(m >> shift, uint32_t(kLargest));
        tokens[i] = static_cast<uint8_t>(token);
        ++counts[c][token];
        if (token == kLargest) {
            const uint32_t rest = (m >> shift) - kLargest + 1;
            const auto length = static_cast<unsigned>(std::bit_width(rest));
            bits.put(length, 5);
            bits.put(rest & ((1u << (length - 1)) - 1), length - 1);
        }
        bits.put(m & ((1u << shift) - 1), shift);
        if (m > 0) bits.put(symbols.values[i] < 0 ? 1 : 0, 1);
    }

    Writer stream;
    uint32_t used = 0;
    for (size_t c = 0; c < kTokenContexts; ++c) used |= seen[c] > 0 ? 1u << c : 0u;
    stream.length(used);
    std::array<Frequencies, kTokenContexts> frequencies;
    for (size_t c = 0; c < kTokenContexts; ++c) {
        if (seen[c] == 0) continue;
        const TokenModel model = model_of(counts[c], shifts[c]);
        frequencies[c] = frequencies_of(model);
        stream.byte(model.shift);
        for (const uint8_t stop : model.stops) stream.byte(stop);
    }

    // Backwards, so that a decoder reads forwards.
    std::vector<std::uint16_t> words;
    const size_t state_count = states_for(count);
    std::array<uint32_t, 4> states;
    states.fill(kLowestState);
    words.reserve(count / 2);
    std::array<std::array<double, kTokens>, kTokenContexts> inverses{};
    for (size_t c = 0; c < kTokenContexts; ++c)
        for (size_t t = 0; t < kTokens && seen[c] > 0; ++t)
            inverses[c][t] = 1.0 / frequencies[c].frequency[t];
    for (size_t i = count; i-- > 0;) {
        const size_t c = symbols.contexts[i];
        const Frequencies& f = frequencies[c];
        const uint32_t frequency = f.frequency[tokens[i]];
        uint32_t& x = states[i % state_count];
        if (x >= frequency << (32 - kScaleBits)) {
            words.push_back(static_cast<std::uint16_t>(x & 0xffff));
            x >>= 16;
        }
        // A double's product is off by one at most, and quicker than a division.
        auto quotient =
            static_cast<uint32_t>(static_cast<std::int64_t>(x * inverses[c][tokens[i]]));
        auto rest = static_cast<std::int32_t>(x - quotient * frequency);
        if (rest < 0) {
            --quotient;
            rest += static_cast<std::int32_t>(frequency);
        } else if (rest >= static_cast<std::int32_t>(frequency)) {
            ++quotient;
            rest -= static_cast<std::int32_t>(frequency);
        }
        x = (quotient << kScaleBits) + static_cast<uint32_t>(rest) + f.start[tokens[i]];
    }
    stream.length(words.size());
    stream.bytes.reserve(stream.bytes.size() + 2 * words.size() + 32);
    for (size_t s = 0; s < state_count; ++s) stream.fixed(states[s], 4);
    for (size_t i = words.size(); i-- > 0;) stream.fixed(words[i], 2);
    stream.append(bits.finish());
    return std::move(stream.bytes);
}

SymbolReader::SymbolReader(View stream, size_t count) : state_count_(states_for(count)) {
    Reader head(stream);
    const uint64_t used = head.length();
    if (used >> kTokenContexts != 0) failed_ = true;
    for (size_t c = 0; c < kTokenContexts && !failed_; ++c) {
        if (!(used >> c & 1)) continue;
        TokenModel model;
        model.shift = static_cast<uint8_t>(head.byte());
        for (uint8_t& stop : model.stops) stop = static_cast<uint8_t>(head.byte());
        if (model.shift > kMaxShift) failed_ = true;
        const Frequencies f = frequencies_of(model);
        Table& table = tables_[c];
        table.frequency = f.frequency;
        table.start = f.start;
        table.shift = model.shift;
        table.token.resize(kScale);
        for (size_t t = 0; t < kTokens; ++t)
            std::fill_n(table.token.begin() + f.start[t], f.frequency[t], static_cast<uint8_t>(t));
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

uint32_t SymbolReader::bits(unsigned count) {
    while (buffered_ < count) {
        const uint64_t byte = bit_byte_ < bits_.size() ? bits_[bit_byte_++] : 0;
        buffer_ |= byte << buffered_;
        buffered_ += 8;
    }
    const auto value = static_cast<uint32_t>(buffer_ & ((uint64_t(1) << count) - 1));
    buffer_ >>= count;
    buffered_ -= count;
    return value;
}

void SymbolReader::read(const uint8_t* contexts, size_t count, std::int32_t* values) {
    if (failed_) {
        std::fill_n(values, count, 0);
        return;
    }
    for (size_t i = 0; i < count; ++i) {
        const Table& table = tables_[contexts[i]];
        if (table.token.empty()) {  // a context that the stream says is unused
            failed_ = true;
            values[i] = 0;
            continue;
        }
        uint32_t& x = states_[turn_];
        turn_ = turn_ + 1 == state_count_ ? 0 : turn_ + 1;
        const uint32_t slot = x & (kScale - 1);
        const uint32_t token = table.token[slot];
        x = table.frequency[token] * (x >> kScaleBits) + slot - table.start[token];
        if (x < kLowestState) {
            uint32_t word = 0;
            if (word_ + 2 <= words_.size())
                word = uint32_t(words_[word_]) | uint32_t(words_[word_ + 1]) << 8;
            word_ += 2;
            x = x << 16 | word;
        }
        uint32_t m = token;
        if (token == kLargest) {
            const unsigned length = std::max(bits(5), 1u);
            m = kLargest - 1 + (1u << (length - 1) | bits(length - 1));
        }
        const unsigned shift = table.shift;
        if (shift > 0) m = m << shift | bits(shift);
        m &= 0x3fffffff;
        if (m > 0)
            values[i] = bits(1) ? -static_cast<std::int32_t>(m) : static_cast<std::int32_t>(m);
        else
            values[i] = 0;
    }
}

}  // namespace wavefog::wfog
