// Tables 1 to 3 of paper 004: their figures, what to measure for ours, and both side by side.
#pragma once

#include <string>
#include <vector>

#include "bench/measure.h"

namespace wavefog::cli {

/// 16x16, 32x32 and 64x64 averages of the scene's first map, uniform in height as in the paper.
Result<std::vector<Group>> plan_paper_tables(const BenchScene& scene, const Size& size);

/// The three tables as text for a terminal, or as Markdown.
std::string paper_tables_text(const std::vector<Row>& rows, bool markdown);

}  // namespace wavefog::cli
