// --preset motion: what fog that changes every frame costs.
#pragma once

#include <string>

#include "bench/results.h"
#include "wavefog/gpu/context.h"

namespace wavefog::cli {

/// Maps of 64^2 to 1024^2 pixels, linear 2,2 in wavelet form: medians of decomposing a new picture,
/// of mixing two decompositions, and of synthesising and uploading the textures. Then 0 to 20000
/// particles before the sky at 800x600: medians of a step of 1/24 s, and of drawing, tiles
/// included. In about `seconds`, and at least three runs of each.
Result<void> study_motion(Context& context, double seconds, Results& results);

std::string motion_text(const Facts& runs, bool markdown);

}  // namespace wavefog::cli
