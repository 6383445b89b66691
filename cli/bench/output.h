// Files of a results folder: all through temporary names.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "bench/results.h"

namespace wavefog::cli {

/// The folder exists and can be written to, or can be made (its parent exists).
Result<void> check_output_directory(const std::filesystem::path& folder);

/// results.json, results.csv, figures.csv, and every figure as .svg and .png. Without gnuplot the
/// data files are written and a warning says how to get the pictures.
Result<void> write_results(const Results& results, const std::vector<Figure>& figures,
                           const std::filesystem::path& folder);

std::string read_text(const std::filesystem::path& file);
Result<void> write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace wavefog::cli
