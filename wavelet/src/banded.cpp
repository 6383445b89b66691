#include "banded.h"

#include <algorithm>

namespace wavefog {

BandedLdlt::BandedLdlt(int size, int half_bandwidth)
    : size_(size),
      half_bandwidth_(half_bandwidth),
      entries_(static_cast<std::size_t>(size) * static_cast<std::size_t>(half_bandwidth + 1), 0.0) {
}

void BandedLdlt::factor() {
    for (int i = 0; i < size_; ++i) {
        const int first = std::max(0, i - half_bandwidth_);
        for (int j = first; j <= i; ++j) {
            // L(i,j) D(j) = A(i,j) - sum_k L(i,k) D(k) L(j,k)
            double sum = at(i, i - j);
            for (int k = std::max(first, j - half_bandwidth_); k < j; ++k)
                sum -= at(i, i - k) * at(k, 0) * at(j, j - k);
            entry(i, i - j) = j == i ? sum : sum / at(j, 0);
        }
    }
}

void BandedLdlt::solve_in_place(Grid<double>& rows) const {
    for (int i = 0; i < size_; ++i)
        for (int below = 1; below <= std::min(i, half_bandwidth_); ++below)
            rows.row(i) -= at(i, below) * rows.row(i - below);
    for (int i = 0; i < size_; ++i) rows.row(i) /= at(i, 0);
    for (int i = size_ - 1; i >= 0; --i)
        for (int below = 1; below <= std::min(i, half_bandwidth_); ++below)
            rows.row(i - below) -= at(i, below) * rows.row(i);
}

}  // namespace wavefog
