// Causal B-splines phi_d of any degree d: support [0, d + 1], integer knots, sum_k phi_d(x - k)
// = 1.
#pragma once

#include <Eigen/Core>
#include <vector>

namespace wavefog {

/// phi_d(x) by the Cox-de Boor recurrence. Half-open pieces: phi_0(0) = 1, phi_0(1) = 0.
double bspline(int degree, double x);

/// Integral of phi_d over (-inf, x]; 0 for x <= 0, 1 for x >= d + 1.
double bspline_integral(int degree, double x);

/// Polynomial pieces: column p (0..d) holds the coefficients of phi_d(p + t) = sum_n B(n, p) t^n,
/// t in [0, 1]. Size (d + 1) x (d + 1).
Eigen::MatrixXd bspline_pieces(int degree);

/// Two-scale relation phi_d(x) = sum_k p_k phi_d(2x - k), p_k = 2^-d C(d + 1, k), k = 0..d+1;
/// sum 2. (paper 004, eq. 6)
std::vector<double> two_scale(int degree);

}  // namespace wavefog
