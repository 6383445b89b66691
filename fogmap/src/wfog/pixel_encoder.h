// From a fog's pixels to files of a given error.
#pragma once

#include <cstdint>
#include <optional>

#include "format.h"
#include "plane.h"
#include "source.h"
#include "wavefog/fogmap/wfog.h"

namespace wavefog::wfog {

/// A file and what a decoder makes of it.
struct Trial {
    EncodedFog file;
    Grid<float> map;        ///< where rays are promised
    bool negative = false;  ///< somewhere below 0 where the original is not
};

/// The smaller file, or what went wrong.
Result<Trial> smaller_of(Result<Trial> a, Result<Trial> b);

/// Bounds of a smooth map: that of the finest level as a share of what is allowed, and those of the
/// levels before it, each a share of the next.
struct Tightness {
    double finest = 1, coarser = 1;
};

/// One file from a fog's pixels, with at most `error` (in densities; 0: none) at any pixel.
class PixelEncoder {
  public:
    PixelEncoder(const Fog& fog, const Source& source, const WfogOptions& options);

    Result<Trial> encode(double error);

    /// `coarseness`: how many times `error` the densest pixels may be off, at least 1. `coarser`:
    /// the bound of every level as a share of the next one's, at most 1.
    Result<Trial> encode(double error, double coarseness, double coarser);

    /// How many bits a pixel less the coarseness takes than 1, about.
    double saving(double error, double coarseness);

    /// As encode(), with errors that are 3 dB below a prequantiser's where the map is smooth.
    Result<Trial> encode_well(double error);

  private:
    Bounds bounds_by(const Tightness& by) const;
    PlaneCoding coding() const;
    std::optional<double> rms_of(const Bounds& bounds, Strips strips);
    Result<Trial> encode_within(const Bounds& bounds);
    bool holds(const Bytes& bytes, const PlaneStreams& streams) const;
    void choose_scale(double error);
    void find_scale(double error, double coarseness);

    const Source& source_;
    const WfogOptions& options_;
    Head head_;
    std::int64_t allowed_ = 0;  ///< how far an integer may be off
    bool smooth_ = false;       ///< most pixels follow from their neighbours
};

}  // namespace wavefog::wfog
