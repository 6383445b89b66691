// Synthetic fogmaps in [0,1] that tests share (stability.md: the maps on which methods differ).
#pragma once

#include <cmath>

#include "support/random.h"
#include "wavefog/wavelet/grid.h"

namespace wavefog::test {

enum class MapKind { constant, linear, smooth, random, hard_edged, impulse, checkerboard };

inline const char* map_name(MapKind kind) {
    static constexpr const char* names[] = {"constant",   "linear",  "smooth",      "random",
                                            "hard_edged", "impulse", "checkerboard"};
    return names[static_cast<int>(kind)];
}

template <class T>
Grid<T> make_map(MapKind kind, int width, int height, Random& random) {
    Grid<T> map(height, width);
    const double phase = kind == MapKind::smooth ? random.uniform(0, 6.28) : 0;
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            const double x = (i + 0.5) / width, z = (j + 0.5) / height;
            double value = 0;
            switch (kind) {
                case MapKind::constant:
                    value = 1;
                    break;
                case MapKind::linear:
                    value = 0.25 + 0.5 * x + 0.25 * z;
                    break;
                case MapKind::smooth:
                    value = 0.5 + 0.25 * std::sin(9 * x + phase) + 0.25 * std::cos(7 * z + 3 * x);
                    break;
                case MapKind::random:
                    value = random.uniform();
                    break;
                case MapKind::hard_edged:
                    value = (std::fmod(5 * x + 3 * z, 1.0) < 0.45) != (z > 0.6) ? 1 : 0;
                    break;
                case MapKind::impulse:
                    value = i == width / 2 && j == height / 2 ? 1 : 0;
                    break;
                case MapKind::checkerboard:
                    value = (i + j) % 2;
                    break;
            }
            map(j, i) = static_cast<T>(value);
        }
    return map;
}

}  // namespace wavefog::test
