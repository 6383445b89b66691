// How far a map's errors can add up along a ray.
#pragma once

#include "wavefog/fogmap/wfog.h"

namespace wavefog::wfog {

/// A bound on |dT| over all rays of up to path metres, of every slope, that stay above the height
/// ground, through `fog` when its finest coefficients are `map` + `error` instead of `map`. It is
/// looked for as long as it is above options.error; then what is known is returned.
///
/// PixelErrors knows one, for rays that stay over one pixel. Where fog is as dense without end, in
/// `uniform` fog and far below the base of `exponential` and `linear`, some ray straight up does.
///
/// Else errors even out along rays: for any price of a metre and of a unit of density, the integral
/// of +-error - price - price_of_density * map is bounded on all segments of lines through the map
/// (most_along_lines, which tells `parts` of a cell apart). As h falls or rises along a ray, what
/// it weights is a mean of segments from one end (second mean value theorem). Added up, the ray's
/// error is at most that bound, the price of the length that h adds up to, and that of its optical
/// depth tau; and |dT| <= exp(-tau) (exp(|dtau|) - 1), of all tau the largest. A ray that climbs at
/// an angle is a level one, stretched by 1 / cos. Prices are chosen for the rays that are worst.
///
/// path, ground and error, threads and stop are those of `options`; infinity if stopped.
double worst_ray_error(const Fog& fog, const Grid<float>& map, const Grid<float>& error,
                       const WfogOptions& options, int parts);

}  // namespace wavefog::wfog
