// One cell of a spline surface: its polynomial, and integrals along straight segments inside it.
#pragma once

#include <vector>

#include "wavefog/wavelet/decomposition.h"

namespace wavefog {

/// Coefficients of the polynomial that a degree-(d,d) spline is inside one cell:
///     rho(u, v) = sum_{m,n} c[m * (d + 1) + n] u^n v^m,  local u (x), v (z) in [0, 1].
/// `out` has (d + 1)^2 entries. Cell (cx, cz) is [cx, cx+1] x [cz, cz+1] in the band's own units.
/// With Boundary::repeat the band's indices wrap.
template <class T>
void cell_polynomial(const Band<T>& band, int degree, Boundary boundary, int cx, int cz,
                     double* out);

/// Polynomials of cells [0, cells_x) x [0, cells_z), row-major, (d+1)^2 floats a cell.
std::vector<float> cell_polynomials(const Band<float>& band, int degree, Boundary boundary,
                                    int cells_x, int cells_z);

/// Mean of rho over the segment (u0,v0) -> (u1,v1) inside one cell, in closed form; multiply by the
/// segment's length for the integral. Finite for a segment of length 0. degree <= max_degree.
double segment_mean(const double* polynomial, int degree, double u0, double v0, double u1,
                    double v1);

/// Mean of the tensor B-spline phi_d(u) phi_d(v) over the segment (u0,v0) -> (u1,v1) anywhere in
/// the plane, split at the knots and in closed form between them; multiply by the length for the
/// integral. A segment of length 0 has the value at its point.
double bspline_segment_mean(int degree, double u0, double v0, double u1, double v1);

/// Nodes in (0, 1) and weights (sum 1) of the n-point Gauss-Legendre rule, n = 1..64: exact to
/// degree 2n - 1.
struct GaussRule {
    std::vector<double> nodes;
    std::vector<double> weights;
};
const GaussRule& gauss_legendre(int n);

}  // namespace wavefog
