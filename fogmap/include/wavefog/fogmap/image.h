// Greyscale pictures in and out, through OpenImageIO.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "wavefog/wavelet/grid.h"
#include "wavefog/wavelet/result.h"

namespace wavefog {

struct ReadOptions {
    /// A channel's name ("R", "A", "density", ...) or its number; none: luminance.
    std::optional<std::string> channel = {};
    bool sanitize = false;  ///< NaN, Inf and negative pixels become 0 and are counted
    std::size_t max_bytes = std::size_t{4} << 30;  ///< refuse larger maps (as float) before reading
};

struct Fogmap {
    Grid<float> pixels;         ///< >= 0, finite; integer images mapped to [0,1]
    std::size_t sanitized = 0;  ///< how many pixels were replaced
    std::string source_format;  ///< e.g. "png uint8, 1 channel"
};

/// Reads any image OpenImageIO reads as a fogmap. Integers are divided by their type's maximum.
/// Colour becomes Rec. 709 luminance of the stored numbers unless a channel is chosen (a fogmap is
/// data: no sRGB curve is undone); alpha is ignored; palettes are expanded; an EXR's data window is
/// the map. A data error names the file, the pixel and the remedy (NaN, Inf, negative, unreadable,
/// truncated, too large, no pixels, several images, deep).
Result<Fogmap> read_fogmap(const std::filesystem::path& file, const ReadOptions& options = {});

/// An interleaved float image, row 0 at the top.
struct Image {
    int width = 0, height = 0, channels = 0;
    std::vector<float> pixels;
    float& at(int x, int y, int c) {
        return pixels[(std::size_t(y) * std::size_t(width) + std::size_t(x)) *
                          std::size_t(channels) +
                      std::size_t(c)];
    }
    const float& at(int x, int y, int c) const { return const_cast<Image*>(this)->at(x, y, c); }
};

Result<Image> read_image(const std::filesystem::path& file);

/// Writes by extension: .exr and .tif as float, .png as 8-bit sRGB (`linear_to_srgb`, with ordered
/// dither on request; single-channel PNG is linear 16-bit). Writes to a temporary file in the same
/// directory and renames.
struct WriteOptions {
    bool linear_to_srgb = true;
    bool dither = true;
};
Result<void> write_image(const std::filesystem::path& file, const Image& image,
                         const WriteOptions& options = {});

}  // namespace wavefog
