// Figures as SVG and PNG through gnuplot, in one style.
#pragma once

#include <filesystem>

#include "bench/figure.h"
#include "wavefog/wavelet/result.h"

namespace wavefog::cli {

/// True if gnuplot is on the PATH.
bool has_gnuplot();

/// Writes FOLDER/ID.svg and FOLDER/ID.png (1200x800).
Result<void> draw_figure(const Figure& figure, const std::filesystem::path& folder);

/// The program that gnuplot runs for a terminal ("svg" or "pngcairo") and an output file.
std::string gnuplot_program(const Figure& figure, const std::string& terminal,
                            const std::string& output);

}  // namespace wavefog::cli
