#include "lattice.h"

namespace wavefog::wfog {

void interpolate_levels(Tile& tile, int levels, int known) {
    for (int level = known + 1; level <= levels; ++level) {
        const int h = 1 << (levels - level);
        for (int pass = 0; pass < 2; ++pass)
            for_each_in_pass(tile.width, tile.height, h, pass, [&](int x, int y) {
                std::int64_t sum = 0, count = 0;
                for (std::size_t i = 0; i < 4; ++i) {
                    const int u = x + kNeighbours[std::size_t(pass)][i].first * h;
                    const int v = y + kNeighbours[std::size_t(pass)][i].second * h;
                    if (u < 0 || v < 0 || u >= tile.width || v >= tile.height) continue;
                    sum += tile.values[tile.index(u, v)];
                    ++count;
                }
                // The first neighbour of either pass is inside the tile or its opposite is.
                const std::int64_t mean = (2 * sum + (sum < 0 ? -count : count)) / (2 * count);
                tile.values[tile.index(x, y)] = static_cast<std::int32_t>(mean);
            });
    }
}

}  // namespace wavefog::wfog
