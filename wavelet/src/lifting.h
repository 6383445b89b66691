// Fast transforms for the families that maps use most, 1,1 and 2,2 with zero extension: all levels
// in one pass over the map.
#pragma once

#include <span>

#include "range.h"
#include "wavefog/wavelet/decomposition.h"

namespace wavefog {

/// True where the functions below do the same as Scheme::split and Scheme::merge (to rounding).
bool has_lifting(const Family& family, Boundary boundary);

/// All levels of analysis of `fine`, whose first coefficient has the index (rect.x.first,
/// rect.z.first); even ones for 1,1. `details` (coarse to fine, one entry or more) and `coarse`
/// keep their storage where the sizes already fit.
template <class T>
void lifting_split(int degree, const Grid<T>& fine, const IndexRect& rect,
                   std::span<Detail<T>> details, Band<T>& coarse);

/// The inverse of lifting_split: fine coefficients on `rect`. Bands must have the sizes and starts
/// that lifting_split gives them.
template <class T>
void lifting_merge(int degree, const Band<T>& coarse, std::span<const Detail<T>> details,
                   const IndexRect& rect, Grid<T>& fine);

}  // namespace wavefog
