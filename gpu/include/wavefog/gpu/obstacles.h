// What particles meet: a scene's terrain and meshes.
#pragma once

#include "wavefog/fogmap/particles.h"
#include "wavefog/fogmap/scene.h"

namespace wavefog {

/// The first contact of a segment with the ground or a triangle of a mesh, in double. Steps are
/// taken to be short against the terrain's slopes: only their ends are held against it. Empty
/// without either. A data error names the file that cannot be read.
Result<Obstacle> scene_obstacles(const std::optional<Terrain>& terrain,
                                 const std::vector<MeshInstance>& meshes);

}  // namespace wavefog
