// From the bytes of a .wfog file to integers, densities and a fog.
#pragma once

#include <cstdint>
#include <vector>

#include "format.h"
#include "wavefog/fogmap/wfog.h"

namespace wavefog::wfog {

tl::unexpected<Error> cancelled();

Result<Decomposition<float>> decompose_as(const Grid<float>& map, const Decomposition<float>& like,
                                          int levels);

PlaneCoding coding_of(const Head& head, int width, int height, int levels);

/// The tiles of a level's chunk. False if it does not hold so many.
bool split_chunk(View chunk, std::size_t tiles, std::vector<View>& parts);

/// decode_wfog(), which may throw std::bad_alloc.
Result<DecodedFog> decode(View bytes, const WfogLimits& limits);

}  // namespace wavefog::wfog
