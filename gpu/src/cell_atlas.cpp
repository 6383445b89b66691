#include "cell_atlas.h"

#include <algorithm>
#include <cmath>

#include "wavefog/wavelet/cell.h"

namespace wavefog {
namespace {

// Must match FOG_EMPTY in shaders/fog_cell.glsl.
constexpr float kEmpty = 1024.0f;
// Longer jumps save nothing.
constexpr int kLargestRadius = 4095;

double power_of_two_above(double value) {
    return value > 0 ? std::exp2(std::ceil(std::log2(value))) : 1.0;
}

// Chebyshev distance of each cell to the nearest one with fog (0 there), by two sweeps over the
// neighbours already visited. Outside the map there is no fog, unless it repeats: then the sweeps
// run across the seam until nothing changes.
std::vector<int> distance_to_fog(const std::vector<std::uint8_t>& empty, int width, int height,
                                 bool repeat) {
    std::vector<int> distance(empty.size());
    for (std::size_t c = 0; c < empty.size(); ++c) distance[c] = empty[c] ? kLargestRadius + 1 : 0;
    const auto at = [&](int i, int j) {
        if (repeat) {
            i = (i + width) % width;
            j = (j + height) % height;
        } else if (i < 0 || j < 0 || i >= width || j >= height) {
            return kLargestRadius + 1;
        }
        return distance[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                        static_cast<std::size_t>(i)];
    };
    bool changed = true;
    const auto relax = [&](int i, int j, int side) {
        auto& here = distance[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                              static_cast<std::size_t>(i)];
        const int best = 1 + std::min({at(i - side, j), at(i - 1, j - side), at(i, j - side),
                                       at(i + 1, j - side)});
        if (best < here) {
            here = best;
            changed = true;
        }
    };
    while (changed) {
        changed = false;
        for (int j = 0; j < height; ++j)
            for (int i = 0; i < width; ++i) relax(i, j, 1);
        for (int j = height - 1; j >= 0; --j)
            for (int i = width - 1; i >= 0; --i) relax(i, j, -1);
        if (!repeat) break;
    }
    return distance;
}

}  // namespace

CellAtlas build_cell_atlas(const Pyramid<float>& pyramid) {
    using std::size_t;
    const int degree = pyramid.degree, finest = pyramid.detail_levels();
    const size_t per_cell = static_cast<size_t>((degree + 1) * (degree + 1));
    const int texels_per_cell = degree == 2 ? 3 : 1;
    CellAtlas atlas;
    atlas.channels = degree == 0 ? 1 : 4;
    const size_t channels = static_cast<size_t>(atlas.channels);

    const auto& map = pyramid.levels.back().values;
    double largest = 0;
    for (const auto& level : pyramid.levels)
        if (level.values.size() > 0)
            largest = std::max(largest, static_cast<double>(level.values.abs().maxCoeff()));
    atlas.density_scale = power_of_two_above(largest);
    atlas.mean_density = map.size() > 0 ? map.cast<double>().mean() / atlas.density_scale : 0;

    // The finest level on top, the coarser ones in a row below; a border of one cell around each.
    atlas.levels.resize(pyramid.levels.size());
    const int top = pyramid.cells_z(finest) + 2;
    int left = 0, coarse_height = 0;
    for (int l = finest; l >= 0; --l) {
        const int cells_x = pyramid.cells_x(l), cells_z = pyramid.cells_z(l);
        atlas.levels[static_cast<size_t>(l)] = {left + texels_per_cell, l == finest ? 1 : top + 1,
                                                cells_x, cells_z};
        const int width = (cells_x + 2) * texels_per_cell;
        atlas.width = std::max(atlas.width, left + width);
        if (l == finest) continue;
        left += width;
        coarse_height = std::max(coarse_height, cells_z + 2);
    }
    atlas.height = top + coarse_height;
    atlas.texels.assign(
        static_cast<size_t>(atlas.width) * static_cast<size_t>(atlas.height) * channels, 0.0f);
    for (size_t n = 0; n < atlas.texels.size(); n += channels) atlas.texels[n] = -kEmpty;

    const float to_texel = static_cast<float>(1 / atlas.density_scale);
    for (int l = 0; l <= finest; ++l) {
        const auto& place = atlas.levels[static_cast<size_t>(l)];
        const auto cells = cell_polynomials(pyramid.levels[static_cast<size_t>(l)], degree,
                                            pyramid.boundary, place.z, place.w);
        std::vector<std::uint8_t> empty(cells.size() / per_cell);
        for (size_t c = 0; c < empty.size(); ++c) {
            const float* polynomial = &cells[c * per_cell];
            empty[c] =
                std::all_of(polynomial, polynomial + per_cell, [](float v) { return v == 0; });
        }
        const auto distance =
            distance_to_fog(empty, place.z, place.w, pyramid.boundary == Boundary::repeat);
        if (l == finest)
            atlas.skippable = static_cast<double>(std::count_if(distance.begin(), distance.end(),
                                                                [](int d) { return d > 1; })) /
                              static_cast<double>(distance.size());
        for (size_t c = 0; c < empty.size(); ++c) {
            const size_t i = c % static_cast<size_t>(place.z), j = c / static_cast<size_t>(place.z);
            const size_t x =
                static_cast<size_t>(place.x) + i * static_cast<size_t>(texels_per_cell);
            const size_t y = static_cast<size_t>(place.y) + j;
            float* texel = &atlas.texels[(y * static_cast<size_t>(atlas.width) + x) * channels];
            if (empty[c]) {
                texel[0] = -kEmpty - static_cast<float>(distance[c] - 1);
                continue;
            }
            // Quadratic rows of three coefficients start at every fourth channel.
            for (size_t n = 0; n < per_cell; ++n)
                texel[degree == 2 ? n / 3 * 4 + n % 3 : n] = cells[c * per_cell + n] * to_texel;
        }
    }
    return atlas;
}

}  // namespace wavefog
