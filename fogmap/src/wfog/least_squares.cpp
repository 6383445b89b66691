#include "least_squares.h"

#include <cmath>

#include "vector_clones.h"

namespace wavefog::wfog {

using std::size_t;

namespace {

/// Rows from `first` on, four of them, up to column `Columns`: sums stay in registers.
template <size_t Columns, class Samples, class Square>
[[gnu::always_inline]] inline void add_rows(const Samples& samples, Square& moments) {
    for (size_t i = Columns - 4; i < Columns; ++i) {
        std::array<double, Columns> row;
        for (size_t j = 0; j < Columns; ++j) row[j] = moments[i][j];
        for (const auto& sample : samples) {
            const double xi = sample.x[i] * sample.scale;
            for (size_t j = 0; j < Columns; ++j) row[j] += xi * sample.x[j];
        }
        for (size_t j = 0; j < Columns; ++j) moments[i][j] = row[j];
    }
}

}  // namespace

WAVEFOG_VECTOR_CLONES
void LeastSquares::add(const Pending& samples, Square& moments, Inputs& target) {
    add_rows<4>(samples, moments);
    add_rows<8>(samples, moments);
    add_rows<12>(samples, moments);
    add_rows<16>(samples, moments);
    for (const Sample& sample : samples)
        for (size_t i = 0; i < kInputs; ++i) target[i] += sample.x[i] * sample.scale * sample.truth;
}

void LeastSquares::take_pending() {
    add(pending_, moments_, target_);
    samples_ = 0;
    solve();
    if (growth_ > 1e9) shrink();
}

void LeastSquares::shrink() {
    const double factor = 1 / growth_;
    for (size_t i = 0; i < kInputs; ++i) {
        for (size_t j = 0; j <= i; ++j) moments_[i][j] *= factor;
        target_[i] *= factor;
    }
    growth_ = 1;
}

WAVEFOG_VECTOR_CLONES
void LeastSquares::solve() {
    // Column after column of L, whose products leave the columns behind at once: side by side, and
    // from every element in the order of columns. `l[k]` is column k; the right side goes along.
    Square l;
    Inputs inverse, y = target_;
    for (size_t k = 0; k < kInputs; ++k)
        for (size_t i = k; i < kInputs; ++i) l[k][i] = moments_[i][k];
    for (size_t k = 0; k < kInputs; ++k)
        l[k][k] += growth_;  // ridge: weights stay small until data speak
    for (size_t k = 0; k < kInputs; ++k) {
        // Not positive definite: keep the old weights.
        if (!(l[k][k] > 1e-12 * growth_)) return;
        const double root = std::sqrt(l[k][k]);
        inverse[k] = 1 / root;
        for (size_t i = k + 1; i < kInputs; ++i) l[k][i] *= inverse[k];
        y[k] *= inverse[k];
        for (size_t j = k + 1; j < kInputs; ++j)
            for (size_t i = j; i < kInputs; ++i) l[j][i] -= l[k][i] * l[k][j];
        for (size_t i = k + 1; i < kInputs; ++i) y[i] -= l[k][i] * y[k];
    }
    for (size_t i = kInputs; i-- > 0;) {
        double right = y[i];
        for (size_t k = i + 1; k < kInputs; ++k) right -= l[i][k] * weights_[k];
        weights_[i] = right * inverse[i];
    }
}

}  // namespace wavefog::wfog
