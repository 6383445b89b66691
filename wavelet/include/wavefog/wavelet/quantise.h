// Fewer bits and fewer coefficients: rounding to half floats and hard thresholds.
#pragma once

#include <cstddef>
#include <span>

#include "wavefog/wavelet/decomposition.h"

namespace wavefog {

/// Largest finite half float.
inline constexpr float max_half = 65504.0f;

/// The half nearest to x (ties to even), and the least half that is not below x.
float nearest_half(float x);
float half_above(double x);

/// Makes every coefficient a half float. A data error, and no change, if one exceeds max_half:
/// scale the map to a maximum of 1 first.
///
/// Form::wavelet: each coefficient to the nearest half.
/// Form::scaling: closed loop. Each residual is taken against the already rounded coarser levels
/// and rounded up, so the rounded map is never below the true one (a density stays >= 0) and above
/// it by at most one step of its finest residual: 2^-10 of that residual (stability.md, failure
/// 15).
Result<void> round_to_half_closed_loop(Decomposition<float>& decomposition);

struct ThresholdCount {
    std::size_t kept = 0;     ///< details that are not 0
    std::size_t dropped = 0;  ///< details that were not 0 and are now

    bool operator==(const ThresholdCount&) const = default;
};

/// Hard threshold: details of level l with magnitude below thresholds[l - 1] become 0; levels
/// without an entry stay as they are. Where the sum of levels falls below 0 afterwards, the
/// renderer clamps (stability.md, section 4).
template <class T>
ThresholdCount hard_threshold(Decomposition<T>& decomposition, std::span<const double> thresholds);

}  // namespace wavefog
