// Cell polynomials of a fog's whole pyramid in one texture: what `exact` walks through.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "wavefog/fogmap/fog.h"

namespace wavefog {

/// Row-major texels. Haar: 1 channel, linear: 4 (c00, c10, c01, c11), quadratic: three RGBA texels
/// side by side a cell (fog_cell.glsl). The finest level lies at the top, the coarser ones in a row
/// below it; every level has a border of one empty cell. A cell without fog stores -(FOG_EMPTY + r)
/// in its first channel, r = how many cells around it are empty too.
struct CellAtlas {
    int width = 0, height = 0, channels = 1;
    std::vector<float> texels;
    std::vector<glm::ivec4> levels;  ///< l: first texel x, y; cells x, z
    double density_scale = 1;        ///< densities = texels * density_scale; a power of two
    double mean_density = 0;         ///< of the finest map, in texel units
    double skippable = 0;            ///< share of the finest cells whose neighbours are all empty
};

CellAtlas build_cell_atlas(const Pyramid<float>& pyramid);

}  // namespace wavefog
