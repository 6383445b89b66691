// The standard (tensor product) decomposition: all levels along rows, then all levels along
// columns.
#pragma once

#include <vector>

#include "wavefog/wavelet/decomposition.h"

namespace wavefog {

/// Every pair of an x level and a z level has its band, (levels_x + 1) (levels_z + 1) in all; index
/// 0 is the approximation along that axis, 1..levels the details from coarse to fine. Bands between
/// different levels have elongated functions: better on axis-aligned features, worse on others
/// (paper 004, section 3.2 uses the non-standard decomposition of decomposition.h).
template <class T>
struct StandardDecomposition {
    Family family;
    Boundary boundary = Boundary::zero;
    int width = 0;   ///< of the map, pixels
    int height = 0;  ///< of the map, pixels
    int levels_x = 0;
    int levels_z = 0;
    std::vector<Band<T>> bands;  ///< row-major: x level fastest

    Band<T>& band(int level_x, int level_z) { return bands[index(level_x, level_z)]; }
    const Band<T>& band(int level_x, int level_z) const { return bands[index(level_x, level_z)]; }

  private:
    std::size_t index(int level_x, int level_z) const {
        return static_cast<std::size_t>(level_z * (levels_x + 1) + level_x);
    }
};

/// `levels` is capped on each axis by what that side gains. Kind::positive has no wavelets: a usage
/// error.
template <class T>
Result<StandardDecomposition<T>> decompose_standard(const Grid<T>& map, const Family& family,
                                                    int levels, Boundary boundary = Boundary::zero);

/// The inverse of decompose_standard up to rounding.
template <class T>
Grid<T> reconstruct_standard(const StandardDecomposition<T>& decomposition);

}  // namespace wavefog
