// Packed textures (paper 004, section 4.3): all bands of a decomposition in RGBA images.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "wavefog/wavelet/decomposition.h"

namespace wavefog {

/// Where one band lies inside its level's rectangle; width 0 means that the channel holds no band.
struct PackedBand {
    int start_x = 0;  ///< index of the band's first coefficient
    int start_z = 0;
    int width = 0;
    int height = 0;

    bool operator==(const PackedBand&) const = default;
};

/// One rectangle of texels. Texel (x + i, y + j) holds the coefficients of index
/// (origin_x + i, origin_z + j) of all its bands: they are aligned by index and zero-filled to
/// their common rectangle.
///
/// Form::wavelet: R, G, B, A = phi phi, phi psi, psi phi, psi psi. The approximation lives on the
/// same cells as the coarsest details, so it is R of level 1 (of level 0 if there are no details);
/// R is empty on finer levels.
/// Form::scaling: R = the approximation (level 0) or the residual (level l >= 1); G, B, A are
/// empty.
struct PackedLevel {
    int level = 0;
    int x = 0, y = 0, width = 0, height = 0;  ///< texels, in the image
    int origin_x = 0, origin_z = 0;
    std::array<PackedBand, 4> channels;

    bool operator==(const PackedLevel&) const = default;
};

/// One RGBA image and all it takes to read it back.
struct PackedAtlas {
    Family family;
    Form form = Form::wavelet;
    Boundary boundary = Boundary::zero;
    int map_width = 0;   ///< of the finest map, pixels
    int map_height = 0;  ///< of the finest map, pixels
    int detail_levels = 0;

    int width = 0;            ///< texels
    int height = 0;           ///< texels
    std::vector<float> rgba;  ///< row-major, 4 width height values
    std::vector<PackedLevel> levels;
};

/// All levels in one image: the finest at the corner, the others in a row beside or below it, one
/// zero texel between any two.
PackedAtlas pack(const Decomposition<float>& decomposition);

/// One image a level, each with a single PackedLevel, in the order of PackedAtlas::levels.
std::vector<PackedAtlas> pack_levels(const Decomposition<float>& decomposition);

/// The decomposition back, bit for bit. Safe on untrusted metadata: a data error names the level
/// that does not fit its image, is missing or is there twice.
Result<Decomposition<float>> unpack(const PackedAtlas& atlas);
Result<Decomposition<float>> unpack(std::span<const PackedAtlas> images);

}  // namespace wavefog
