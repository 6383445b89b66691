// The coder of the `best` profile: what a tile's pixels become when every decision's probability is
// mixed from many contexts.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lattice.h"

namespace wavefog::wfog {

/// What the streams of a tile need to be understood.
struct TileCoding {
    int levels = 0;  ///< 0..kMaxStreamLevels
    Bounds bounds;
    std::int32_t low = 0, high = 0;  ///< no pixel lies outside
    /// Pixels at `low` are marked as such where others are near: maps with much empty air.
    bool marks_low = false;
};

/// One stream a level. `tile.values` become what a decoder will see, each within its
/// bound of the original and inside [low, high].
std::vector<std::vector<std::uint8_t>> encode_mixing(Tile& tile, const TileCoding& coding);

/// Decodes as many levels as there are streams; pixels of further levels stay as they are. Any
/// bytes decode to values inside [low, high].
void decode_mixing(Tile& tile, const TileCoding& coding,
                   std::span<const std::span<const std::uint8_t>> streams);

}  // namespace wavefog::wfog
