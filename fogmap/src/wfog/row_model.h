// What the coder of the default profile knows of a row of pixels from those around it.
#pragma once

#include <array>
#include <cstdint>

#include "parts.h"

namespace wavefog::wfog {

/// Weights of a level's predictors, in 64ths.
struct Weights {
    std::int8_t centre = 8;  ///< how far beyond the inner mean, seen from the outer one
    std::array<std::int8_t, 2> along = {32, 32};  ///< of the pair along x: horizontal, vertical
    std::array<std::int8_t, 2> beyond = {8, 8};

    /// In the order of a stream.
    std::array<std::int8_t*, 5> all() {
        return {&centre, &along[0], &along[1], &beyond[0], &beyond[1]};
    }
};

/// Those of one part.
struct Mixture {
    float a = 0.5f, beyond = 0;
};
/// Part 0: centres, 1: horizontal, 2: vertical.
Mixture mixture_of(const Weights& weights, int part);

/// Where the pixels around a row of pixels are: the inner pairs and the outer ring of eight.
struct Row {
    // The pair along x, the pair along y (centres: the two diagonals), and the ring.
    const float *a0, *a1, *b0, *b1;
    std::array<const float*, 8> ring;
};
/// Row j of a part; the planes that it looks at are extended.
Row row_of(const Parts& parts, int part, int j);

/// How values become quotients and back. Values are relative to the least of the tile.
struct Quantiser {
    float step, inverse_step, most;
    Quantiser(float step_, float most_) : step(step_), inverse_step(1 / step_), most(most_) {}
};

// All of these compute the same floats on every machine, with or without vectors.

/// Predictions and contexts of a row. `before`: magnitudes of the quotients of the row above in the
/// same part, from -1 to `width`.
void predict(const Row& row, const Mixture& mix, const Quantiser& quantiser, const float* before,
             int width, float* predicted, std::uint8_t* contexts);

/// The quotients of a row, and what a decoder will see in place of its values.
void quantise(const float* predicted, int width, const Quantiser& quantiser, float* values,
              std::int32_t* quotients);

void restore(const float* predicted, const std::int32_t* quotients, int width,
             const Quantiser& quantiser, float* values);

/// Magnitudes for the row below.
void remember(const std::int32_t* quotients, int width, float* before);

/// The sum of the squared differences of two rows.
double squared_distance(const float* a, const float* b, int width);

/// The weights that suit a level best: least squares on the values in `parts`, whose margins it
/// sets. Every fourth row will do where there are many, and `roughly` anywhere.
Weights fit(Parts& parts, bool roughly);

}  // namespace wavefog::wfog
