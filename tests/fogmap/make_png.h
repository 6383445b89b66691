// PNG files byte by byte, so that tests can make what no encoder writes: few bits, palettes, lies.
#pragma once

#include <cstdint>
#include <string>

namespace wavefog::test {

inline std::string big_endian(std::uint32_t value) {
    return {static_cast<char>(value >> 24), static_cast<char>(value >> 16),
            static_cast<char>(value >> 8), static_cast<char>(value)};
}

inline std::string png_chunk(const std::string& type, const std::string& data) {
    std::uint32_t crc = 0xffffffffu;
    for (const char c : type + data) {
        crc ^= static_cast<unsigned char>(c);
        for (int k = 0; k < 8; ++k) crc = (crc & 1) ? 0xedb88320u ^ (crc >> 1) : crc >> 1;
    }
    return big_endian(static_cast<std::uint32_t>(data.size())) + type + data + big_endian(~crc);
}

/// zlib data that is stored, not compressed; below 64 KiB.
inline std::string zlib_stored(const std::string& data) {
    const auto size = static_cast<std::uint16_t>(data.size());
    std::string out = {0x78,
                       0x01,
                       0x01,
                       static_cast<char>(size),
                       static_cast<char>(size >> 8),
                       static_cast<char>(~size),
                       static_cast<char>(static_cast<std::uint16_t>(~size) >> 8)};
    std::uint32_t a = 1, b = 0;
    for (const char c : data) {
        a = (a + static_cast<unsigned char>(c)) % 65521;
        b = (b + a) % 65521;
    }
    return out + data + big_endian((b << 16) | a);
}

/// `rows`: filter byte and packed samples of every row.
inline std::string make_png(std::uint32_t width, std::uint32_t height, int bits, int colour_type,
                            const std::string& rows, const std::string& palette = {}) {
    std::string header = big_endian(width) + big_endian(height);
    header += {static_cast<char>(bits), static_cast<char>(colour_type), 0, 0, 0};
    std::string png = "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header);
    if (!palette.empty()) png += png_chunk("PLTE", palette);
    return png + png_chunk("IDAT", zlib_stored(rows)) + png_chunk("IEND", "");
}

}  // namespace wavefog::test
