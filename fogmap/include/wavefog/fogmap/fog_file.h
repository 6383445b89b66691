// Fog files. `.exr`: packed textures for engines, with a JSON file beside it; `.wfog`: the compact
// file. The extension chooses the format, so that further ones slot in.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

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
    /// Samples an edge of the path-integral tables (paper 004, 4.3) that join Layout::parts as
    /// float parts "whole_paths" and "partial_paths"; 0: none. The description's "path_table" says
    /// how they lie (path_table.h).
    int path_table = 0;
    PathLayout path_layout = PathLayout::mean;
};

/// Writes NAME.exr (for Layout::levels one NAME.lN.exr a level, N as in PackedLevel::level) and the
/// same description as JSON, NAME.json. Temporary names first, so that a failure leaves nothing.
/// Texels are coefficients divided by "scale", a power of two that brings them into [-1, 1]; as
/// float they come back bit for bit. A NAME.wfog is the smallest file without loss; other promises:
/// encode_wfog() and save_wfog().
Result<void> save_fog(const std::filesystem::path& file, const Fog& fog, const SaveOptions& = {});

/// Writes the bytes of encode_wfog(), whole or not at all.
Result<void> save_wfog(const std::filesystem::path& file, std::span<const std::uint8_t> bytes);

/// What a file holds beside the fog.
struct LoadNotes {
    std::string warning = {};  ///< the file ends early: which levels there are; else empty
    // Of a .wfog alone, else empty or 0.
    Grid<float> map = {};    ///< the finest coefficients as they were encoded
    int stream_levels = 0;   ///< those that are there, coarse first
    int of_levels = 0;       ///< and how many the whole file has
    double max_error = 0;    ///< of the whole file's pixels, as its encoder measured it, in densities
};

/// Reads the .exr or the .json of save_fog, or a .wfog; of Layout::levels any of its files or the
/// name given when it was saved. Damaged files and descriptions that do not fit their images are
/// data errors. A .wfog that ends early is one too, unless `notes` can tell of it.
Result<Fog> load_fog(const std::filesystem::path& file, LoadNotes* notes = nullptr);

/// True if the extension is that of a fog file and the file is one (an ordinary .exr picture is
/// not). A .wfog file counts by its extension.
bool is_fog_file(const std::filesystem::path& file);

}  // namespace wavefog
