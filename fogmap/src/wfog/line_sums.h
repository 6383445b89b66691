// How much a field of pixels adds up to along a line, at most.
#pragma once

#include <span>
#include <stop_token>

#include "wavefog/wavelet/grid.h"

namespace wavefog::wfog {

/// Pixels as coefficients of a B-spline surface. Around a map that does not repeat, all pixels are
/// `outside`, which is at most 0.
struct LineField {
    const Grid<float>& pixels;
    float outside;
    bool repeats;
    int degree;
    double cell_x, cell_z;  ///< metres
};

/// What no integral of one of the fields along a segment of up to `longest` metres exceeds,
/// whatever its place and direction; at least 0. Longer segments may count too: it is a price of
/// length, in the field, that keeps them from adding up to more. `parts` of a cell are told apart:
/// 2 takes about four times as long as 1 and is off by less. Less than that if stopped.
double most_along_lines(std::span<const LineField> fields, double longest, int parts, int threads,
                        const std::stop_token& stop);

}  // namespace wavefog::wfog
