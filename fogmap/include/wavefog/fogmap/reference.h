// The truth: optical depth in double, exact per finest cell.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "wavefog/fogmap/fog.h"

namespace wavefog {

/// Integrates extinction along segments. Clips to the map and the height profile, splits at every
/// knot of the grid in use and at the profile's corners, Gauss-Legendre per piece: d + 1 nodes (exact:
/// a degree-(d,d) tensor spline on a line has degree 2d, times a linear profile 2d + 1), and as many
/// as the exponential profile needs for 1e-15.
class Reference {
  public:
    explicit Reference(const Fog& fog);

    /// tau(O, P) = integral of K from O to P, world metres. 0 for a zero-length segment, symmetric
    /// and additive. With mu < 1 (paper 004, eq. 12) level l counts only up to |OP| * mu^l from O, and
    /// each step's integral (over all bands together) is clamped at 0 if `clamp`.
    double optical_depth(const Eigen::Vector3d& o, const Eigen::Vector3d& p, double mu = 1,
                         bool clamp = true) const;

    /// Extinction K at a point, 1/m, from all levels (for tests by independent quadrature).
    double extinction(const Eigen::Vector3d& point) const;

    /// Where the ray from `o` along unit vector `d` leaves the map's box and the profile's support:
    /// the far end for a sky pixel. `limit` bounds it for repeated maps and unbounded profiles.
    /// Returns 0 if the ray misses.
    double far_end(const Eigen::Vector3d& o, const Eigen::Vector3d& d, double limit) const;

  private:
    Fog fog_;
    Pyramid<double> pyramid_;
};

}  // namespace wavefog
