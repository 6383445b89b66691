// The order of pixels in a tile, coarse to fine, and which neighbours are known when.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "scratch.h"

namespace wavefog::wfog {

/// Pixels of one tile, row by row: integers that the map's scale turns into densities. In memory of
/// a Scratch, not set at first.
struct Tile {
    int width, height;
    std::span<std::int32_t> values;

    Tile(int w, int h, Scratch& scratch)
        : width(w),
          height(h),
          values(scratch.take<std::int32_t>(std::size_t(w) * std::size_t(h))) {}
    std::int32_t* row(int y) { return values.data() + index(0, y); }
    const std::int32_t* row(int y) const { return values.data() + index(0, y); }
    std::size_t index(int x, int y) const {
        return std::size_t(y) * std::size_t(width) + std::size_t(x);
    }
};

/// How far a decoded integer may be off: at coarse levels less where finer ones profit from it.
struct Bounds {
    std::int64_t finest = 0;
    std::vector<std::int64_t> coarser = {};  ///< of the levels before it, coarse first; at most
                                             ///< `finest`. Empty: the same for all

    std::int64_t at(int level) const {
        return static_cast<std::size_t>(level) < coarser.size()
                   ? coarser[static_cast<std::size_t>(level)]
                   : finest;
    }
    bool operator==(const Bounds&) const = default;
};

/// Level 0 holds the pixels whose coordinates are both multiples of 2^levels. Level l adds those of
/// multiples of h = 2^(levels - l), in two passes: first the centres (x and y odd multiples of h),
/// then the rest (one odd, one even), each row by row.
///
/// Neighbours, in units of h. Those 0..3 surround the pixel, 4..11 lie around them, all known
/// before the pass; 12..15 are of the pass itself or just before it, already coded.
using Offsets = std::array<std::pair<int, int>, 16>;
inline constexpr std::array<Offsets, 2> kNeighbours = {{
    {{{-1, -1},
      {1, -1},
      {-1, 1},
      {1, 1},
      {-3, -1},
      {-3, 1},
      {3, -1},
      {3, 1},
      {-1, -3},
      {1, -3},
      {-1, 3},
      {1, 3},
      {-2, 0},
      {0, -2},
      {-2, -2},
      {2, -2}}},
    {{{-1, 0},
      {1, 0},
      {0, -1},
      {0, 1},
      {-2, -1},
      {-2, 1},
      {2, -1},
      {2, 1},
      {-1, -2},
      {1, -2},
      {-1, 2},
      {1, 2},
      {-1, -1},
      {1, -1},
      {-2, 0},
      {0, -2}}},
}};

/// Calls body(x, y) for the pixels of one pass, in order.
template <class Body>
void for_each_in_pass(int width, int height, int h, int pass, Body body) {
    if (pass == 0) {
        for (int y = h; y < height; y += 2 * h)
            for (int x = h; x < width; x += 2 * h) body(x, y);
    } else {
        for (int y = 0; y < height; y += h)
            for (int x = (y / h) % 2 ? 0 : h; x < width; x += 2 * h) body(x, y);
    }
}

/// Fills the pixels of the levels above `known` by the mean of the pixels around them: what a file
/// that ends early shows.
void interpolate_levels(Tile& tile, int levels, int known);

}  // namespace wavefog::wfog
