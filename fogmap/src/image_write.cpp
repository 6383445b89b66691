#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <new>

#include "container_check.h"
#include "file_io.h"
#include "wavefog/fogmap/image.h"

namespace wavefog {

namespace fs = std::filesystem;

namespace {

using OIIO::TypeDesc;

/// Bayer's 8 x 8 matrix by its bit-reversal rule: thresholds (k + 1/2) / 64 in (0, 1).
double bayer_threshold(int x, int y) {
    int k = 0;
    for (int bit = 0; bit < 3; ++bit) {
        const int xb = (x >> bit) & 1, yb = (y >> bit) & 1;
        k = (k << 2) | ((xb ^ yb) << 1) | yb;
    }
    return (k + 0.5) / 64;
}

double linear_to_srgb(double value) {
    return value <= 0.0031308 ? 12.92 * value : 1.055 * std::pow(value, 1 / 2.4) - 0.055;
}

// NaN has no colour: black.
double clamped(float value) {
    return value > 0 ? std::min(1.0, static_cast<double>(value)) : 0.0;
}

std::vector<std::uint8_t> png_bytes(const Image& image, const WriteOptions& options) {
    std::vector<std::uint8_t> bytes(image.pixels.size());
    std::size_t k = 0;
    for (int y = 0; y < image.height; ++y)
        for (int x = 0; x < image.width; ++x) {
            const double threshold = options.dither ? bayer_threshold(x, y) : 0.5;
            for (int c = 0; c < image.channels; ++c, ++k) {
                double value = clamped(image.pixels[k]);
                const bool alpha = c == 3 || (image.channels == 2 && c == 1);
                if (options.linear_to_srgb && !alpha) value = linear_to_srgb(value);
                // Alpha is a mask, not a gradient to look at: rounded, not dithered.
                bytes[k] = static_cast<std::uint8_t>(
                    std::min(255.0, std::floor(255 * value + (alpha ? 0.5 : threshold))));
            }
        }
    return bytes;
}

std::vector<std::uint16_t> png_words(const Image& image) {
    std::vector<std::uint16_t> words(image.pixels.size());
    std::transform(image.pixels.begin(), image.pixels.end(), words.begin(), [](float value) {
        return static_cast<std::uint16_t>(std::floor(65535 * clamped(value) + 0.5));
    });
    return words;
}

Result<void> write_with(const char* format, const fs::path& file, const fs::path& temporary,
                        OIIO::ImageSpec spec, TypeDesc type, const void* pixels) {
    const auto failed = [&](const std::string& why) {
        return data_error(fmt::format("{}: cannot be written ({}); check space and permissions",
                                      file.string(), why));
    };
    const auto output = OIIO::ImageOutput::create(format);
    if (!output) return failed(OIIO::geterror());
    if (!output->open(temporary.string(), spec)) return failed(output->geterror());
    if (!output->write_image(type, pixels)) return failed(output->geterror());
    if (!output->close()) return failed(output->geterror());
    // OpenImageIO's PNG writer does not notice a full disk.
    if (!detail::check_container(temporary, std::numeric_limits<std::size_t>::max()))
        return failed("the file came out incomplete");
    return {};
}

Result<void> write(const fs::path& file, const Image& image, const WriteOptions& options) {
    if (image.width < 1 || image.height < 1 || image.channels < 1 ||
        image.pixels.size() !=
            std::size_t(image.width) * std::size_t(image.height) * std::size_t(image.channels))
        return data_error(fmt::format(
            "{}: the picture has {} values for {} x {} pixels of {} channels; "
            "nothing was written",
            file.string(), image.pixels.size(), image.width, image.height, image.channels));
    const std::string extension = detail::lower_extension(file);
    const bool png = extension == ".png", exr = extension == ".exr";
    if (!png && !exr && extension != ".tif" && extension != ".tiff")
        return usage_error(fmt::format("{}: pictures are written as .png, .exr or .tif; choose one",
                                       file.string()));
    if (png && image.channels > 4)
        return usage_error(fmt::format("{}: a PNG has at most 4 channels, not {}; write .exr",
                                       file.string(), image.channels));
    if (const auto ok = detail::check_writable_place(file); !ok) return ok;

    detail::PendingFile pending(file);
    OIIO::ImageSpec spec(image.width, image.height, image.channels, TypeDesc::FLOAT);
    Result<void> ok;
    if (!png) {
        spec.attribute("compression", "zip");
        // Else the clock's: equal pictures are to be equal files.
        spec.attribute("DateTime", "1970:01:01 00:00:00");
        if (exr && image.channels == 1)
            spec.channelnames = {"Y"};  // what readers expect of one channel
        ok = write_with(exr ? "openexr" : "tiff", file, pending.path(), spec, TypeDesc::FLOAT,
                        image.pixels.data());
    } else if (image.channels == 1) {
        spec.set_format(TypeDesc::UINT16);
        spec.attribute("oiio:ColorSpace", "Linear");
        ok = write_with("png", file, pending.path(), spec, TypeDesc::UINT16,
                        png_words(image).data());
    } else {
        spec.set_format(TypeDesc::UINT8);
        spec.attribute("oiio:UnassociatedAlpha", 1);  // stored as given
        if (options.linear_to_srgb) spec.attribute("oiio:ColorSpace", "sRGB");
        ok = write_with("png", file, pending.path(), spec, TypeDesc::UINT8,
                        png_bytes(image, options).data());
    }
    return ok ? pending.commit() : ok;
}

}  // namespace

Result<void> write_image(const fs::path& file, const Image& image, const WriteOptions& options) {
    try {
        return write(file, image, options);
    } catch (const std::bad_alloc&) {
        return data_error(fmt::format("{}: not enough memory to write the picture", file.string()));
    } catch (const std::exception& error) {
        return data_error(fmt::format("{}: cannot be written ({}); check space and permissions",
                                      file.string(), error.what()));
    }
}

}  // namespace wavefog
