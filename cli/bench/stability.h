// Where methods fail: figures from the wavelet library, the reference and the fog pass.
#pragma once

#include "bench/results.h"
#include "wavefog/gpu/context.h"

namespace wavefog::cli {

Result<void> study_stability(Context& context, Results& results);

}  // namespace wavefog::cli
