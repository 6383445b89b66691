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
    const int degree = pyramid.degree, finest = pyramid.detail_levels();
    const int per_cell = (degree + 1) * (degree + 1);
    const int texels_per_cell = degree == 2 ? 3 : 1;
    CellAtlas atlas;
    atlas.channels = degree == 0 ? 1 : 4;

    const auto& map = pyramid.levels.back().values;
    double largest = 0;
    for (const auto& level : pyramid.levels)
        if (level.values.size() > 0)
            largest = std::max(largest, static_cast<double>(level.values.abs().maxCoeff()));
    atlas.density_scale = power_of_two_above(largest);
    atlas.mean_density = map.size() > 0 ? map.cast<double>().mean() / atlas.density_scale : 0;

    atlas.levels.resize(pyramid.levels.size());
    int x = 0, coarse_height = 0;
    const int top = pyramid.cells_z(finest);
    atlas.width = pyramid.cells_x(finest) * texels_per_cell;
    for (int l = finest - 1; l >= 0; --l) {
        atlas.levels[static_cast<std::size_t>(l)] = {x, top, pyramid.cells_x(l),
                                                     pyramid.cells_z(l)};
        x += pyramid.cells_x(l) * texels_per_cell;
        coarse_height = std::max(coarse_height, pyramid.cells_z(l));
    }
    atlas.levels[static_cast<std::size_t>(finest)] = {0, 0, pyramid.cells_x(finest), top};
    atlas.width = std::max(atlas.width, x);
    atlas.height = top + coarse_height;
    atlas.texels.assign(static_cast<std::size_t>(atlas.width) *
                            static_cast<std::size_t>(atlas.height) *
                            static_cast<std::size_t>(atlas.channels),
                        0.0f);
    for (std::size_t n = 0; n < atlas.texels.size(); n += static_cast<std::size_t>(atlas.channels))
        atlas.texels[n] = -kEmpty;

    const float to_texel = static_cast<float>(1 / atlas.density_scale);
    for (int l = 0; l <= finest; ++l) {
        const auto& place = atlas.levels[static_cast<std::size_t>(l)];
        const auto cells = cell_polynomials(pyramid.levels[static_cast<std::size_t>(l)], degree,
                                            pyramid.boundary, place.z, place.w);
        std::vector<std::uint8_t> empty(static_cast<std::size_t>(place.z) *
                                        static_cast<std::size_t>(place.w));
        for (std::size_t c = 0; c < empty.size(); ++c)
            empty[c] = std::all_of(&cells[c * static_cast<std::size_t>(per_cell)],
                                   &cells[c * static_cast<std::size_t>(per_cell)] + per_cell,
                                   [](float v) { return v == 0; });
        const auto distance =
            distance_to_fog(empty, place.z, place.w, pyramid.boundary == Boundary::repeat);
        if (l == finest)
            atlas.skippable = static_cast<double>(std::count_if(distance.begin(), distance.end(),
                                                                [](int d) { return d > 1; })) /
                              static_cast<double>(distance.size());
        for (int j = 0; j < place.w; ++j)
            for (int i = 0; i < place.z; ++i) {
                const std::size_t c =
                    static_cast<std::size_t>(j) * static_cast<std::size_t>(place.z) +
                    static_cast<std::size_t>(i);
                const float* polynomial = &cells[c * static_cast<std::size_t>(per_cell)];
                float* texel =
                    &atlas.texels[(static_cast<std::size_t>(place.y + j) *
                                       static_cast<std::size_t>(atlas.width) +
                                   static_cast<std::size_t>(place.x + i * texels_per_cell)) *
                                  static_cast<std::size_t>(atlas.channels)];
                if (empty[c]) {
                    texel[0] = -kEmpty - static_cast<float>(distance[c] - 1);
                    continue;
                }
                // Quadratic rows of three coefficients start at every fourth channel.
                for (int n = 0; n < per_cell; ++n)
                    texel[degree == 2 ? n / 3 * 4 + n % 3 : n] = polynomial[n] * to_texel;
            }
    }
    return atlas;
}

}  // namespace wavefog
