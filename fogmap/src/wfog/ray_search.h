// The smallest file whose rays are proved to keep their promise.
#pragma once

#include "pixel_encoder.h"

namespace wavefog::wfog {

/// Tries errors between what guarantees the promise pixel by pixel and `scale` (in densities), then
/// coarser steps in dense fog. The file's report has what |dT| is proved not to exceed.
Result<Trial> search_rays(PixelEncoder& encoder, const Fog& fog, const Source& source,
                          const WfogOptions& options, double scale);

}  // namespace wavefog::wfog
