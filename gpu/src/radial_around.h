// radial_bound() for any view, as the CPU's tables have every azimuth.
#pragma once

#include "radial_block.h"
#include "wavefog/gpu/radial_bound.h"

namespace wavefog {

double radial_bound_around(const Fog& fog, const DetailBound& dropped, const Method& method,
                           const Eigen::Vector3d& eye, const RadialView& view, double seconds,
                           double limit, const RayLimits& limits);

}  // namespace wavefog
