// --preset models: every model of fog, each in its scene, on one chart.
#pragma once

#include <string>
#include <vector>

#include "bench/measure.h"

namespace wavefog::cli {

/// Each scene's fogs by `exact`, and by `radial` where there are maps, beside constant fog in the
/// same scene.
Result<std::vector<Group>> plan_models(const std::vector<BenchScene>& scenes, const Size& size);

std::string models_text(const std::vector<Row>& rows, bool markdown);

/// A point a scene and method: cost against error.
Figure models_figure(const std::vector<Row>& rows);

}  // namespace wavefog::cli
