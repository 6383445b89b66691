// What a map's errors can do to a ray at most, wherever it runs.
#pragma once

#include <vector>

#include "wavefog/wavelet/grid.h"

namespace wavefog::wfog {

/// A map's pixels as points (density, error): the less of both maps' densities, and how far they
/// are apart. Along a ray through the spline surfaces of both, times any profile, density and
/// error are means of the pixels' with common weights, none below 0: a point of their convex hull.
/// With M and W, its coordinates times extinction and the length along which h adds up, |dT| =
/// exp(-min(tau, tau')) (1 - exp(-|tau - tau'|)) <= exp(-M) (1 - exp(-W)).
class PixelErrors {
  public:
    /// Of `map` and `map` + `error`.
    PixelErrors(const Grid<float>& map, const Grid<float>& error);

    /// No ray along which h adds up to at most `reach` / extinction metres changes by more. Some
    /// ray does by as much, if it can stay over one pixel and that pixel is a corner of the hull.
    double worst_change(double reach) const;

  private:
    struct Point {
        double density, error;
    };
    static double change(const Point& point, double reach);
    static double change_between(Point a, Point b, double reach);

    /// The hull's corners where error rises with density: what lies behind forgives more.
    std::vector<Point> corners_;
};

}  // namespace wavefog::wfog
