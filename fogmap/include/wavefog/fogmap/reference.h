// The truth: optical depth in double, exact per finest cell.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "wavefog/fogmap/fog.h"

namespace wavefog {

/// Integrates extinction along segments. Clips to the map and the height profile, splits at every
/// knot of the grid in use and at the profile's corners, Gauss-Legendre per piece: d + 1 nodes
/// (exact: a degree-(d,d) tensor spline on a line has degree 2d, times a linear profile 2d + 1),
/// and as many as the exponential profile needs for 1e-15. Const functions may run in several
/// threads at once and allocate nothing.
class Reference {
  public:
    /// `fog` must pass Fog::validate(). It stands where its wind has taken it after `seconds`.
    explicit Reference(const Fog& fog, double seconds = 0);

    /// tau(O, P) = integral of K from O to P, world metres. 0 for a zero-length segment; at mu = 1
    /// symmetric and additive; NaN if a coordinate is not finite.
    ///
    /// With mu < 1 (paper 004, eq. 12) details of level l count only up to |OP| * mu^l from O, so
    /// at distance s the density is the approximation of the finest level l with s <= |OP| * mu^l.
    /// A step is the longest piece inside one cell of that level, one level range and one layer of
    /// the profile (linear: below and above `base`; exponential: below `base`, then one scale
    /// height each); its integral, over all bands together, is clamped at 0 if `clamp`.
    double optical_depth(const Eigen::Vector3d& o, const Eigen::Vector3d& p, double mu = 1,
                         bool clamp = true) const;

    /// Extinction K at a point, 1/m, from all levels (for tests by independent quadrature). Cells
    /// are half-open: a point on the far edge of the map's box is outside.
    double extinction(const Eigen::Vector3d& point) const;

    /// Where the ray from `o` along unit vector `d` leaves the map's box and the profile's support:
    /// the far end for a sky pixel. `limit` bounds it for repeated maps and unbounded profiles.
    /// Returns 0 if the ray misses.
    double far_end(const Eigen::Vector3d& o, const Eigen::Vector3d& d, double limit) const;

    const Channels& channels() const { return channels_; }

  private:
    struct Line;   // a segment in the map's causal coordinates
    struct Range;  // a part of it, by its parameter

    Range clip(const Line& line, double begin, double end) const;
    double integrate_level(const Line& line, Range range, int level, bool clamp) const;
    double integrate_step(const Line& line, Range range, int level, double cell_u,
                          double cell_v) const;
    void gather(int level, double cell_u, double cell_v, double* coefficients) const;
    double density(const double* coefficients, double u, double v) const;

    double origin_x_ = 0, origin_z_ = 0;  ///< of the map, metres
    double cell_x_ = 1, cell_z_ = 1;
    double extinction_ = 1;
    Channels channels_ = kAllChannels;
    Profile profile_;
    int degree_ = 1;
    Pyramid<double> pyramid_;
    std::vector<double> pieces_;  ///< polynomial piece p of phi_d: pieces_[p * (d + 1) + power]
};

}  // namespace wavefog
