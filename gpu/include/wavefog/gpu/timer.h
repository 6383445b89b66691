// Timing of frames: GPU timer query and wall time, and the statistics that results quote.
#pragma once

#include <functional>
#include <vector>

#include "wavefog/gpu/objects.h"

namespace wavefog {

/// Milliseconds of one finished frame.
struct FrameTime {
    double gpu_ms = 0;   ///< GL_TIME_ELAPSED; on a software rasteriser close to wall_ms
    double wall_ms = 0;  ///< from an idle pipeline to glFinish
};

/// Times one call at a time. Not to be nested with another GL_TIME_ELAPSED query.
class FrameTimer {
  public:
    explicit FrameTimer(const Gl& gl);
    FrameTime time(const std::function<void()>& draw);

  private:
    const Gl* gl_;
    Query query_;
};

/// A set of measurements. Percentiles interpolate linearly between order statistics.
class Samples {
  public:
    void add(double value) { values_.push_back(value); }
    std::size_t size() const { return values_.size(); }
    double percentile(double percent) const;  ///< percent in [0,100]; NaN without samples
    double median() const { return percentile(50); }

  private:
    std::vector<double> values_;
};

}  // namespace wavefog
