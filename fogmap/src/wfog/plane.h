// A grid of integers as tiles, each with one stream a level.
#pragma once

#include <cstdint>
#include <stop_token>
#include <vector>

#include "bytes.h"
#include "lattice.h"

namespace wavefog::wfog {

inline constexpr int kMaxSide = 1 << 16;
inline constexpr int kMinTileBits = 4, kMaxTileBits = 12;
inline constexpr int kDefaultTileBits = 9;

/// What holds for all tiles of a plane.
struct PlaneCoding {
    int width = 0, height = 0;
    int tile_bits =
        kDefaultTileBits;    ///< tiles have sides of 2^tile_bits, smaller at the far edges
    int levels = 0;          ///< of streams, at most tile_bits
    Bounds bounds = {};

    int tiles_x() const { return ((width - 1) >> tile_bits) + 1; }
    int tiles_z() const { return ((height - 1) >> tile_bits) + 1; }
    std::size_t tiles() const { return std::size_t(tiles_x()) * std::size_t(tiles_z()); }
};

/// As many levels as leave about 16 pixels along the longer side in the coarsest.
int default_stream_levels(int width, int height, int tile_bits);

/// streams[level][tile], tiles row by row. Level 0 of each tile starts with its own head.
using PlaneStreams = std::vector<std::vector<Bytes>>;
using PlaneViews = std::vector<std::vector<View>>;

/// `values` (row by row) become what a decoder will see. False if stopped.
bool encode_plane(std::vector<std::int32_t>& values, const PlaneCoding& coding, bool best,
                  int threads, const std::stop_token& stop, PlaneStreams& streams);

/// Decodes as many levels as there are streams (at least 1) and interpolates the others.
enum class PlaneResult { done, damaged, stopped };
PlaneResult decode_plane(const PlaneViews& streams, const PlaneCoding& coding, int threads,
                         const std::stop_token& stop, std::vector<std::int32_t>& values);

}  // namespace wavefog::wfog
