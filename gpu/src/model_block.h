// Fills the shader's uniform block from fogs given by formulas and an eye, in double.
#pragma once

#include <vector>

#include "glsl_in_cpp.h"
#include "wavefog/fogmap/models.h"

namespace wavefog {

/// A data error if a model is invalid or there are more parts than the block holds.
Result<void> check_models(const std::vector<FogModel>& models);

/// Coordinates count from `eye` (world metres), so that float32 keeps its precision at any offset.
/// `sky_limit`: longest sky ray, metres.
shader::ModelBlock model_block(const std::vector<FogModel>& models, const Eigen::Vector3d& eye,
                               double sky_limit);

}  // namespace wavefog
