// RGBA EXR files in the flavour that engines load (single-part scanline, ZIP), and multi-part ones.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "wavefog/wavelet/result.h"

namespace wavefog::detail {

struct ExrImage {
    std::string name;  ///< of its part; unique in a multi-part file
    int width = 0, height = 0;
    std::vector<float> rgba;
};

/// `attributes` is an object; its key K becomes the header attribute "wavefog.K" of every part:
/// texts, integers and numbers as such, lists and objects as JSON text. Several images make a
/// multi-part file. With `half` every value must be a half float already.
Result<void> write_exr(const std::filesystem::path& file, std::span<const ExrImage> images,
                       bool half, const nlohmann::json& attributes);

struct ExrFile {
    std::vector<ExrImage> images;
    nlohmann::json attributes;  ///< of the first part; an empty object in other people's files
};

/// Safe on damaged files. Without `pixels` only names, sizes and attributes are read.
Result<ExrFile> read_exr(const std::filesystem::path& file, bool pixels);

}  // namespace wavefog::detail
