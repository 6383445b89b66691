// CRC-32 as in PNG and zlib (polynomial 0xedb88320).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace wavefog::detail {

/// [n][byte]: what a byte does to the checksum n bytes further on.
inline constexpr auto kCrcTables = [] {
    std::array<std::array<std::uint32_t, 256>, 8> tables{};
    for (std::uint32_t byte = 0; byte < 256; ++byte) {
        std::uint32_t c = byte;
        for (int k = 0; k < 8; ++k) c = (c & 1) ? 0xedb88320u ^ (c >> 1) : c >> 1;
        tables[0][byte] = c;
    }
    for (std::size_t n = 1; n < tables.size(); ++n)
        for (std::size_t byte = 0; byte < 256; ++byte) {
            const std::uint32_t c = tables[n - 1][byte];
            tables[n][byte] = tables[0][c & 0xff] ^ (c >> 8);
        }
    return tables;
}();

/// Start with 0xffffffff; the checksum is the complement of the last result.
inline std::uint32_t update_crc(std::uint32_t crc, const unsigned char* data, std::size_t count) {
    const auto& t = kCrcTables;
    std::size_t i = 0;
    for (; i + 8 <= count; i += 8) {  // eight tables side by side: no byte waits for the one before
        const unsigned char* const d = data + i;
        crc = t[7][(crc ^ d[0]) & 0xff] ^ t[6][(crc >> 8 ^ d[1]) & 0xff] ^
              t[5][(crc >> 16 ^ d[2]) & 0xff] ^ t[4][(crc >> 24 ^ d[3]) & 0xff] ^ t[3][d[4]] ^
              t[2][d[5]] ^ t[1][d[6]] ^ t[0][d[7]];
    }
    for (; i < count; ++i) crc = t[0][(crc ^ data[i]) & 0xff] ^ (crc >> 8);
    return crc;
}

}  // namespace wavefog::detail
