// Fog files. `.exr`: packed textures for engines, with a JSON file beside it. The extension chooses
// the format, so that further ones slot in.
#pragma once

#include <filesystem>

#include "wavefog/fogmap/fog.h"
#include "wavefog/wavelet/path_table.h"

namespace wavefog {

/// How the bands lie in EXR files (design.md section 6).
enum class Layout {
    atlas,   ///< one RGBA image: all levels, phi phi, phi psi, psi phi, psi psi in R, G, B, A
    levels,  ///< one RGBA file a level: NAME.l0.exr ...
    parts,   ///< one multi-part file, a part a level
};

struct SaveOptions {
    bool half = false;  ///< float16; Form::scaling: closed-loop, rounded up, density stays >= 0
    Layout layout = Layout::atlas;
    /// Samples an edge of the path-integral tables (paper 004, 4.3) that join Layout::parts as float
    /// parts "whole_paths" and "partial_paths"; 0: none. The description's "path_table" says how they
    /// lie (path_table.h).
    int path_table = 0;
    PathLayout path_layout = PathLayout::mean;
};

/// Writes NAME.exr (for Layout::levels one NAME.lN.exr a level, N as in PackedLevel::level) and the
/// same description as JSON, NAME.json. Temporary names first, so that a failure leaves nothing.
/// Texels are coefficients divided by "scale", a power of two that brings them into [-1, 1]; as float
/// they come back bit for bit.
Result<void> save_fog(const std::filesystem::path& file, const Fog& fog, const SaveOptions& = {});

/// Reads the .exr or the .json of save_fog; of Layout::levels any of its files or the name given when
/// it was saved. Damaged files and descriptions that do not fit their images are data errors.
Result<Fog> load_fog(const std::filesystem::path& file);

/// True if the extension is that of a fog file and the file is one (an ordinary .exr picture is not).
/// A .wfog file counts by its extension; load_fog tells that this version cannot read it.
bool is_fog_file(const std::filesystem::path& file);

}  // namespace wavefog
