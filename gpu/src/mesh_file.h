// Triangles from glTF and OBJ files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "wavefog/wavelet/result.h"

namespace wavefog {

struct MeshVertex {
    float position[3];  ///< the file's units, node transforms applied
    float normal[3];
    float colour[3];  ///< linear: the material's base colour times the vertex colour
    float glow[3];    ///< linear: light that the material gives out
};

struct MeshData {
    std::vector<MeshVertex> vertices;
    std::vector<std::uint32_t> indices;
};

/// Missing normals are generated; points and lines are dropped; textures are not read.
Result<MeshData> load_mesh(const std::filesystem::path& file);

}  // namespace wavefog
