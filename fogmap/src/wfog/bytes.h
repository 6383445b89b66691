// Numbers in a .wfog file: little-endian, lengths as LEB128 of at most 10 bytes.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace wavefog::wfog {

using Bytes = std::vector<std::uint8_t>;
using View = std::span<const std::uint8_t>;

class Writer {
  public:
    Bytes bytes;

    void byte(unsigned value) { bytes.push_back(static_cast<std::uint8_t>(value)); }
    void length(std::uint64_t value) {
        for (; value >= 0x80; value >>= 7) byte(static_cast<unsigned>(value & 0x7f) | 0x80u);
        byte(static_cast<unsigned>(value));
    }
    void signed_length(std::int64_t value) {
        length((static_cast<std::uint64_t>(value) << 1) ^ static_cast<std::uint64_t>(value >> 63));
    }
    void fixed(std::uint64_t value, int count) {
        for (int i = 0; i < count; ++i) byte(static_cast<unsigned>(value >> (8 * i) & 0xff));
    }
    void number(double value) { fixed(std::bit_cast<std::uint64_t>(value), 8); }
    void append(View part) { bytes.insert(bytes.end(), part.begin(), part.end()); }
};

/// Reads past the end, and lengths that are no numbers, give 0 and set `failed`.
class Reader {
  public:
    explicit Reader(View bytes) : bytes_(bytes) {}

    bool failed() const { return failed_; }
    std::size_t left() const { return bytes_.size() - at_; }
    unsigned byte() {
        if (left() == 0) {
            failed_ = true;
            return 0;
        }
        return bytes_[at_++];
    }
    std::uint64_t length() {
        std::uint64_t value = 0;
        for (int shift = 0; shift < 64; shift += 7) {
            const unsigned b = byte();
            value |= std::uint64_t(b & 0x7f) << shift;
            if (b < 0x80) return value;
        }
        failed_ = true;
        return 0;
    }
    std::int64_t signed_length() {
        const std::uint64_t value = length();
        return static_cast<std::int64_t>(value >> 1) ^ -static_cast<std::int64_t>(value & 1);
    }
    std::uint64_t fixed(int count) {
        std::uint64_t value = 0;
        for (int i = 0; i < count; ++i) value |= std::uint64_t(byte()) << (8 * i);
        return value;
    }
    double number() { return std::bit_cast<double>(fixed(8)); }
    View take(std::uint64_t count) {
        if (count > left()) {
            failed_ = true;
            return {};
        }
        const View part = bytes_.subspan(at_, static_cast<std::size_t>(count));
        at_ += part.size();
        return part;
    }

  private:
    View bytes_;
    std::size_t at_ = 0;
    bool failed_ = false;
};

}  // namespace wavefog::wfog
