// The triangles of a terrain and the light that reaches them, computed once on the CPU.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "wavefog/gpu/terrain.h"

namespace wavefog {

struct TerrainVertex {
    float position[3];  ///< metres from TerrainMesh::origin
    float normal[3];
    float sun;      ///< part of the sun's disc above the horizon of the terrain, [0,1]
    float ambient;  ///< part of the sky's light that reaches the point, [0,1]
};

struct TerrainMesh {
    Eigen::Vector3d origin;  ///< world metres
    std::vector<TerrainVertex> vertices;
    std::vector<std::uint32_t> indices;
    int columns = 0, rows = 0;

    /// Sun visibility at a world position, bilinear between vertices.
    float sun_at(double x, double z) const;
    Rect rect;
};

/// One vertex a pixel or finer, no more than about 1024 along the longer side. `to_sun` is a unit
/// vector.
TerrainMesh build_terrain_mesh(const HeightField& field, const Eigen::Vector3d& to_sun);

}  // namespace wavefog
