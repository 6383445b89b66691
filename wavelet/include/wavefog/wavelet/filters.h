// Filter banks: exact rational taps of the biorthogonal spline (CDF) families, and the same as
// doubles for the transform.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "wavefog/wavelet/family.h"
#include "wavefog/wavelet/result.h"

namespace wavefog {

/// Taps numerators[i] / denominator at index start + i.
struct ExactTaps {
    int start = 0;
    std::int64_t denominator = 1;
    std::vector<std::int64_t> numerators;

    int last() const { return start + static_cast<int>(numerators.size()) - 1; }
    /// Numerator at `index`, 0 outside.
    std::int64_t numerator(int index) const {
        return index < start || index > last()
                   ? 0
                   : numerators[static_cast<std::size_t>(index - start)];
    }
};

/// a_k = sum_n h_{n-2k} c_n,  b_k = sum_n g_{n-2k} c_n,  c_n = sum_k p_{n-2k} a_k + q_{n-2k} b_k
/// with sum p = 2, sum h = 1, g_n = (-1)^n p_{1-n} / 2 and q_n = 2 (-1)^n h_{1-n} (paper 004, eq. 5
/// to 9, in the normalisation of densities: stability.md 1.1).
struct FilterBank {
    int order = 2;         ///< N = degree + 1
    int dual_moments = 2;  ///< Nt
    ExactTaps h, g, p, q;
};

/// The (N, Nt) pairs that exist: 1,1 1,3 2,0 2,2 2,4 3,1 3,3 3,5 3,7 4,2 4,4 4,6.
const std::vector<std::pair<int, int>>& cdf_pairs();

/// Exact taps of the family N,Nt; a usage error for a pair that is not in cdf_pairs().
Result<FilterBank> cdf_filters(int order, int dual_moments);

/// values[i] at index start + i.
struct Taps {
    int start = 0;
    std::vector<double> values;

    int last() const { return start + static_cast<int>(values.size()) - 1; }
};

/// A bank in floating point; g and q are empty for Kind::positive, which has no wavelets.
struct Filters {
    Taps h, g, p, q;
};

/// Filters of any family on the whole line. Chui-Wang duals have infinite support: theirs are cut
/// where they fall below 2^-60 of the largest tap, and serve Boundary::repeat.
Result<Filters> filters(const Family& family);

}  // namespace wavefog
