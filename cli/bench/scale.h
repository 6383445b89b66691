// How cost and error grow with the map: maps of 64x64 to 4096x4096 from several cameras.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/measure.h"

namespace wavefog::cli {

/// Puts a picture in place of the pixels of the scene's first fog, decomposed as they were.
Result<void> put_map(BenchScene& scene, const std::filesystem::path& picture);

/// Each scene five times: from its camera, from above, straight down, pitched and rolled.
std::vector<BenchScene> scale_scenes(const std::vector<BenchScene>& scenes);

/// The first fog of each of those scenes at every map size, at `size` (mu below 1 there alone) and
/// 1920x1080, and from the scene's own camera at `size` with its map as Haar coefficients too.
Result<std::vector<Group>> plan_scale(const std::vector<BenchScene>& scenes, const Size& size,
                                      const std::vector<Method>& methods,
                                      const std::vector<double>& mus);

/// A row a picture size, map size and method: medians over scenes and cameras of the cost relative
/// to `homogeneous`, and the worst error of all.
std::string scale_table_text(const std::vector<Row>& rows, bool markdown);

/// Shorter: a row a picture size, scene and map size; of each method the median (and worst) cost
/// relative to `homogeneous` over the cameras, and the worst error.
std::string scale_summary_text(const std::vector<Row>& rows, bool markdown);

}  // namespace wavefog::cli
