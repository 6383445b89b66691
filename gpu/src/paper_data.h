// What the methods paper and paper-scaling read: packed coefficients, path-integral tables,
// uniforms.
#pragma once

#include "glsl_in_cpp.h"
#include "wavefog/fogmap/fog.h"
#include "wavefog/fogmap/scene.h"
#include "wavefog/wavelet/pack.h"
#include "wavefog/wavelet/path_table.h"

namespace wavefog {

struct PaperData {
    PackedAtlas bands;  ///< texels in units of the cell atlas (1 / density_scale)
    PathTable table;
    shader::PaperBlock block;
    std::size_t bytes() const { return bands.rgba.size() * sizeof(float) + table.bytes(); }
};

/// `method` is paper or paper_scaling. A usage error if the fog has no wavelet form to walk
/// through.
Result<PaperData> make_paper_data(const Decomposition<float>& decomposition, const Method& method,
                                  double density_scale);

}  // namespace wavefog
