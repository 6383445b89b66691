// How far a map's errors can add up along a ray.
#pragma once

#include "wavefog/fogmap/fog.h"

namespace wavefog::wfog {

/// An upper estimate of |dT| over all rays of up to `path` metres through `fog` when its finest
/// coefficients are `map` + `error` instead of `map`.
///
/// Of `uniform` fog, a bound: that of PixelErrors, as rays straight up stay over one pixel.
///
/// Else horizontal rays are searched: lines in `angles` directions, a cell apart, and on each line
/// all segments of up to so many metres, each with its optical depth tau and its error dtau:
/// |dT| <= exp(-tau) (exp(|dtau|) - 1). A factor of 1.1 on dtau stands for the rays between the
/// lines. From them the rest follows: h falls or rises along a ray, so its weighted integrals are
/// means of those over segments from one end (second mean value theorem), for tau and dtau alike;
/// and a ray that climbs at an angle is a horizontal one, stretched by 1 / cos. Of steep rays the
/// bound of PixelErrors says more. Rays of every slope count that stay above the base of
/// `exponential` and `linear` fog, below which h is 1 for ever; of a slab, all.
double worst_ray_error(const Fog& fog, const Grid<float>& map, const Grid<float>& error,
                       double path, int angles);

}  // namespace wavefog::wfog
