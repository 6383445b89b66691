// Certified bounds on the error of leaving details out.
#pragma once

#include <vector>

#include "wavefog/fogmap/fog.h"

namespace wavefog {

/// Cells of a block, along x and z, so that paths through a grid of blocks are found in
/// milliseconds: at most 128 blocks a side. In repeated fog a period is whole blocks.
Eigen::Vector2i path_blocks(int cells_x, int cells_z, bool repeat);

/// An upper bound on the integral of a density along any segment of at most `length` metres whose
/// ends differ by at most `rise` metres in height. `density`: 1/m, the largest in each block of
/// `block_x` x `block_z` metres, 0 outside or repeated. The segment's shadow on the ground takes
/// the heaviest path through the blocks (dynamic programming) and climbs through the densest: ds <=
/// |horizontal| + |dy|.
double heaviest_segment(const Grid<float>& density, double block_x, double block_z, bool repeat,
                        double length, double rise);

/// How far optical depth can be off when details are dropped, for every segment wherever it lies:
/// no picture is looked at, so the bound holds for all cameras.
///
/// Where only levels up to l count, the density is off by at most E_l(cell) = sum over the dropped
/// levels of the largest |residual coefficient| that reaches the cell (B-splines are not negative
/// and sum to 1, so a spline lies within its coefficients), and a segment's integral of it by
/// heaviest_segment(). The clamp of steps at 0 only brings a sum closer to that of a map without
/// negative density.
class DetailBound {
  public:
    /// `fog` must pass Fog::validate() and be non-negative at its finest level.
    explicit DetailBound(const Fog& fog);

    /// |tau_mu - tau| for every segment of at most `length` metres whose ends differ by at most
    /// `rise` metres in height; rule of mu as in Reference::optical_depth. 0 at mu = 1. Rounding is
    /// not counted.
    double optical_depth(double mu, double length, double rise) const;

    /// |T_mu - T|, from the same: T <= 1, so that |dT| <= 1 - exp(-|dtau|).
    double transmittance(double mu, double length, double rise) const;

    int levels() const { return static_cast<int>(dropped_.size()); }
    /// E_l by blocks of cells, times extinction, 1/m; block (0, 0) begins where the map's box does.
    const Grid<float>& dropped(int level) const { return dropped_[std::size_t(level)]; }
    double block_x() const { return block_x_; }  ///< metres
    double block_z() const { return block_z_; }

  private:
    std::vector<Grid<float>> dropped_;  ///< [l]: E_l by blocks of cells, times extinction, 1/m
    double block_x_ = 1, block_z_ = 1;  ///< metres
    bool repeat_ = false;
};

}  // namespace wavefog
