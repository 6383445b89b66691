// Index ranges of coefficients.
#pragma once

#include <algorithm>

#include "wavefog/wavelet/grid.h"

namespace wavefog {

/// Indices first..last, both included; empty when last < first.
struct Range {
    int first = 0;
    int last = -1;

    int size() const { return last - first + 1; }
    bool contains(int index) const { return index >= first && index <= last; }
    bool operator==(const Range&) const = default;
};

inline Range hull(Range a, Range b) {
    return {std::min(a.first, b.first), std::max(a.last, b.last)};
}

struct IndexRect {
    Range x, z;

    bool operator==(const IndexRect&) const = default;
};

template <class T>
IndexRect rect_of(const Band<T>& band) {
    return {{band.start_x, band.start_x + band.width() - 1},
            {band.start_z, band.start_z + band.height() - 1}};
}

/// The part of a band inside `rect`, zero where the band has nothing.
template <class T>
Band<T> cropped(const Band<T>& band, const IndexRect& rect) {
    Band<T> out{Grid<T>::Zero(rect.z.size(), rect.x.size()), rect.x.first, rect.z.first};
    const IndexRect own = rect_of(band);
    const Range x{std::max(own.x.first, rect.x.first), std::min(own.x.last, rect.x.last)};
    const Range z{std::max(own.z.first, rect.z.first), std::min(own.z.last, rect.z.last)};
    if (x.size() > 0 && z.size() > 0)
        out.values.block(z.first - rect.z.first, x.first - rect.x.first, z.size(), x.size()) =
            band.values.block(z.first - own.z.first, x.first - own.x.first, z.size(), x.size());
    return out;
}

}  // namespace wavefog
