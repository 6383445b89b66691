// Binary arithmetic coding: a range coder with carries (G. N. N. Martin, "Range encoding", 1979, in
// the form of LZMA), whose probabilities come from outside.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace wavefog::wfog {

/// Probabilities have 16 bits: p / 65536 is that of a 1, 1 <= p <= 65535.
class RangeEncoder {
  public:
    static constexpr bool kEncodes = true;

    int code(int bit, std::uint32_t p) {
        const std::uint32_t bound = (range_ >> 16) * p;
        if (bit) {
            range_ = bound;
        } else {
            low_ += bound;
            range_ -= bound;
        }
        while (range_ < (1u << 24)) {
            shift();
            range_ <<= 8;
        }
        return bit;
    }

    /// Ends the stream with the shortest number inside the last interval. Zeros at the end are
    /// left out: the decoder reads zeros after the last byte.
    std::vector<std::uint8_t> finish() {
        const std::uint64_t last = low_ + range_ - 1;
        for (int bits = 32; bits >= 0; --bits) {
            const std::uint64_t rounded = last >> bits << bits;
            if (rounded >= low_) {
                low_ = rounded;
                break;
            }
        }
        for (int i = 0; i < 5; ++i) shift();
        bytes_.erase(bytes_.begin());  // no carry ever reaches the first byte: it is 0
        while (!bytes_.empty() && bytes_.back() == 0) bytes_.pop_back();
        return std::move(bytes_);
    }

  private:
    void shift() {
        if (low_ < 0xff000000u || low_ > 0xffffffffu) {
            const auto carry = static_cast<std::uint8_t>(low_ >> 32);
            bytes_.push_back(static_cast<std::uint8_t>(cache_ + carry));
            for (; pending_ > 0; --pending_)
                bytes_.push_back(static_cast<std::uint8_t>(0xff + carry));
            cache_ = static_cast<std::uint8_t>(low_ >> 24);
        } else {
            ++pending_;
        }
        low_ = (low_ & 0x00ffffffu) << 8;
    }

    std::vector<std::uint8_t> bytes_;
    std::uint64_t low_ = 0;
    std::uint32_t range_ = 0xffffffffu;
    std::uint64_t pending_ = 0;  ///< bytes 0xff that a carry may still change
    std::uint8_t cache_ = 0;
};

/// Any bytes decode to something; the end of the data reads as zeros.
class RangeDecoder {
  public:
    static constexpr bool kEncodes = false;

    explicit RangeDecoder(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
        for (int i = 0; i < 4; ++i) code_ = code_ << 8 | next();
    }

    int code(int /*unknown*/, std::uint32_t p) {
        const std::uint32_t bound = (range_ >> 16) * p;
        int bit = 0;
        if (code_ < bound) {
            range_ = bound;
            bit = 1;
        } else {
            code_ -= bound;
            range_ -= bound;
        }
        while (range_ < (1u << 24)) {
            code_ = code_ << 8 | next();
            range_ <<= 8;
        }
        return bit;
    }

  private:
    std::uint32_t next() { return at_ < bytes_.size() ? bytes_[at_++] : 0u; }

    std::span<const std::uint8_t> bytes_;
    std::size_t at_ = 0;
    std::uint32_t code_ = 0;
    std::uint32_t range_ = 0xffffffffu;
};

}  // namespace wavefog::wfog
