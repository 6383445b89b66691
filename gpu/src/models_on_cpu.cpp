// The shader's formulas for fog compiled as C++, for one ray at a time.
#include "model_block.h"
#include "wavefog/gpu/fog_pass.h"

// What the ray's helpers offer the maps is not all used here.
#pragma GCC diagnostic ignored "-Wunused-function"

namespace wavefog {
namespace shader {
namespace {
#define FOG_PROFILE 0
#include "fog_ray.glsl"

#include "fog_models.glsl"
}  // namespace
}  // namespace shader

ModelsOnCpu::ModelsOnCpu(std::vector<FogModel> models)
    : models_(std::move(models)),
      tables_(std::make_shared<const ModelTables>(model_tables(models_))) {}

Result<ModelsOnCpu> ModelsOnCpu::create(std::vector<FogModel> models) {
    if (auto ok = check_models(models); !ok) return tl::unexpected(ok.error());
    return ModelsOnCpu(std::move(models));
}

double ModelsOnCpu::optical_depth(const Eigen::Vector3d& o, const Eigen::Vector3d& p) const {
    shader::models = model_block(models_, common_channels(models_), o, 0);
    shader::model_tables = {tables_->rgba.data(), tables_->width, tables_->height, 4};
    const Eigen::Vector3d path = p - o;
    const Eigen::Vector3f single = path.cast<float>();
    return shader::fog_models(glm::vec3(0.0f), {single.x(), single.y(), single.z()},
                              static_cast<float>(path.norm()), glm::vec3(0.0f), 0.0f);
}

}  // namespace wavefog
