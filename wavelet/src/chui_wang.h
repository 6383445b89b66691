// Semi-orthogonal spline wavelets (Chui and Wang, Trans. AMS 330, 1992; stability.md 1.1 and 2).
#pragma once

#include <vector>

#include "banded.h"
#include "wavefog/wavelet/filters.h"

namespace wavefog {

/// Gram numbers <phi, phi(. - k)>, k = 0..d.
std::vector<double> bspline_gram(int degree);

/// q_k = (-1)^k 2^-d sum_l C(m, l) phi_{2m-1}(k - l + 1), m = d + 1, k = 0..3d+1.
Taps chui_wang_wavelet(int degree);

/// The L2-dual of the functions s(. - 2k) given by synthesis taps `s`: (S^T G S)^-1 S^T G on the
/// whole line, cut where it falls below 2^-60 of its largest tap.
Taps line_dual(const Taps& s, int degree);

/// Span of a few finely sampled functions among n B-splines phi_d(. - i), i = 0..n-1.
class SplineSubspace {
  public:
    struct Column {
        int start = 0;
        std::vector<double> taps;

        int end() const { return start + static_cast<int>(taps.size()); }
    };
    /// Columns must be linearly independent and sorted by start.
    SplineSubspace(int n, int degree, std::vector<Column> columns);

    int size() const { return static_cast<int>(columns_.size()); }
    /// Coefficients of the L2 projection of every column of `fine` (n rows); size() rows.
    Grid<double> project(const Grid<double>& fine) const;
    /// The functions back in fine B-splines: n rows from size() rows.
    Grid<double> expand(const Grid<double>& coarse) const;

  private:
    int n_;
    std::vector<Column> columns_;
    std::vector<Column> gram_columns_;  // G times columns_
    BandedLdlt gram_;
};

/// One level on a finite interval with zero boundary: of n B-splines with full support in
/// [0, n + d], floor((n - d) / 2) coarse ones have full support there too (approximation), and the
/// rest of the space is their L2-orthogonal complement (details): interior Chui-Wang wavelets, plus
/// d boundary wavelets at the left and d (d + 1 if n - d is odd) at the right, G-orthonormalised on
/// each side. An interval too short to separate its two sides (n < 6d + 2) gets one G-orthonormal
/// basis of the whole complement.
struct IntervalLevel {
    IntervalLevel(int n, int degree, bool with_details);

    /// 0 where no coarse B-spline fits.
    static int coarse_size(int n, int degree) { return n > degree ? (n - degree) / 2 : 0; }

    SplineSubspace approximation;
    SplineSubspace details;  ///< empty without details
};

}  // namespace wavefog
