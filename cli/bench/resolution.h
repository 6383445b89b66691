// --preset resolution: fog in fewer places than pixels, as paper 000 does (sections 4.1 to 4.3).
#pragma once

#include <string>
#include <vector>

#include "bench/measure.h"

namespace wavefog::cli {

/// Each method in every pixel, in reduced pictures of 512x512, 256x256 and 128x128 (the sizes of
/// the paper's table 1) with both upsamplings, and at vertices (but radial).
Result<std::vector<Group>> plan_resolution(const std::vector<BenchScene>& scenes, const Size& size,
                                           const std::vector<Method>& methods);

/// One table: a line a scene and sampling, times relative to the same method in every pixel.
std::string resolution_text(const std::vector<Row>& rows, bool markdown);

/// A chart a scene and method: cost relative to every pixel against error.
std::vector<Figure> resolution_figures(const std::vector<Row>& rows);

}  // namespace wavefog::cli
