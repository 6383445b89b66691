// How far a spline surface and its derivatives range over a few cells.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "wavefog/wavelet/decomposition.h"

namespace wavefog {

/// Of a cell, or of a box of cells. Derivatives are per metre. A spline lies within its
/// coefficients, and its derivatives within their differences.
struct CellRange {
    float low = 0, high = 0;
    float x_low = 0, x_high = 0, z_low = 0, z_high = 0;  ///< of the first derivatives
    float xx = 0, xz = 0, zz = 0;                        ///< largest |second derivative|
    /// Jump across the cell's face of lower x (z): of the density for degree 0, of its derivative
    /// along x (z) for degree 1. Of a box: the largest along each line inside, summed over lines.
    float jump_x = 0, jump_z = 0;
};

/// Of every cell of a map's finest level, the values times `factor`. Outside the map all is 0.
class CellRanges {
  public:
    CellRanges(const Band<float>& map, int degree, Boundary boundary,
               const Eigen::Vector2d& cell_metres, double factor);

    /// Of the cells [x0, x1] x [z0, z1].
    CellRange of(int x0, int x1, int z0, int z1) const;
    /// Value at a point, in cells; `x`, `z` is the cell that it lies in.
    double value(int x, int z, const Eigen::Vector2d& point) const;

    int degree() const { return degree_; }
    bool repeat() const { return repeat_; }
    int cells_x() const { return width_; }
    int cells_z() const { return height_; }
    double largest() const { return largest_; }

  private:
    const CellRange& at(int x, int z) const;

    int degree_, width_, height_;
    bool repeat_;
    double factor_, largest_ = 0;
    std::vector<CellRange> ranges_;  ///< one more cell along x and z unless it repeats
    std::vector<float> polynomials_;
};

}  // namespace wavefog
