// Rasterises what a scene's fogs hold above each place of the ground.
#pragma once

#include <array>
#include <filesystem>
#include <optional>

#include "fogs.h"
#include "options.h"
#include "report.h"

namespace wavefog::cli {

struct SceneMapOptions {
    Size size;
    bool tile = false;  ///< the first quarter fades from what lies behind the other end
    std::optional<Rect> rect;
    std::optional<double> height;               ///< density at it, or
    std::optional<std::array<double, 2>> mean;  ///< its mean between two heights
    std::optional<double> extinction;           ///< of a pixel of 1; the densest if there is none
    std::optional<int> channel;                 ///< 0 red, 1 green, 2 blue
};

/// Extinction over the ground at pixel centres, 1/m, divided by `extinction`. Of particles it is
/// the optical depth of the vertical ray between the heights of `mean`, by their height: a slab of
/// it gives vertical rays the particles' clarity back. Without `mean`, for particles alone, the
/// heights are those that hold all of them.
///
/// `facts` are told what belongs to the map: "rect", "extinction", and "profile" of a mean. Usage
/// errors name the flag that is missing.
Result<Grid<float>> scene_map(const FogsAt& fogs, const SceneMapOptions& options, Facts& facts);

}  // namespace wavefog::cli
