// Neither NaN nor infinite, at the speed of memory.
#pragma once

#include <bit>
#include <cstdint>

#include "wavefog/wavelet/grid.h"

namespace wavefog::detail {

/// Eigen's allFinite() looks at one value after the other.
inline bool all_finite(const Grid<float>& grid) {
    std::uint32_t used = 0;
    // Where the exponent has all bits, one more in the last of them is one in the sign's place.
    for (Eigen::Index i = 0; i < grid.size(); ++i)
        used |= (std::bit_cast<std::uint32_t>(grid.data()[i]) & 0x7fffffffu) + 0x00800000u;
    return used >> 31 == 0;
}

}  // namespace wavefog::detail
