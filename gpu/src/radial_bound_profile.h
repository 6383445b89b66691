// The certified bound of method radial's look-ups in exponential profiles.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "radial_wedge.h"
#include "wavefog/gpu/radial_bound.h"

namespace wavefog {

/// The largest |dT| of rays whose optical depth is at least k tau and off by at most k error, for
/// all k from least to most. `drawn`: k times this is drawn at least.
double worst_error(double tau, double error, double least, double most, double drawn);

/// What bounds know of a table and its eye.
struct RadialFacts {
    RayLimits limits;
    double start = 0;         ///< metres from the eye's place to row 0
    double densest = 0;       ///< 1/m
    double cell = 1;          ///< metres, the shorter side
    bool step = false;        ///< look-ups are exact behind their row
    bool repeat = false;      ///< rays go on behind the last row
    bool depth_only = false;  ///< bounds are of optical depth, |dtau|
};

/// What float32 leaves of sums along a column of up to `high`, `far` metres from the eye.
double radial_rounding(const RadialFacts& facts, double far, double high);

/// Rays of every slope through the profile exp(-max(eta, 0)), eta in scale heights above the base,
/// for wedges one after the other. The shader takes the density between rows as the polynomial with
/// its integral and its centre of mass (and second moment): with weight w along the ray,
/// - a whole stretch errs by at most |density - polynomial|_1 times the distance of w from straight
///   lines (parabolas), as these moments of the difference vanish; |.|_1 <= d min(osc / 2,
///   |rho'| d / 12^.5), the norm of what an L2 projection leaves;
/// - the stretches around a ray's end and the base err by w times the largest partial integral of
/// the
///   difference, min(7/16 osc, |rho'| d / 4) d;
/// - azimuths and coarser levels err by w times RadialStretch::angular (second mean value theorem).
/// Slopes are searched in intervals that cover all; neighbouring wedges are taken together, each
/// row at its worst.
class ProfileSearch {
  public:
    /// `eta`: the eye's; `scale`: metres a scale height; `wedges`: about how many come.
    ProfileSearch(double eta, double scale, const RadialFacts& facts, int wedges);

    /// Of one wedge, stretches from the eye outwards.
    void add(const std::vector<RadialStretch>& stretches);
    /// The largest error so far.
    double largest();

  private:
    /// Over neighbouring rows.
    struct Range {
        double low, high, slope;  ///< of the density
        double widest_row;        ///< metres
        Range with(const Range& o) const {
            return {std::min(low, o.low), std::max(high, o.high), std::max(slope, o.slope),
                    std::max(widest_row, o.widest_row)};
        }
    };
    struct Window {
        Range range;
        double span, far;  ///< metres: of a polynomial at most; to the last row's end
        bool alone;
    };

    void find_ranges();
    void search();
    void slopes(double least, double most, bool rising);
    void steepest(double least);
    Window window(std::size_t row, double reach) const;
    void include(double tau, double error, double least, double most);

    double eta_, scale_;
    RadialFacts facts_;
    int together_;
    double top_, width_, widen_, nearby_;  ///< of fog_radial_spans.glsl
    std::vector<RadialStretch> rows_;      ///< the worst of the wedges that wait
    std::vector<std::vector<Range>> ranges_;
    std::vector<double> cut_;  ///< up to each row: what straight lines instead of parabolas add
    int waiting_ = 0;
    double largest_ = 0;
};

}  // namespace wavefog
