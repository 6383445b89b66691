#include "energy.h"

#include <cmath>
#include <numeric>

#include "wavefog/wavelet/bspline.h"

namespace wavefog::cli {
namespace {

/// out(j, i) = sum_k gram[|k|] in(j, i + k) along rows; outside is 0 or the row again.
Grid<double> correlate_rows(const Grid<double>& in, const std::vector<double>& gram,
                            Boundary boundary) {
    const Eigen::Index width = in.cols();
    const auto reach = static_cast<Eigen::Index>(gram.size()) - 1;
    Grid<double> out = Grid<double>::Zero(in.rows(), width);
    for (Eigen::Index k = -reach; k <= reach; ++k) {
        const double weight = gram[static_cast<std::size_t>(std::abs(k))];
        if (boundary == Boundary::repeat) {
            for (Eigen::Index i = 0; i < width; ++i)
                out.col(i) += weight * in.col(((i + k) % width + width) % width);
        } else if (std::abs(k) < width) {
            const Eigen::Index count = width - std::abs(k);
            out.middleCols(std::max<Eigen::Index>(0, -k), count) +=
                weight * in.middleCols(std::max<Eigen::Index>(0, k), count);
        }
    }
    return out;
}

}  // namespace

double squared_norm(const Band<float>& band, int degree, Boundary boundary) {
    std::vector<double> gram;
    for (int k = 0; k <= degree; ++k) gram.push_back(bspline(2 * degree + 1, degree + 1 + k));
    const Grid<double> values = band.values.cast<double>();
    const Grid<double> along_x = correlate_rows(values, gram, boundary);
    const Grid<double> along_z = correlate_rows(along_x.transpose(), gram, boundary).transpose();
    return (values * along_z).sum();
}

std::vector<double> energy_shares(const Decomposition<float>& decomposition) {
    const auto scaling =
        decomposition.form == Form::scaling ? decomposition : to_scaling_form(decomposition);
    const int levels = scaling.levels();
    const auto energy = [&](const Band<float>& band, int coarsenings) {
        return std::ldexp(squared_norm(band, scaling.degree(), scaling.boundary), 2 * coarsenings);
    };
    std::vector<double> shares = {energy(scaling.approximation, levels)};
    for (int level = 1; level <= levels; ++level)
        shares.push_back(
            energy(scaling.details[static_cast<std::size_t>(level) - 1].residual, levels - level));
    const double total = std::accumulate(shares.begin(), shares.end(), 0.0);
    if (total > 0)
        for (double& share : shares) share /= total;
    return shares;
}

}  // namespace wavefog::cli
