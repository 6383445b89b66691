#include "plain_coder.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "parts.h"

namespace wavefog::wfog {

using std::int32_t;
using std::int64_t;
using std::size_t;
using std::uint32_t;
using std::uint64_t;

namespace {

uint64_t range_of(const TileCoding& coding) {
    return static_cast<uint64_t>(int64_t(coding.high) - coding.low);
}

unsigned width_of(const TileCoding& coding) {
    return static_cast<unsigned>(std::bit_width(range_of(coding)));
}

size_t bytes_of(const Tile& tile, const TileCoding& coding, int level) {
    const auto pixels = [&](int coarser) {
        return size_t(multiples(tile.width, coarser)) * size_t(multiples(tile.height, coarser));
    };
    const int coarser = coding.levels - level;
    const size_t count = pixels(coarser) - (level > 0 ? pixels(coarser + 1) : 0);
    return (count * width_of(coding) + 7) / 8;
}

/// Calls body(x, y) for the pixels that a level adds.
template <class Body>
void for_each_of_level(const Tile& tile, const TileCoding& coding, int level, Body body) {
    const int h = 1 << (coding.levels - level);
    if (level == 0) {
        for (int y = 0; y < tile.height; y += h)
            for (int x = 0; x < tile.width; x += h) body(x, y);
    } else {
        for (int pass = 0; pass < 2; ++pass)
            for_each_in_pass(tile.width, tile.height, h, pass, body);
    }
}

}  // namespace

size_t plain_size(const Tile& tile, const TileCoding& coding) {
    size_t bytes = 0;
    for (int level = 0; level <= coding.levels; ++level) bytes += bytes_of(tile, coding, level);
    return bytes;
}

std::vector<Bytes> encode_plain(const Tile& tile, const TileCoding& coding) {
    const unsigned width = width_of(coding);
    std::vector<Bytes> streams;
    for (int level = 0; level <= coding.levels; ++level) {
        Bytes& stream = streams.emplace_back();
        stream.reserve(bytes_of(tile, coding, level));
        uint64_t buffer = 0;
        unsigned filled = 0;
        for_each_of_level(tile, coding, level, [&](int x, int y) {
            const int64_t above = int64_t(tile.row(y)[x]) - coding.low;
            buffer |= static_cast<uint64_t>(above) << filled;
            for (filled += width; filled >= 8; filled -= 8, buffer >>= 8)
                stream.push_back(static_cast<std::uint8_t>(buffer & 0xff));
        });
        if (filled > 0) stream.push_back(static_cast<std::uint8_t>(buffer & 0xff));
    }
    return streams;
}

bool decode_plain(Tile& tile, const TileCoding& coding, std::span<const View> streams) {
    const unsigned width = width_of(coding);
    for (size_t level = 0; level < streams.size(); ++level) {
        const View stream = streams[level];
        if (stream.size() != bytes_of(tile, coding, static_cast<int>(level))) return false;
        size_t at = 0;
        uint64_t buffer = 0;
        unsigned filled = 0;
        for_each_of_level(tile, coding, static_cast<int>(level), [&](int x, int y) {
            for (; filled < width; filled += 8) buffer |= uint64_t(stream[at++]) << filled;
            const uint64_t above = buffer & ((uint64_t(1) << width) - 1);
            buffer >>= width;
            filled -= width;
            tile.row(y)[x] = static_cast<int32_t>(
                coding.low + static_cast<int64_t>(std::min(above, range_of(coding))));
        });
    }
    return true;
}

}  // namespace wavefog::wfog
