// Neither NaN nor infinite, at the speed of memory.
#pragma once

#include <bit>
#include <cstdint>

#include "wavefog/wavelet/grid.h"

namespace wavefog::detail {

/// Eigen's allFinite() looks at one value after the other.
inline bool all_finite(const Grid<float>& grid) {
    std::int32_t largest = 0;  // of the bits without sign
    for (Eigen::Index i = 0; i < grid.size(); ++i) {
        const auto bits = std::bit_cast<std::int32_t>(grid.data()[i]) & 0x7fffffff;
        largest = largest < bits ? bits : largest;
    }
    return largest < 0x7f800000;
}

}  // namespace wavefog::detail
