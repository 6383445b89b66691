// How far a map's errors can add up along a ray.
#pragma once

#include "wavefog/fogmap/fog.h"

namespace wavefog::wfog {

/// An upper estimate of |dtau|, and so of |dT| <= |dtau|, over all rays of up to `path` metres
/// through `fog` when its map is off by `error` (both finest coefficients).
///
/// Horizontal rays are searched: lines in `angles` directions, a cell apart, and on each line all
/// segments of up to so many metres. A factor of 1.25 stands for the rays between the lines. From
/// them the rest follows: h falls or rises along a ray, so its weighted integral is at most that
/// over one segment (second mean value theorem), and a ray that climbs at an angle is a horizontal
/// one, stretched by 1 / cos. Where the profile ends the fog upwards (all but `uniform`) every ray
/// above its base counts; `uniform` fog has no upper end, and rays up to 45 degrees count.
double worst_ray_error(const Fog& fog, const Grid<float>& error, double path, int angles);

}  // namespace wavefog::wfog
