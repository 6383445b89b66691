// What an encoder starts from.
#pragma once

#include <optional>

#include "samples.h"
#include "wavefog/fogmap/fog.h"

namespace wavefog::wfog {

/// The fog's pixels and, if they are multiples of a common fraction, which.
struct Source {
    const Grid<float>* given = nullptr;  ///< its pixels, unless `made`
    std::optional<Grid<float>> made;
    std::optional<Scale> ratio;
    double slack = 0;    ///< how far pixels are from the multiples
    bool exact = false;  ///< decomposing the map gives the fog's own bits; known if lossless

    const Grid<float>& map() const { return made ? *made : *given; }
};

/// `map`: the pixels that the fog was made from, which outlive the source; or null. `lossless`:
/// they must give the fog's own bits.
Source source_of(const Fog& fog, const Grid<float>* map, bool lossless);

}  // namespace wavefog::wfog
