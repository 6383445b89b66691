#include "chui_wang.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "wavefog/wavelet/bspline.h"

namespace wavefog {
namespace {

using Column = SplineSubspace::Column;

// G column, where G(i, j) = <phi(. - i), phi(. - j)> acts on indices first..last.
Column times_gram(const Column& column, const std::vector<double>& gram, int first, int last) {
    const int d = static_cast<int>(gram.size()) - 1;
    Column out;
    out.start = std::max(first, column.start - d);
    const int end = std::min(last + 1, column.end() + d);
    for (int i = out.start; i < end; ++i) {
        double sum = 0;
        for (int j = std::max(column.start, i - d); j < std::min(column.end(), i + d + 1); ++j)
            sum += gram[static_cast<std::size_t>(std::abs(i - j))] *
                   column.taps[static_cast<std::size_t>(j - column.start)];
        out.taps.push_back(sum);
    }
    return out;
}

double dot(const Column& x, const Column& y) {
    double sum = 0;
    for (int i = std::max(x.start, y.start); i < std::min(x.end(), y.end()); ++i)
        sum += x.taps[static_cast<std::size_t>(i - x.start)] *
               y.taps[static_cast<std::size_t>(i - y.start)];
    return sum;
}

BandedLdlt gram_factor(const std::vector<Column>& columns,
                       const std::vector<Column>& gram_columns) {
    const int size = static_cast<int>(columns.size());
    int half_bandwidth = 0;
    for (int i = 0, j = 0; i < size; ++i) {
        while (j + 1 < size && columns[static_cast<std::size_t>(j + 1)].start <
                                   gram_columns[static_cast<std::size_t>(i)].end())
            ++j;
        half_bandwidth = std::max(half_bandwidth, j - i);
    }
    BandedLdlt gram(size, half_bandwidth);
    for (int i = 0; i < size; ++i)
        for (int below = 0; below <= std::min(i, half_bandwidth); ++below)
            gram.entry(i, below) = dot(columns[static_cast<std::size_t>(i)],
                                       gram_columns[static_cast<std::size_t>(i - below)]);
    gram.factor();
    return gram;
}

std::vector<Column> coarse_columns(int n, int degree) {
    std::vector<Column> columns;
    const std::vector<double> p = two_scale(degree);
    for (int k = 0; k < IntervalLevel::coarse_size(n, degree); ++k) columns.push_back({2 * k, p});
    return columns;
}

// G-orthonormal basis (times `norm`) of the functions on fine indices first..first+count-1 that are
// orthogonal to all coarse B-splines of the interval.
std::vector<Column> complement(int n, int degree, int first, int count, double norm) {
    if (count == 0) return {};
    const std::vector<double> gram = bspline_gram(degree);
    std::vector<Column> constraints;
    for (const Column& coarse : coarse_columns(n, degree)) {
        const Column row = times_gram(coarse, gram, 0, n - 1);
        if (row.start < first + count && row.end() > first) constraints.push_back(row);
    }
    const int rank = static_cast<int>(constraints.size());
    Eigen::MatrixXd basis = Eigen::MatrixXd::Identity(count, count);
    if (rank > 0) {
        Eigen::MatrixXd transposed = Eigen::MatrixXd::Zero(count, rank);
        for (int k = 0; k < rank; ++k) {
            const Column& row = constraints[static_cast<std::size_t>(k)];
            for (int i = std::max(first, row.start); i < std::min(first + count, row.end()); ++i)
                transposed(i - first, k) = row.taps[static_cast<std::size_t>(i - row.start)];
        }
        // The last columns of the full orthogonal factor span the null space of the constraints.
        const Eigen::MatrixXd q = transposed.householderQr().householderQ();
        basis = q.rightCols(count - rank).eval();
    }
    Eigen::MatrixXd metric = Eigen::MatrixXd::Zero(count, count);
    for (int i = 0; i < count; ++i)
        for (int j = std::max(0, i - degree); j <= std::min(count - 1, i + degree); ++j)
            metric(i, j) = gram[static_cast<std::size_t>(std::abs(i - j))];
    const Eigen::LLT<Eigen::MatrixXd> cholesky(basis.transpose() * metric * basis);
    const Eigen::MatrixXd orthonormal =
        cholesky.matrixL().solve(basis.transpose()).transpose() * norm;
    std::vector<Column> columns;
    for (Eigen::Index k = 0; k < orthonormal.cols(); ++k) {
        const Eigen::VectorXd taps = orthonormal.col(k);
        columns.push_back({first, {taps.data(), taps.data() + taps.size()}});
    }
    return columns;
}

std::vector<Column> detail_columns(int n, int degree) {
    const Taps wavelet = chui_wang_wavelet(degree);
    const Column interior{0, wavelet.values};
    const double norm = std::sqrt(
        dot(interior, times_gram(interior, bspline_gram(degree), -degree, 4 * degree + 1)));
    if (n < 6 * degree + 2) return complement(n, degree, 0, n, norm);
    const int side = 3 * degree, odd = (n - degree) % 2;
    std::vector<Column> columns = complement(n, degree, 0, side, norm);
    for (int k = 0; 2 * k + side + 2 <= n; ++k) columns.push_back({2 * k, wavelet.values});
    for (Column& column : complement(n, degree, n - side - odd, side + odd, norm))
        columns.push_back(std::move(column));
    return columns;
}

}  // namespace

std::vector<double> bspline_gram(int degree) {
    std::vector<double> gram;
    for (int k = 0; k <= degree; ++k) gram.push_back(bspline(2 * degree + 1, degree + 1 + k));
    return gram;
}

Taps chui_wang_wavelet(int degree) {
    const int m = degree + 1;
    Taps q{0, {}};
    for (int k = 0; k <= 3 * degree + 1; ++k) {
        double sum = 0, binomial = 1;
        for (int l = 0; l <= m; ++l) {
            sum += binomial * bspline(2 * m - 1, k - l + 1);
            binomial = binomial * (m - l) / (l + 1);
        }
        q.values.push_back(std::ldexp(k % 2 == 0 ? sum : -sum, -degree));
    }
    return q;
}

Taps line_dual(const Taps& s, int degree) {
    // A section long enough that its middle does not feel the ends: the slowest pole is 0.88 at
    // degree 15, and 0.88^400 < 2^-60.
    constexpr int reach = 400;
    const std::vector<double> gram = bspline_gram(degree);
    std::vector<Column> columns, gram_columns;
    constexpr int far = 8 * reach;
    for (int k = 0; k <= 2 * reach; ++k) {
        columns.push_back({2 * k + s.start, s.values});
        gram_columns.push_back(times_gram(columns.back(), gram, -far, far));
    }
    Grid<double> row = Grid<double>::Zero(2 * reach + 1, 1);
    row(reach, 0) = 1;
    gram_factor(columns, gram_columns).solve_in_place(row);
    std::vector<double> dual(static_cast<std::size_t>(2 * far + 1), 0.0);
    for (int k = 0; k <= 2 * reach; ++k) {
        const Column& column = gram_columns[static_cast<std::size_t>(k)];
        for (int i = column.start; i < column.end(); ++i)
            dual[static_cast<std::size_t>(i - 2 * reach + far)] +=
                row(k, 0) * column.taps[static_cast<std::size_t>(i - column.start)];
    }
    double largest = 0;
    for (const double tap : dual) largest = std::max(largest, std::abs(tap));
    const auto kept = [&](double tap) { return std::abs(tap) > std::ldexp(largest, -60); };
    const auto first = std::find_if(dual.begin(), dual.end(), kept);
    const auto last = std::find_if(dual.rbegin(), dual.rend(), kept).base();
    return {static_cast<int>(first - dual.begin()) - far, {first, last}};
}

SplineSubspace::SplineSubspace(int n, int degree, std::vector<Column> columns)
    : n_(n), columns_(std::move(columns)), gram_(0, 0) {
    const std::vector<double> gram = bspline_gram(degree);
    for (const Column& column : columns_)
        gram_columns_.push_back(times_gram(column, gram, 0, n - 1));
    gram_ = gram_factor(columns_, gram_columns_);
}

Grid<double> SplineSubspace::project(const Grid<double>& fine) const {
    Grid<double> out = Grid<double>::Zero(size(), fine.cols());
    for (int k = 0; k < size(); ++k) {
        const Column& column = gram_columns_[static_cast<std::size_t>(k)];
        for (int i = column.start; i < column.end(); ++i)
            out.row(k) += column.taps[static_cast<std::size_t>(i - column.start)] * fine.row(i);
    }
    gram_.solve_in_place(out);
    return out;
}

Grid<double> SplineSubspace::expand(const Grid<double>& coarse) const {
    Grid<double> out = Grid<double>::Zero(n_, coarse.cols());
    for (int k = 0; k < size(); ++k) {
        const Column& column = columns_[static_cast<std::size_t>(k)];
        for (int i = column.start; i < column.end(); ++i)
            out.row(i) += column.taps[static_cast<std::size_t>(i - column.start)] * coarse.row(k);
    }
    return out;
}

IntervalLevel::IntervalLevel(int n, int degree, bool with_details)
    : approximation(n, degree, coarse_columns(n, degree)),
      details(n, degree, with_details ? detail_columns(n, degree) : std::vector<Column>{}) {}

}  // namespace wavefog
