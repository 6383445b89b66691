// Between two decomposed maps.
#pragma once

#include "wavefog/wavelet/decomposition.h"
#include "wavefog/wavelet/result.h"

namespace wavefog {

/// (1 - share) a + share b, coefficient by coefficient, share in [0, 1]. The transform is linear,
/// so this is the decomposition of the maps' own mixture up to rounding, at every level, and `a` or
/// `b` itself bit for bit at the ends. A data error if size, family, form, border or levels differ.
/// `out` keeps its storage and may be neither of the two.
Result<void> interpolate(const Decomposition<float>& a, const Decomposition<float>& b, double share,
                         Decomposition<float>& out);

}  // namespace wavefog
