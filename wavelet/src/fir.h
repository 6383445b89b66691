// Two-channel FIR filtering along one axis of a grid, for any taps and both boundaries.
#pragma once

#include "range.h"
#include "wavefog/wavelet/filters.h"

namespace wavefog {

enum class Axis { x, z };

/// floor(i / 2) for negative i too.
inline int half_down(int i) {
    return i >= 0 ? i / 2 : (i - 1) / 2;
}
inline int half_up(int i) {
    return -half_down(-i);
}

/// Where sum_n f_{n-2k} c_n can be nonzero for c on `fine`; never empty.
Range analysed_range(const Taps& taps, Range fine);
/// Where sum_k f_{n-2k} a_k can be nonzero for a on `coarse`.
Range synthesised_range(const Taps& taps, Range coarse);

/// out_k = sum_n f_{n-2k} in_n for k in `out`; `in` covers the indices `fine` along the axis. With
/// repeat, indices wrap with the period fine.size().
Grid<double> analyse(Axis axis, const Taps& taps, const Grid<double>& in, Range fine, Range out,
                     Boundary boundary);

/// out_n += sum_k f_{n-2k} in_k for n in `fine`; `in` covers the indices `coarse`. With repeat,
/// indices wrap with the period fine.size().
void synthesise_into(Axis axis, const Taps& taps, const Grid<double>& in, Range coarse, Range fine,
                     Boundary boundary, Grid<double>& out);

}  // namespace wavefog
