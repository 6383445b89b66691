// --preset compression: what a promise about rays saves against one about pixels.
#pragma once

#include <string>

#include "bench/compression.h"

namespace wavefog::cli {

/// Appends rows of a map: the bits of a file that keeps |dT| <= 0.01 along all rays of 64 and of
/// 512 cells, once by a bound on every pixel and once by a search of rays. The fog is one metre a
/// cell, has optical depth 4 along the path where the map has its full scale, and thins out by
/// exp(-y / 20 m).
Result<void> measure_ray_promise(const CodecMap& map, Facts& rows);

/// A table of them, a line a map; empty without rows.
std::string ray_promise_text(const Facts& rows, bool markdown);

}  // namespace wavefog::cli
