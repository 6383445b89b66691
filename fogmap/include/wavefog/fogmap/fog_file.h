// Fog files. `.exr`: packed textures for engines, with a JSON file beside it. The extension chooses
// the format, so that further ones slot in.
#pragma once

#include <filesystem>

#include "wavefog/fogmap/fog.h"

namespace wavefog {

/// How the bands lie in EXR files (design.md section 6).
enum class Layout {
    atlas,   ///< one RGBA image: all levels, phi phi, phi psi, psi phi, psi psi in R, G, B, A
    levels,  ///< one RGBA file a level: NAME.l0.exr ...
    parts,   ///< one multi-part file, a part a level
};

struct SaveOptions {
    bool half = false;  ///< float16, residuals closed-loop and rounded up so density stays >= 0
    Layout layout = Layout::atlas;
};

Result<void> save_fog(const std::filesystem::path& file, const Fog& fog, const SaveOptions& = {});
Result<Fog> load_fog(const std::filesystem::path& file);

/// True if the extension is that of a fog file and the file is one (an ordinary .exr picture is
/// not).
bool is_fog_file(const std::filesystem::path& file);

}  // namespace wavefog
