// Tables of a README from committed result files.
#pragma once

#include <filesystem>
#include <string>

#include "bench/results.h"

namespace wavefog::cli {

/// What a preset has to say about its results, as text for a terminal or as Markdown.
std::string report_text(const Results& results, bool markdown);

/// Commit, machine, renderer, date and command in one or two lines.
std::string provenance_text(const Results& results, bool markdown);

/// Replaces what stands between `<!-- bench FILE -->` and `<!-- /bench -->`, for every such pair;
/// FILE is relative to `folder`. A data error names a marker without its end or a file without
/// results.
Result<std::string> fill_readme(const std::string& text, const std::filesystem::path& folder);

}  // namespace wavefog::cli
