// A level's pixels by the parity of their coordinates, so that rows of neighbours lie side by side
// in memory.
#pragma once

#include <cstddef>
#include <cstdint>

#include "lattice.h"
#include "scratch.h"

namespace wavefog::wfog {

/// A grid of floats with a margin of 2 on all sides, in memory of a Scratch. Values are not set at
/// first; copies share them.
class Plane {
  public:
    static constexpr int kMargin = 2;

    Plane() = default;
    Plane(int w, int h, Scratch& scratch);
    float* row(int j) { return values_ + std::size_t(j + kMargin) * stride_ + kMargin; }
    const float* row(int j) const { return const_cast<Plane*>(this)->row(j); }

    /// Fills the margin with the nearest values inside; of an empty plane, with those of `other`.
    void extend(const Plane& other);

    std::size_t pixels() const { return std::size_t(width) * std::size_t(height); }

    int width = 0, height = 0;

  private:
    std::size_t stride_ = 0;
    float* values_ = nullptr;
};

/// A level's grid by the parity of its coordinates; `coarse` is the grid of the level before.
struct Parts {
    Plane coarse;      ///< x even, y even
    Plane centres;     ///< x odd, y odd
    Plane horizontal;  ///< x odd, y even
    Plane vertical;    ///< x even, y odd

    Parts() = default;
    /// Of a grid of so many pixels, without `coarse`.
    Parts(int width, int height, Scratch& scratch);
    /// Of the three parts that are new.
    std::size_t pixels() const {
        return centres.pixels() + horizontal.pixels() + vertical.pixels();
    }
};

/// Calls body(j, even, odd) for the rows of a grid: pixel 2i of its row j is even[i], 2i+1 odd[i].
template <class PartsOrConst, class Body>
void for_each_grid_row(PartsOrConst& parts, int height, Body body) {
    for (int j = 0; j < height; ++j)
        body(j, (j % 2 ? parts.vertical : parts.coarse).row(j / 2),
             (j % 2 ? parts.centres : parts.horizontal).row(j / 2));
}

Parts split(const Plane& grid, Scratch& scratch);
Plane merge(const Parts& parts, Scratch& scratch);

/// How many pixels of a row or column of `count` are multiples of 2^coarser.
inline int multiples(int count, int coarser) {
    return ((count - 1) >> coarser) + 1;
}

/// A tile's integers, as floats relative to `low`.
Plane plane_of(const Tile& tile, std::int32_t low, Scratch& scratch);

/// Split and merged at once.
Parts split(const Tile& tile, std::int32_t low, Scratch& scratch);
void merge(const Parts& parts, std::int32_t low, Tile& tile);

}  // namespace wavefog::wfog
