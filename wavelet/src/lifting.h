// Fast one-pass transforms for the families that maps use most, 1,1 and 2,2 with zero extension.
#pragma once

#include "range.h"
#include "wavefog/wavelet/decomposition.h"

namespace wavefog {

/// True where the functions below do the same as Scheme::split and Scheme::merge (to rounding).
bool has_lifting(const Family& family, Boundary boundary);

/// One level of analysis: returns the approximation of `fine`, whose first coefficient has the
/// index (rect.x.first, rect.z.first), and fills the wavelet bands. For 1,1 both must be even.
template <class T>
Band<T> lifting_split(int degree, const Grid<T>& fine, const Rect& rect, Detail<T>& detail);

/// The inverse of lifting_split: fine coefficients on `rect`. Bands must have the sizes and starts
/// that lifting_split gives them.
template <class T>
Grid<T> lifting_merge(int degree, const Band<T>& coarse, const Detail<T>& detail, const Rect& rect);

}  // namespace wavefog
