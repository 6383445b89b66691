// From a fog to the bytes of a .wfog file.
#pragma once

#include "wavefog/fogmap/wfog.h"

namespace wavefog::wfog {

/// encode_wfog(), which may throw std::bad_alloc.
Result<EncodedFog> encode(const Fog& fog, const WfogOptions& options, const Grid<float>* map);

}  // namespace wavefog::wfog
