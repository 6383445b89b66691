// The chunks of a .wfog file, taken apart without the library's help (fogmap/FORMAT.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace wavefog::test {

using FileBytes = std::vector<std::uint8_t>;

inline std::uint32_t crc32(const std::uint8_t* data, std::size_t count) {
    std::uint32_t crc = 0xffffffffu;
    for (std::size_t i = 0; i < count; ++i) {
        crc ^= data[i];
        for (int k = 0; k < 8; ++k) crc = (crc & 1) ? 0xedb88320u ^ (crc >> 1) : crc >> 1;
    }
    return ~crc;
}

/// A chunk with its type, length and checksum.
inline FileBytes make_chunk(char type, const FileBytes& payload) {
    FileBytes chunk = {static_cast<std::uint8_t>(type)};
    std::size_t length = payload.size();
    for (; length >= 0x80; length >>= 7)
        chunk.push_back(static_cast<std::uint8_t>((length & 0x7f) | 0x80));
    chunk.push_back(static_cast<std::uint8_t>(length));
    chunk.insert(chunk.end(), payload.begin(), payload.end());
    const std::uint32_t crc = crc32(chunk.data(), chunk.size());
    for (int i = 0; i < 4; ++i) chunk.push_back(static_cast<std::uint8_t>(crc >> (8 * i)));
    return chunk;
}

/// Where each chunk starts, and the end; stops where the bytes make no sense.
inline std::vector<std::size_t> chunk_starts(const FileBytes& file) {
    std::vector<std::size_t> starts;
    std::size_t at = 5;
    while (at + 6 <= file.size()) {
        std::size_t length = 0, here = at + 1;
        for (unsigned shift = 0; here < file.size() && shift < 35; shift += 7) {
            length |= std::size_t(file[here] & 0x7f) << shift;
            if (file[here++] < 0x80) break;
        }
        if (length > file.size() || here + length + 4 > file.size()) break;
        starts.push_back(at);
        at = here + length + 4;
    }
    starts.push_back(at);
    return starts;
}

/// Makes all checksums right again, so that what they guard is reached.
inline void repair_checksums(FileBytes& file) {
    const std::vector<std::size_t> starts = chunk_starts(file);
    for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
        const std::size_t end = starts[i + 1] - 4;
        const std::uint32_t crc = crc32(file.data() + starts[i], end - starts[i]);
        for (std::size_t k = 0; k < 4; ++k)
            file[end + k] = static_cast<std::uint8_t>(crc >> (8 * k));
    }
}

}  // namespace wavefog::test
