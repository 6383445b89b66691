// How far a map's errors can add up along a ray.
#pragma once

#include "wavefog/fogmap/wfog.h"

namespace wavefog::wfog {

/// An upper estimate of |dT| over all rays of up to path metres, of every slope, that stay above
/// the height ground, through `fog` when its finest coefficients are `map` +
/// `error` instead of `map`.
///
/// Where fog is as dense without end, in `uniform` fog and far below the base of `exponential` and
/// `linear`, a bound: that of PixelErrors, as rays straight up stay over one pixel.
///
/// Else horizontal rays are searched: lines in `angles` directions, rows, columns and diagonals
/// among them, which have a line a cell; of others large maps get fewer (1e7 samples in all). On
/// each line, all segments of up to so many metres, each with its optical depth tau and its error
/// dtau: |dT| <= exp(-tau) (exp(|dtau|) - 1). A factor of 1.1 on dtau stands for the rays between
/// the lines; errors that are alike along one of them alone can be more. From them the rest
/// follows: h falls or rises along a ray, so its weighted integrals are means of those over
/// segments from one end (second mean value theorem), for tau, dtau and length alike, and the
/// length's mean is the integral of h; and a ray that climbs at an angle is a horizontal one,
/// stretched by 1 / cos. Of steep rays PixelErrors says more.
///
/// path and ground, threads and stop are those of `options`; less than the estimate if stopped.
double worst_ray_error(const Fog& fog, const Grid<float>& map, const Grid<float>& error,
                       const WfogOptions& options, int angles);

}  // namespace wavefog::wfog
