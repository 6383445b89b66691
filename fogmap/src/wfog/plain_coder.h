// Tiles that no coder makes smaller, noise most of all: values in as many bits as the widest needs.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "bytes.h"
#include "mixing_coder.h"

namespace wavefog::wfog {

/// Bytes of all levels of a tile.
std::size_t plain_size(const Tile& tile, const TileCoding& coding);

/// As encode_mixing() and decode_mixing(), in the same order of pixels; no value is lost, whatever
/// the bounds. A decoder returns false for streams of a wrong length.
std::vector<Bytes> encode_plain(const Tile& tile, const TileCoding& coding);
bool decode_plain(Tile& tile, const TileCoding& coding, std::span<const View> streams);

}  // namespace wavefog::wfog
