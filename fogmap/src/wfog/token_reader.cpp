#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>

#include "token_model.h"
#include "token_stream.h"

namespace wavefog::wfog {

namespace {

using std::size_t;
using std::uint32_t;
using std::uint64_t;
using std::uint8_t;

std::int32_t with_sign(uint32_t magnitude, uint32_t negative) {
    return static_cast<std::int32_t>((magnitude ^ (0 - negative)) + negative);
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

SymbolReader::SymbolReader(View stream, size_t count)
    : state_count_(states_for(count)), all_zero_(stream.empty()) {
    if (all_zero_) return;
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
    if (failed_ || all_zero_) {
        std::fill_n(values, count, 0);
        return;
    }
    if (tokens_.size() < count) tokens_.resize(count);
    read_tokens(contexts, count);
    read_values(contexts, count, values);
}

}  // namespace wavefog::wfog
