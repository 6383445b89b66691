// The bytes around the streams: head and chunks of a .wfog file (fogmap/FORMAT.md).
#pragma once

#include <cstdint>
#include <vector>

#include "bytes.h"
#include "plane.h"
#include "samples.h"
#include "wavefog/fogmap/fog.h"

namespace wavefog::wfog {

inline constexpr unsigned kVersion = 1;

/// What the streams hold.
enum class Content : std::uint8_t {
    pixels,        ///< the finest coefficients; the fog is decomposed again when it is opened
    coefficients,  ///< the bands of the decomposition, as float bits
};

struct Head {
    Fog fog;         ///< all but the coefficients; width and height are set
    int levels = 0;  ///< of the fog's decomposition
    Content content = Content::pixels;
    Scale scale;
    Bounds bounds;  ///< of the integers
    int tile_bits = kDefaultTileBits;
    int stream_levels = 0;
    float max_error = 0;  ///< measured by the encoder, in densities
};

/// One stream chunk a level, coarse first.
struct Chunks {
    Head head;
    std::vector<View> streams;  ///< at most expected() of them
    /// Pixels: a chunk a stream level. Coefficients: the approximation, then a chunk a fog level.
    int expected() const {
        return (head.content == Content::pixels ? head.stream_levels : head.levels) + 1;
    }
    bool truncated = false;
};

Bytes write_chunks(const Head& head, const std::vector<Bytes>& streams);

/// `partial`: a file that ends early is read as far as its chunks are whole; else it is an error.
/// The views lie in `bytes`. Messages start with what is wrong.
Result<Chunks> read_chunks(View bytes, bool partial);

}  // namespace wavefog::wfog
