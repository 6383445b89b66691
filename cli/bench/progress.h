// One line on a terminal's last row, for work whose end can be estimated.
#pragma once

#include <string>

namespace wavefog::cli {

/// Shows "bench  42 %  TEXT, about 30 s left" if stderr is a terminal; `share` done in [0,1].
void show_progress_line(double share, double seconds_so_far, const std::string& text);

/// Removes it.
void clear_progress_line();

}  // namespace wavefog::cli
