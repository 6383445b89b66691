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

Grid<float> densities_of(const std::vector<std::int32_t>& integers, const Scale& scale, int width,
                         int height);

/// The pixels of the first `levels` streams, the others interpolated.
Result<std::vector<std::int32_t>> decode_integers(const Chunks& chunks, const WfogLimits& limits,
                                                  int levels);

/// decode_wfog(), which may throw std::bad_alloc.
Result<DecodedFog> decode(View bytes, const WfogLimits& limits);

}  // namespace wavefog::wfog
