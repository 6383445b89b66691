// The bands of a decomposition as a list, level by level.
#pragma once

#include <vector>

#include "wavefog/wavelet/decomposition.h"

namespace wavefog::wfog {

/// Level 0: the approximation; level l: phi psi, psi phi, psi psi and the residual of level l, some
/// of them empty.
std::vector<std::vector<Band<float>*>> bands_of(Decomposition<float>& decomposition);
std::vector<std::vector<const Band<float>*>> bands_of(const Decomposition<float>& decomposition);

/// Same bands, bit for bit.
bool same_coefficients(const Decomposition<float>& a, const Decomposition<float>& b);

/// Levels of a band's streams, which all lie in one chunk.
int band_levels(const Band<float>& band, int tile_bits);

}  // namespace wavefog::wfog
