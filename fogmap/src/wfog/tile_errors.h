// What a decoded tile has lost.
#pragma once

#include <cstddef>

#include "lattice.h"
#include "plane.h"
#include "samples.h"
#include "wavefog/wavelet/grid.h"

namespace wavefog::wfog {

/// Of densities.
struct Errors {
    double most = 0, squares = 0;
    bool negative = false;  ///< somewhere below 0 where the original is not

    void add(const Errors& other);
};

/// Of `count` densities.
Errors errors_of(const float* original, const float* decoded, std::size_t count);

/// Decoded tiles beside a map of densities.
class TileErrors {
  public:
    /// `exact`: integers must be the map's own. `decoded`: gets the densities of the tiles; or
    /// null.
    TileErrors(const Grid<float>& map, const Scale& scale, std::size_t tiles, bool exact,
               Grid<float>* decoded)
        : map_(map), scale_(scale), errors_(tiles), exact_(exact), decoded_(decoded) {}

    /// False if it must be exact and is not.
    bool add(std::size_t tile, const Place& place, const Tile& values);
    /// Of all tiles, in an order that does not depend on threads.
    Errors sum() const;

  private:
    const Grid<float>& map_;
    const Scale& scale_;
    std::vector<Errors> errors_;
    const bool exact_;
    Grid<float>* const decoded_;
};

}  // namespace wavefog::wfog
