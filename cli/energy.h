// How much each level contributes to a fog.
#pragma once

#include <vector>

#include "wavefog/wavelet/decomposition.h"

namespace wavefog::cli {

/// Squared L2 norm of sum c(i,j) phi(u - i) phi(v - j) for causal B-splines phi on unit cells:
/// c^T G c with the splines' Gram matrix, phi * phi(-.) = B-spline of degree 2d + 1. With `repeat`
/// the norm is over one period, which the band fills.
double squared_norm(const Band<float>& band, int degree, Boundary boundary);

/// Shares (sum 1; all 0 for an empty map) of the squared norms of the approximation and of the
/// function each level of details adds. The same for both forms of a decomposition.
std::vector<double> energy_shares(const Decomposition<float>& decomposition);

}  // namespace wavefog::cli
