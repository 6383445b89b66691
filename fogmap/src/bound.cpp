#include "wavefog/fogmap/bound.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace wavefog {
namespace {

constexpr int kMostBlocks = 128;

/// Adds to every block the largest |coefficient| of `residual` that reaches one of its cells.
/// `size`: finest cells a cell of the residual's grid.
void add_reach(const Band<float>& residual, int size, int degree, const Eigen::Vector2i& block,
               bool repeat, Grid<float>& sum) {
    Grid<float> most = Grid<float>::Zero(sum.rows(), sum.cols());
    // The blocks under the support [k, k + degree + 1] of index k, not wrapped.
    const auto blocks = [&](int k, int cells) {
        const double from = double(k) * size / cells, to = double(k + degree + 1) * size / cells;
        return std::pair(int(std::floor(from)), int(std::ceil(to)) - 1);
    };
    const auto wrapped = [&](int b, Eigen::Index count) {
        const int n = int(count);
        if (repeat) return (b % n + n) % n;
        return b >= 0 && b < n ? b : -1;
    };
    for (int j = 0; j < residual.height(); ++j) {
        const auto [z0, z1] = blocks(residual.start_z + j, block.y());
        for (int i = 0; i < residual.width(); ++i) {
            const float value = std::abs(residual.values(j, i));
            if (value == 0) continue;
            const auto [x0, x1] = blocks(residual.start_x + i, block.x());
            for (int bz = z0; bz <= z1; ++bz)
                for (int bx = x0; bx <= x1; ++bx) {
                    const int r = wrapped(bz, sum.rows());
                    const int c = wrapped(bx, sum.cols());
                    if (r >= 0 && c >= 0) most(r, c) = std::max(most(r, c), value);
                }
        }
    }
    sum += most;
}

/// The largest sum over `columns` neighbouring columns of a path that moves at most one row a
/// column; each column counts the larger of the rows where the path enters and leaves it.
double heaviest_path(const Grid<float>& density, Eigen::Index columns, bool repeat) {
    const Eigen::Index rows = density.rows(), width = density.cols();
    // best(r, c): of the paths of k columns that end in column c at row r.
    Grid<float> best = Grid<float>::Zero(rows, width), next(rows, width);
    for (Eigen::Index k = 0; k < columns; ++k) {
        for (Eigen::Index c = 0; c < width; ++c) {
            const bool first = c == 0 && !repeat;
            const Eigen::Index before = c == 0 ? width - 1 : c - 1;
            for (Eigen::Index r = 0; r < rows; ++r) {
                float most = 0;
                for (Eigen::Index step = -1; step <= 1; ++step) {
                    Eigen::Index from = r + step;
                    if (repeat)
                        from = (from + rows) % rows;
                    else if (from < 0 || from >= rows)
                        continue;
                    const float here = std::max(density(r, c), density(from, c));
                    most = std::max(most, here + (first ? 0 : best(from, before)));
                }
                next(r, c) = most;
            }
        }
        best.swap(next);
    }
    return double(best.maxCoeff());
}

}  // namespace

Eigen::Vector2i path_blocks(int cells_x, int cells_z, bool repeat) {
    int block = 1;
    while (std::max(cells_x, cells_z) > block * kMostBlocks) block *= 2;
    // Paths count whole blocks; a period that has none is one block, whose bound is looser.
    if (repeat && (cells_x % block != 0 || cells_z % block != 0)) return {cells_x, cells_z};
    return {block, block};
}

double heaviest_segment(const Grid<float>& density, double block_x, double block_z, bool repeat,
                        double length, double rise) {
    if (length <= 0) return 0;
    const auto along = [&](const Grid<float>& grid, double across) {
        // Lines flatter than a block's diagonal enter at most two rows of a column; a segment
        // touches one column more than it covers.
        const double covered = std::ceil(length / across) + 1;
        const double width = double(grid.cols());
        if (covered <= width) return heaviest_path(grid, Eigen::Index(covered), repeat);
        const double turns = repeat ? std::ceil(covered / width) : 1;
        return turns * heaviest_path(grid, grid.cols(), repeat);
    };
    const double heaviest = std::max(along(density, block_x), along(density.transpose(), block_z));
    const double through_block = std::min(std::hypot(block_x, block_z), length);
    const double most = double(density.maxCoeff());
    return std::min(heaviest * through_block + rise * most, length * most);
}

DetailBound::DetailBound(const Fog& fog) : repeat_(fog.decomposition.boundary == Boundary::repeat) {
    const Decomposition<float> scaling = fog.decomposition.form == Form::scaling
                                             ? fog.decomposition
                                             : to_scaling_form(fog.decomposition);
    const int levels = scaling.levels(), degree = scaling.degree();
    const int cells_x = scaling.width + (repeat_ ? 0 : degree);
    const int cells_z = scaling.height + (repeat_ ? 0 : degree);
    const Eigen::Vector2i block = path_blocks(cells_x, cells_z, repeat_);
    block_x_ = block.x() * fog.cell_x();
    block_z_ = block.y() * fog.cell_z();
    dropped_.resize(std::size_t(levels));
    Grid<float> sum = Grid<float>::Zero((cells_z + block.y() - 1) / block.y(),
                                        (cells_x + block.x() - 1) / block.x());
    for (int l = levels - 1; l >= 0; --l) {
        add_reach(scaling.details[std::size_t(l)].residual, 1 << (levels - 1 - l), degree, block,
                  repeat_, sum);
        dropped_[std::size_t(l)] = sum * float(fog.extinction);
    }
}

double DetailBound::optical_depth(double mu, double length, double rise) const {
    double sum = 0;
    for (int l = 0; l < levels(); ++l) {
        // Level l is the finest that counts from length mu^(l + 1) to length mu^l.
        const double from = std::pow(mu, l + 1), to = std::pow(mu, l);
        const double share = to - from;
        sum += heaviest_segment(dropped_[std::size_t(l)], block_x_, block_z_, repeat_,
                                length * share, rise * share);
    }
    return sum;
}

double DetailBound::transmittance(double mu, double length, double rise) const {
    return -std::expm1(-optical_depth(mu, length, rise));
}

}  // namespace wavefog
