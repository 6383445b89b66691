// Checks of image files before a decoder sees them.
#pragma once

#include <cstddef>
#include <filesystem>

#include "wavefog/wavelet/result.h"

namespace wavefog::detail {

/// Refuses PNG, JPEG and EXR files that end early or whose headers claim more than the file can
/// hold or than `max_bytes`; decoders fill the gap with grey, or allocate what the header says,
/// instead. Other formats pass.
Result<void> check_container(const std::filesystem::path& file, std::size_t max_bytes);

}  // namespace wavefog::detail
