// CRC-32 as in PNG and zlib (polynomial 0xedb88320).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace wavefog::detail {

inline constexpr auto kCrcTable = [] {
    std::array<std::uint32_t, 256> table{};
    for (std::uint32_t n = 0; n < 256; ++n) {
        std::uint32_t c = n;
        for (int k = 0; k < 8; ++k) c = (c & 1) ? 0xedb88320u ^ (c >> 1) : c >> 1;
        table[n] = c;
    }
    return table;
}();

/// Start with 0xffffffff; the checksum is the complement of the last result.
inline std::uint32_t update_crc(std::uint32_t crc, const unsigned char* data, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) crc = kCrcTable[(crc ^ data[i]) & 0xff] ^ (crc >> 8);
    return crc;
}

}  // namespace wavefog::detail
