// What FogTextures holds; shared by fog_textures.cpp and fog_pass.cpp.
#pragma once

#include "fog_uniforms.h"
#include "wavefog/gpu/fog_pass.h"

namespace wavefog {

struct FogTextures::Impl {
    FogFacts facts;
    Texture cells;  ///< R32F or RGBA32F atlas (cell_atlas.h)
    Texture map;    ///< R32F, bilinear (nearest for Haar), zero border or repeat: for march:N
    Decomposition<float> decomposition;  ///< for the paper's textures, which depend on the method
    std::size_t bytes = 0;
};

}  // namespace wavefog
