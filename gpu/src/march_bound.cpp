#include "wavefog/gpu/march_bound.h"

#include <algorithm>
#include <cmath>

#include "cell_ranges.h"
#include "wavefog/fogmap/bound.h"

namespace wavefog {
namespace {

// A texel's weight is off by half a step of 1/256, along x and along z.
constexpr double kWeights = 2.0 / 400;

}  // namespace

MarchBound::MarchBound(const Fog& fog)
    : repeat_(fog.decomposition.boundary == Boundary::repeat), stepped_(fog.degree() == 0) {
    const Eigen::Vector2d cell(fog.cell_x(), fog.cell_z());
    const auto pyramid = approximations(fog.decomposition);
    const CellRanges ranges(pyramid.levels.back(), fog.degree(), fog.decomposition.boundary, cell,
                            fog.extinction);
    densest_ = ranges.largest();
    held_ =
        fog.profile.kind == Profile::Kind::exponential || fog.profile.kind == Profile::Kind::linear;
    const Eigen::Vector2i block = path_blocks(ranges.cells_x(), ranges.cells_z(), repeat_);
    block_x_ = block.x() * cell.x();
    block_z_ = block.y() * cell.y();
    const auto blocks = [](int cells, int size) { return (cells + size - 1) / size; };
    sampled_ =
        Grid<float>::Zero(blocks(ranges.cells_z(), block.y()), blocks(ranges.cells_x(), block.x()));
    read_ = sampled_;
    // A path counts a block's whole diagonal, so that lines crossed count as if spread along it.
    const double per_line = 1 / cell.minCoeff();
    for (int z = 0; z < ranges.cells_z(); ++z)
        for (int x = 0; x < ranges.cells_x(); ++x) {
            const CellRange here = ranges.of(x, x, z, z);
            // The lines on all four sides.
            const CellRange around = ranges.of(x, x + 1, z, z + 1);
            const CellRange before = ranges.of(x - 1, x, z - 1, z);
            const double jump = static_cast<double>(std::max(around.jump_x, before.jump_x) +
                                                    std::max(around.jump_z, before.jump_z));
            jump_ = std::max(jump_, jump);
            const double curved = static_cast<double>(here.xx + here.xz + here.zz);
            const double off = stepped_ ? jump * per_line / 2 : (curved + jump * per_line) / 8;
            double read = 0;
            if (!stepped_) read = kWeights * static_cast<double>(here.high - here.low);
            if (fog.degree() == 2)
                read += (static_cast<double>(here.xx) * cell.x() * cell.x() +
                         static_cast<double>(here.zz) * cell.y() * cell.y()) /
                        8;
            float& sampled = sampled_(z / block.y(), x / block.x());
            sampled = std::max(sampled, static_cast<float>(off));
            float& reads = read_(z / block.y(), x / block.x());
            reads = std::max(reads, static_cast<float>(read));
        }
}

double MarchBound::optical_depth(int samples, double length, double rise) const {
    if (length <= 0) return 0;
    const double step = length / samples, scale = stepped_ ? step : step * step;
    const auto along = [&](const Grid<float>& grid) {
        return heaviest_segment(grid, block_x_, block_z_, repeat_, length, rise);
    };
    const double line = jump_ * scale / (stepped_ ? 2 : 8);
    double error = scale * along(sampled_) + line + along(read_);
    if (held_) error += densest_ * step / 2;
    return std::min(error, densest_ * length);
}

}  // namespace wavefog
