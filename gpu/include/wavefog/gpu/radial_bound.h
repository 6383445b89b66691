// A certified bound on what method radial's table leaves out.
#pragma once

#include <limits>
#include <memory>

#include "wavefog/fogmap/bound.h"
#include "wavefog/fogmap/scene.h"

namespace wavefog {

/// What rays there are; the first two as DetailBound takes them.
struct RayLimits {
    double length = 0;  ///< metres, inside the fog's box or up to a surface
    double rise = 0;    ///< metres between the heights of their ends
    /// Metres of a ray a metre on the ground; RadialBound knows the picture's.
    double steepest = std::numeric_limits<double>::infinity();
};

/// How far method radial is from the finest map. It is found for every wedge between two columns
/// and every two rows:
/// - across the wedge, |f - linear| <= min(variation of f, (h^2/8) |f''| + (h/4) jumps of f') for
///   f(azimuth) = integral of rho dx: its variation is the integral of |rho_p| dA (p across the
///   ray), f'' = integral of x^2 rho_pp - x rho_x dx; coarser levels add the integral of E_l;
/// - between rows, A(L) = A_j + rho_mean (L - L_j) + a rest of at most min(osc rho, |rho'| d/2) d/4
///   (means A / L are linear but for c / L and that rest); nothing with the exact last step;
/// - |dT| <= exp(-tau) (exp(|dtau|) - 1) with the least tau that the columns allow, and float32 and
///   8-bit texture weights to first order;
/// - exponential profiles: for rays of every slope, the stretches between rows by what parabolas of
///   the density leave out (ProfileSearch);
/// - 0 < mu < 1: the sum over levels of what azimuths, left out levels and both look-ups err.
/// Haar maps are bounded by the variation alone, which is several times looser.
class RadialBound {
  public:
    /// Reads all of the map once and keeps 48, 60 or 80 bytes a cell, by the degree. `fog` must
    /// pass Fog::validate(), `dropped` is of the same fog; both must outlive this and stay as they
    /// are.
    RadialBound(const Fog& fog, const DetailBound& dropped);
    RadialBound(const Fog& fog, DetailBound&& dropped) = delete;
    RadialBound(Fog&& fog, const DetailBound& dropped) = delete;
    ~RadialBound();

    /// |T_radial - T| for every ray of the picture within `limits`; T is dimensionless, at most 1,
    /// and that of the finest map. 1 for a table of a few wide columns. For perspective cameras:
    /// others are drawn as exact draws them.
    double transmittance(const Method& method, const Camera& camera, int width, int height,
                         const RayLimits& limits, double seconds = 0) const;

    struct Impl;  ///< of the library
    const Impl& impl() const { return *impl_; }

  private:
    std::unique_ptr<const Impl> impl_;
};

}  // namespace wavefog
