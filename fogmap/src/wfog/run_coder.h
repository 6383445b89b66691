// The coder of tiles that are flat but for edges: maps of few values, painted masks, stripes. Where
// the pixels around one are alike it is as they are, but for a few that are told apart; at edges
// each is one of its neighbours.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "bytes.h"
#include "mixing_coder.h"

namespace wavefog::wfog {

/// Whether most pixels are as the one to the west, or most as the one to the north.
enum class Flatness {
    none,
    slopes,  ///< so they are, but many of the others are off by no more than `reach`: perhaps a
             ///< slope, which a bound leaves to be foretold
    edges,
};
/// Of values that are less than 2^30 apart.
Flatness flatness_of(const Tile& tile, std::int64_t reach);

/// As encode_mixing() and decode_mixing(), for tiles of a range below 2^24 (high - low): no value
/// is lost, whatever the bounds.
std::vector<Bytes> encode_runs(const Tile& tile, const TileCoding& coding, Scratch& scratch);
void decode_runs(Tile& tile, const TileCoding& coding, std::span<const View> streams,
                 Scratch& scratch);

}  // namespace wavefog::wfog
