#include "bench/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>

namespace wavefog::cli {

void show_progress_line(double share, double seconds_so_far, const std::string& text) {
    if (isatty(STDERR_FILENO) != 1) return;
    std::string line = fmt::format("bench  {:.0f} %  {}", 100 * share, text);
    // The first percents say too little about the rest.
    if (share > 0.02)
        line += fmt::format(", about {:.0f} s left", seconds_so_far / share * (1 - share));
    fmt::print(stderr, "\r\033[K{}", line);
    std::fflush(stderr);
}

void clear_progress_line() {
    if (isatty(STDERR_FILENO) == 1) fmt::print(stderr, "\r\033[K");
}

}  // namespace wavefog::cli
