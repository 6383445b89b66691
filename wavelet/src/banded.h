// LDL^T of symmetric positive definite banded matrices. Eigen has no public banded solver.
#pragma once

#include <vector>

#include "wavefog/wavelet/grid.h"

namespace wavefog {

/// A = L D L^T for A of size n with entries only where |i - j| <= half_bandwidth. No pivoting:
/// the Gram matrices of B-splines are well conditioned on any section (stability.md, section 2).
class BandedLdlt {
  public:
    BandedLdlt(int size, int half_bandwidth);

    int size() const { return size_; }
    /// A(row, row - below), 0 <= below <= half_bandwidth. Fill all of it, then call factor().
    double& entry(int row, int below) { return entries_[index(row, below)]; }
    void factor();
    /// Replaces `rows` (size() rows, any number of right-hand sides) by A^-1 rows.
    void solve_in_place(Grid<double>& rows) const;

  private:
    std::size_t index(int row, int below) const {
        return static_cast<std::size_t>(row) * static_cast<std::size_t>(half_bandwidth_ + 1) +
               static_cast<std::size_t>(below);
    }
    double at(int row, int below) const { return entries_[index(row, below)]; }

    int size_;
    int half_bandwidth_;
    std::vector<double> entries_;  // after factor(): D at below = 0, L elsewhere
};

}  // namespace wavefog
