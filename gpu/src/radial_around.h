// RadialBound for any view, as the CPU's tables have every azimuth.
#pragma once

#include "cell_ranges.h"
#include "radial_block.h"
#include "wavefog/gpu/radial_bound.h"

namespace wavefog {

struct RadialBound::Impl {
    Impl(const Fog& fog, const DetailBound& dropped, const Pyramid<float>& pyramid);
    double around(const Method& method, const Eigen::Vector3d& eye, const RadialView& view,
                  double seconds, double limit, const RayLimits& limits) const;

    const Fog& fog;
    const DetailBound& dropped;
    FogFacts facts;
    CellRanges ranges;
};

}  // namespace wavefog
