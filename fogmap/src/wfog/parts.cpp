#include "parts.h"

#include <algorithm>

namespace wavefog::wfog {

using std::size_t;

Plane::Plane(int w, int h, Scratch& scratch)
    : width(w),
      height(h),
      stride_(size_t(w) + 2 * kMargin),
      values_(scratch.take<float>(stride_ * (size_t(h) + 2 * kMargin)).data()) {}

void Plane::extend(const Plane& other) {
    for (int j = -kMargin; j < height + kMargin; ++j) {
        const bool empty = width == 0 || height == 0;
        const float* from = empty ? other.row(std::clamp(j, 0, other.height - 1))
                                  : row(std::clamp(j, 0, height - 1));
        const int last = (empty ? other.width : width) - 1;
        float* to = row(j);
        if (from != to)
            for (int i = 0; i < width; ++i) to[i] = from[std::min(i, last)];
        for (int i = -kMargin; i < 0; ++i) to[i] = from[0];
        for (int i = width; i < width + kMargin; ++i) to[i] = from[std::min(i, last)];
    }
}

Parts::Parts(int w, int h, Scratch& scratch)
    : centres(w / 2, h / 2, scratch),
      horizontal(w / 2, (h + 1) / 2, scratch),
      vertical((w + 1) / 2, h / 2, scratch) {}

namespace {

/// `row_of(j)` gives values that `to_float` turns into those of the parts.
template <class RowOf, class ToFloat>
Parts split_rows(int w, int h, Scratch& scratch, RowOf row_of, ToFloat to_float) {
    Parts parts(w, h, scratch);
    parts.coarse = Plane((w + 1) / 2, (h + 1) / 2, scratch);
    for_each_grid_row(parts, h, [&](int j, float* __restrict even, float* __restrict odd) {
        const auto* const from = row_of(j);
        for (int i = 0; i < w / 2; ++i) {
            even[i] = to_float(from[2 * i]);
            odd[i] = to_float(from[2 * i + 1]);
        }
        if (w % 2) even[w / 2] = to_float(from[w - 1]);
    });
    return parts;
}

template <class RowOf, class FromFloat>
void merge_rows(const Parts& parts, int w, int h, RowOf row_of, FromFloat from_float) {
    for_each_grid_row(parts, h, [&](int j, const float* even, const float* odd) {
        auto* __restrict const to = row_of(j);
        for (int i = 0; i < w / 2; ++i) {
            to[2 * i] = from_float(even[i]);
            to[2 * i + 1] = from_float(odd[i]);
        }
        if (w % 2) to[w - 1] = from_float(even[w / 2]);
    });
}

}  // namespace

Parts split(const Plane& grid, Scratch& scratch) {
    return split_rows(
        grid.width, grid.height, scratch, [&](int j) { return grid.row(j); },
        [](float value) { return value; });
}

Plane merge(const Parts& parts, Scratch& scratch) {
    Plane grid(parts.coarse.width + parts.horizontal.width,
               parts.coarse.height + parts.vertical.height, scratch);
    merge_rows(
        parts, grid.width, grid.height, [&](int j) { return grid.row(j); },
        [](float value) { return value; });
    return grid;
}

Plane plane_of(const Tile& tile, std::int32_t low, Scratch& scratch) {
    Plane plane(tile.width, tile.height, scratch);
    for (int j = 0; j < tile.height; ++j)
        std::transform(tile.row(j), tile.row(j) + tile.width, plane.row(j),
                       [low](std::int32_t value) { return static_cast<float>(value - low); });
    return plane;
}

Parts split(const Tile& tile, std::int32_t low, Scratch& scratch) {
    return split_rows(
        tile.width, tile.height, scratch, [&](int j) { return tile.row(j); },
        [low](std::int32_t value) { return static_cast<float>(value - low); });
}

void merge(const Parts& parts, std::int32_t low, Tile& tile) {
    merge_rows(
        parts, tile.width, tile.height, [&](int j) { return tile.row(j); },
        [low](float value) { return static_cast<std::int32_t>(value) + low; });
}

}  // namespace wavefog::wfog
