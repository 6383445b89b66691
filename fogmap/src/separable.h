// Products of tabulated functions of x, y and z: values and means along segments, in double.
#pragma once

#include "wavefog/fogmap/models.h"

namespace wavefog::detail {

double extinction_at(const Separable& fog, const Eigen::Vector3d& x);

/// Mean over start + path t, t in [0, 1], as fog.integral says.
double mean_extinction(const Separable& fog, const Eigen::Vector3d& start,
                       const Eigen::Vector3d& path);

}  // namespace wavefog::detail
