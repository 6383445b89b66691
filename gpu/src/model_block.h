// Fills the shader's uniform block from fogs given by formulas and an eye, in double.
#pragma once

#include <functional>
#include <vector>

#include "fog_uniforms.h"
#include "wavefog/fogmap/models.h"

namespace wavefog {

/// A data error if a model is invalid or there are more parts than the block holds.
Result<void> check_models(const std::vector<FogModel>& models);

/// The kinds of models that are there, of MODEL_KIND_* in fog_models_block.glsl.
int model_kinds(const std::vector<FogModel>& models);

/// The `models` are all seen by the colours as `channels` say. Coordinates count from `eye` (world
/// metres), so that float32 keeps its precision at any offset. `sky_limit`: longest sky ray,
/// metres. `split`: of a linear function of the direction, given by a vector, for the pixels of a
/// perspective picture.
shader::ModelBlock model_block(const std::vector<FogModel>& models, const Channels& channels,
                               const Eigen::Vector3d& eye, double sky_limit,
                               const std::function<SplitSum(const Eigen::Vector3d&)>& split = {});

/// The texture model_tables (RGBA32F) of the block's separable fogs: a row for each table.
struct ModelTables {
    int width = 1, height = 1;
    std::vector<float> rgba;
};
ModelTables model_tables(const std::vector<FogModel>& models);

}  // namespace wavefog
