#include "energy.h"

#include <cmath>
#include <numeric>

#include "wavefog/wavelet/bspline.h"

namespace wavefog::cli {
namespace {

/// out(i) = sum_k gram[|k|] row(i + k); outside is 0 or the row again.
Eigen::ArrayXd correlated(const Eigen::ArrayXd& row, const std::vector<double>& gram,
                          Boundary boundary) {
    const Eigen::Index width = row.size();
    const auto reach = static_cast<Eigen::Index>(gram.size()) - 1;
    Eigen::ArrayXd out = Eigen::ArrayXd::Zero(width);
    for (Eigen::Index k = -reach; k <= reach; ++k) {
        const double weight = gram[static_cast<std::size_t>(std::abs(k))];
        if (boundary == Boundary::repeat) {
            for (Eigen::Index i = 0; i < width; ++i)
                out(i) += weight * row(((i + k) % width + width) % width);
        } else if (std::abs(k) < width) {
            const Eigen::Index count = width - std::abs(k);
            out.segment(std::max<Eigen::Index>(0, -k), count) +=
                weight * row.segment(std::max<Eigen::Index>(0, k), count);
        }
    }
    return out;
}

}  // namespace

double squared_norm(const Band<float>& band, int degree, Boundary boundary) {
    std::vector<double> gram;
    for (int k = 0; k <= degree; ++k) gram.push_back(bspline(2 * degree + 1, degree + 1 + k));
    // Row by row: a large map as doubles would take more memory than all else.
    const auto row = [&](Eigen::Index j) -> Eigen::ArrayXd {
        return band.values.row(j).cast<double>().transpose();
    };
    const Eigen::Index height = band.values.rows();
    double sum = 0;
    for (Eigen::Index j = 0; j < height; ++j) {
        const Eigen::ArrayXd along_x = correlated(row(j), gram, boundary);
        for (Eigen::Index k = -degree; k <= degree; ++k) {
            const bool inside = j + k >= 0 && j + k < height;
            if (!inside && boundary != Boundary::repeat) continue;
            sum += gram[static_cast<std::size_t>(std::abs(k))] *
                   (along_x * row(((j + k) % height + height) % height)).sum();
        }
    }
    return sum;
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
