// The coder of the default profile: fixed linear predictors a level, and tokens with one table of
// probabilities for each class of local activity.
#pragma once

#include <span>
#include <vector>

#include "bytes.h"
#include "mixing_coder.h"

namespace wavefog::wfog {

/// Wider tiles than this (high - low) go to the mixing coder: here values are floats.
inline constexpr std::int64_t kTableRange = 1 << 20;

/// As encode_mixing(), whose tile is of no use afterwards, and decode_mixing(). A decoder returns
/// false for streams that are impossible.
std::vector<Bytes> encode_tables(Tile& tile, const TileCoding& coding, Scratch& scratch);
bool decode_tables(Tile& tile, const TileCoding& coding, std::span<const View> streams,
                   Scratch& scratch);

/// The sum of the squared errors of all pixels, of a tile within kTableRange, without its bytes:
/// about, with weights from few rows.
double squared_errors(const Tile& tile, const TileCoding& coding, Scratch& scratch);

}  // namespace wavefog::wfog
