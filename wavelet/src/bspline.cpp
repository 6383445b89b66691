#include "wavefog/wavelet/bspline.h"

#include <cmath>

namespace wavefog {

double bspline(int degree, double x) {
    if (!(x >= 0 && x < degree + 1)) return 0;
    // Cox-de Boor on translates: after step n, value[i] = phi_n(x - i).
    std::vector<double> value(static_cast<std::size_t>(degree) + 2, 0.0);
    value[static_cast<std::size_t>(x)] = 1;
    for (int n = 1; n <= degree; ++n)
        for (int i = 0; i <= degree - n; ++i) {
            const auto at = static_cast<std::size_t>(i);
            value[at] = ((x - i) * value[at] + (n + 1 - x + i) * value[at + 1]) / n;
        }
    return value[0];
}

double bspline_integral(int degree, double x) {
    if (!(x > 0)) return 0;
    if (x >= degree + 1) return 1;
    // phi_d is the derivative of the sum of all translates of phi_{d+1} to its right.
    double sum = 0;
    for (int k = 0; k <= static_cast<int>(x); ++k) sum += bspline(degree + 1, x - k);
    return sum;
}

Eigen::MatrixXd bspline_pieces(int degree) {
    Eigen::MatrixXd pieces = Eigen::MatrixXd::Ones(1, 1);
    for (int d = 1; d <= degree; ++d) {
        // d phi_d(p + t) = (p + t) phi_{d-1}(p + t) + (d + 1 - p - t) phi_{d-1}(p - 1 + t)
        Eigen::MatrixXd next = Eigen::MatrixXd::Zero(d + 1, d + 1);
        for (int p = 0; p <= d; ++p) {
            if (p < d) {
                next.col(p).head(d) += p * pieces.col(p);
                next.col(p).tail(d) += pieces.col(p);
            }
            if (p > 0) {
                next.col(p).head(d) += (d + 1 - p) * pieces.col(p - 1);
                next.col(p).tail(d) -= pieces.col(p - 1);
            }
        }
        pieces = next / d;
    }
    return pieces;
}

std::vector<double> two_scale(int degree) {
    std::vector<double> p(static_cast<std::size_t>(degree) + 2);
    p[0] = std::ldexp(1.0, -degree);
    for (int k = 1; k <= degree + 1; ++k) {
        const auto at = static_cast<std::size_t>(k);
        p[at] = p[at - 1] * (degree + 2 - k) / k;
    }
    return p;
}

}  // namespace wavefog
