// A grid of integers as tiles, each with one stream a level.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
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
        kDefaultTileBits;  ///< tiles have sides of 2^tile_bits, smaller at the far edges
    int levels = 0;        ///< of streams, at most tile_bits
    Bounds bounds = {};

    int tiles_x() const { return ((width - 1) >> tile_bits) + 1; }
    int tiles_z() const { return ((height - 1) >> tile_bits) + 1; }
    std::size_t tiles() const { return std::size_t(tiles_x()) * std::size_t(tiles_z()); }
};

/// As many levels as leave about 16 pixels along the longer side in the coarsest.
int default_stream_levels(int width, int height, int tile_bits);

/// Where a tile lies in its plane.
struct Place {
    int x, y, width, height;
    /// Of the first pixel of row `j` of the tile, in a plane so wide.
    std::size_t index(int j, int plane_width) const {
        return std::size_t(y + j) * std::size_t(plane_width) + std::size_t(x);
    }
};

/// streams[level][tile], tiles row by row. Level 0 of each tile starts with its own head.
using PlaneStreams = std::vector<std::vector<Bytes>>;
using PlaneViews = std::vector<std::vector<View>>;

/// Sets the values of a tile; several threads may ask at once.
using TileSource = std::function<void(const Place&, Tile&)>;
/// Gets a tile as decoded; several threads may tell at once. False: the values are wrong.
using TileSink = std::function<bool(std::size_t tile, const Place&, const Tile&)>;

enum class PlaneResult { done, damaged, stopped };

/// Encodes tiles, decodes each again from its bytes and shows `check` what came out: `damaged` if
/// that says no, or the bytes are impossible.
PlaneResult encode_plane(const PlaneCoding& coding, bool best, int threads,
                         const std::stop_token& stop, const TileSource& source,
                         const TileSink& check, PlaneStreams& streams);

/// Whether any of the tiles that encode_plane() has made is coded within bounds, not exactly.
bool heed_bounds(const std::vector<Bytes>& first_level);

/// Decodes as many levels as there are streams (at least 1) and interpolates the others.
PlaneResult decode_plane(const PlaneViews& streams, const PlaneCoding& coding, int threads,
                         const std::stop_token& stop, const TileSink& sink);

/// Every fourth strip of 32 rows of a large tile, from the first or the third on; else all.
enum class Strips { first, third };

/// Estimates, from some strips, the mean squared error that encoding would leave. Nothing if a
/// tile's range is too wide, or stopped.
std::optional<double> squared_error_of(const PlaneCoding& coding, Strips strips, int threads,
                                       const std::stop_token& stop, const TileSource& source);

}  // namespace wavefog::wfog
