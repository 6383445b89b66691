#include "parts.h"

#include <algorithm>

namespace wavefog::wfog {

using std::size_t;

Plane::Plane(int w, int h)
    : width(w),
      height(h),
      stride_(size_t(w) + 2 * kMargin),
      values_(std::make_unique_for_overwrite<float[]>(stride_ * (size_t(h) + 2 * kMargin))) {}

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

Parts::Parts(int w, int h)
    : centres(w / 2, h / 2), horizontal(w / 2, (h + 1) / 2), vertical((w + 1) / 2, h / 2) {}

Parts split(const Plane& grid) {
    const int w = grid.width;
    Parts parts(w, grid.height);
    parts.coarse = Plane((w + 1) / 2, (grid.height + 1) / 2);
    for_each_grid_row(parts, grid.height, [&](int j, float* even, float* odd) {
        const float* from = grid.row(j);
        for (int i = 0; i < w / 2; ++i) {
            even[i] = from[2 * i];
            odd[i] = from[2 * i + 1];
        }
        if (w % 2) even[w / 2] = from[w - 1];
    });
    return parts;
}

Plane merge(const Parts& parts) {
    const int w = parts.coarse.width + parts.horizontal.width;
    Plane grid(w, parts.coarse.height + parts.vertical.height);
    for_each_grid_row(parts, grid.height, [&](int j, const float* even, const float* odd) {
        float* to = grid.row(j);
        for (int i = 0; i < w / 2; ++i) {
            to[2 * i] = even[i];
            to[2 * i + 1] = odd[i];
        }
        if (w % 2) to[w - 1] = even[w / 2];
    });
    return grid;
}

}  // namespace wavefog::wfog
