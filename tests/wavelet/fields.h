// Independent evaluation of fields from coefficients: sums of B-splines and wavelets, written from
// the definitions in decomposition.h and never through the transform.
#pragma once

#include "wavefog/wavelet/bspline.h"
#include "wavefog/wavelet/decomposition.h"
#include "wavefog/wavelet/filters.h"

namespace wavefog::test {

/// phi_d at every index of a band's axis: value(i) = phi_d(x - (start + i)).
inline Eigen::VectorXd phi_values(int degree, double x, int start, int count) {
    Eigen::VectorXd values(count);
    for (int i = 0; i < count; ++i) values(i) = bspline(degree, x - (start + i));
    return values;
}

/// psi(x - k) with psi(x) = sum_n q_n phi_d(2x - n).
inline Eigen::VectorXd psi_values(int degree, const Taps& q, double x, int start, int count) {
    Eigen::VectorXd values = Eigen::VectorXd::Zero(count);
    for (int i = 0; i < count; ++i)
        for (int n = q.start; n <= q.last(); ++n)
            values(i) += q.values[static_cast<std::size_t>(n - q.start)] *
                         bspline(degree, 2 * (x - (start + i)) - n);
    return values;
}

/// Field of a band of scaling functions on cells of `cell` finest cells.
template <class T>
double scaling_field(const Band<T>& band, int degree, double cell, double u, double v) {
    const auto x = phi_values(degree, u / cell, band.start_x, band.width());
    const auto z = phi_values(degree, v / cell, band.start_z, band.height());
    return z.dot(band.values.template cast<double>().matrix() * x);
}

/// Field of a whole decomposition with zero extension: the sum over all its bands.
template <class T>
double field(const Decomposition<T>& decomposition, double u, double v) {
    const int d = decomposition.degree(), levels = decomposition.levels();
    double sum = scaling_field(decomposition.approximation, d, std::ldexp(1.0, levels), u, v);
    const Filters bank = *filters(decomposition.family);
    for (int l = 1; l <= levels; ++l) {
        const Detail<T>& detail = decomposition.details[static_cast<std::size_t>(l - 1)];
        if (decomposition.form == Form::scaling) {
            sum += scaling_field(detail.residual, d, std::ldexp(1.0, levels - l), u, v);
            continue;
        }
        const double x = std::ldexp(u, l - 1 - levels), z = std::ldexp(v, l - 1 - levels);
        const auto add = [&](const Band<T>& band, bool psi_x, bool psi_z) {
            const auto values = [&](bool psi, double at, int start, int count) {
                return psi ? psi_values(d, bank.q, at, start, count)
                           : phi_values(d, at, start, count);
            };
            sum += values(psi_z, z, band.start_z, band.height())
                       .dot(band.values.template cast<double>().matrix() *
                            values(psi_x, x, band.start_x, band.width()));
        };
        add(detail.phi_psi, false, true);
        add(detail.psi_phi, true, false);
        add(detail.psi_psi, true, true);
    }
    return sum;
}

}  // namespace wavefog::test
