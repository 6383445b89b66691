// The compact fog file `.wfog` in memory (the bytes: fogmap/FORMAT.md). Files by name go through
// fog_file.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <limits>
#include <span>
#include <stop_token>
#include <vector>

#include "wavefog/fogmap/fog.h"

namespace wavefog {

/// Sides of a map in a .wfog file reach up to this, pixels.
inline constexpr int kMaxWfogSide = 1 << 16;

struct WfogOptions {
    enum class Promise {
        lossless,   ///< every coefficient comes back bit for bit
        max_error,  ///< every pixel within `error` times the full scale, plus a float's rounding
        /// |dT| <= `error` along every ray of up to `path` metres above `ground`, whatever its
        /// place and direction: proved, up to the rounding of floats
        max_transmittance_error,
        bytes,  ///< the smallest error that fits into `bytes`
    };
    Promise promise = Promise::lossless;
    double error = 0;  ///< above 0
    double path = 0;   ///< metres, above 0
    /// The lowest height that rays of `max_transmittance_error` reach, metres. Where that is not
    /// far below the fog's base, errors of pixels even out along rays, and files are smaller
    double ground = -std::numeric_limits<double>::infinity();
    std::size_t bytes = 0;
    bool best = false;  ///< the smallest file instead of a quick one
    int threads = 0;    ///< 0: as many as the machine has; the bytes are the same for any number
    std::stop_token stop = {};  ///< cancels: a data error "... cancelled"
};

/// What a file achieves, measured on its decoded bytes.
struct WfogReport {
    std::size_t bytes = 0;
    double bits_per_pixel = 0;
    double ratio = 0;       ///< bytes of the pixels as floats / bytes of the file
    double full_scale = 0;  ///< what errors are fractions of: 1 for 8-bit maps, else the range up
                            ///< to the 99.9th percentile (16-bit: the whole range)
    double max_error = 0;   ///< in densities
    double rms_error = 0;   ///< in densities
    double ray_error = 0;   ///< of a promise about rays: what |dT| is proved not to exceed
};

struct EncodedFog {
    std::vector<std::uint8_t> bytes;
    WfogReport report;
};

/// Encodes a fog, decodes the bytes again, and checks every pixel against the promise before it
/// returns. `map`: the pixels that the fog was made from, where they are at hand; a reconstruction
/// has lost their last bits. Where the input is not negative the output is not.
///
/// Data errors: the fog does not pass validate(), a side above kMaxWfogSide, no file of so few
/// bytes exists, not enough memory, cancelled. Usage errors: an error, path or size that is not
/// above 0, a ground that is NaN.
Result<EncodedFog> encode_wfog(const Fog& fog, const WfogOptions& options,
                               const Grid<float>* map = nullptr);

/// Limits for bytes that nobody vouches for.
struct WfogLimits {
    std::size_t max_map_bytes = std::size_t{4} << 30;  ///< refuse larger maps (as floats) at once
    bool partial = false;  ///< accept a file that ends early, with the levels that are whole
    int levels = 1 << 16;  ///< decode no more stream levels than this, at least 1
    int threads = 0;
    std::stop_token stop = {};
};

struct DecodedFog {
    Fog fog;
    Grid<float> map;       ///< the finest coefficients, as they were encoded
    int levels = 0;        ///< stream levels that were decoded, coarse first
    int of_levels = 0;     ///< and how many a whole file has
    double max_error = 0;  ///< what the encoder measured, in densities (for all levels)
};

/// Safe for any bytes: what is not a .wfog file, or damaged, truncated or above the limits, is a
/// data error that does not name the file. Levels that are missing are interpolated from those
/// that are there. The values are the same on every machine and for any number of threads.
Result<DecodedFog> decode_wfog(std::span<const std::uint8_t> bytes, const WfogLimits& limits = {});

/// The same with streams, from where they stand: reads up to the end.
Result<DecodedFog> decode_wfog(std::istream& stream, const WfogLimits& limits = {});
Result<WfogReport> encode_wfog(std::ostream& stream, const Fog& fog, const WfogOptions& options,
                               const Grid<float>* map = nullptr);

}  // namespace wavefog
