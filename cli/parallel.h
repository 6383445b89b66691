// Long work over many items: all cores and a progress line.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace wavefog::cli {

/// Calls body(begin, end) over [0, count) in chunks on all cores. When stderr is a terminal, a line
/// "label  42 %" is kept up to date there.
void parallel_chunks(const std::string& label, std::size_t count, std::size_t chunk,
                     const std::function<void(std::size_t, std::size_t)>& body);

}  // namespace wavefog::cli
