#include "wavefog/fogmap/coarsen.h"

#include <fmt/format.h>

namespace wavefog {

Result<Fog> fog_like(const Fog& like, const Grid<float>& map, const FogOptions& options) {
    Result<Fog> made = make_fog(map, options);
    if (!made) return made;
    made->rect = like.rect;
    made->extinction = like.extinction;
    made->profile = like.profile;
    made->wind = like.wind;
    return made;
}

Grid<float> map_of(const Fog& fog) {
    return reconstruct(fog.decomposition).max(0.0f);
}

Result<Fog> without_finest(const Fog& fog, int dropped) {
    const Decomposition<float>& d = fog.decomposition;
    if (dropped < 0 || dropped > d.levels())
        return usage_error(
            fmt::format("cannot drop {} of {} levels; decompose into more", dropped, d.levels()));
    if (dropped == 0) return fog;
    const Pyramid<float> pyramid = approximations(d);
    const Band<float>& kept = pyramid.levels[std::size_t(d.levels() - dropped)];
    Result<Fog> made =
        fog_like(fog, kept.values.max(0.0f),
                 {d.degree(), d.family.name(), d.form, d.levels() - dropped, d.boundary});
    if (!made) return made;
    // Decomposition's coordinates: coefficient k of cells `size` wide begins at u = size k, and the
    // picture's left edge lies half a degree after that of its first coefficient.
    const double size = double(1 << dropped), half_degree = d.degree() / 2.0;
    const auto edge = [&](double k, double origin, double cell) {
        return origin + cell * (size * (k + half_degree) - half_degree);
    };
    made->rect = {edge(kept.start_x, fog.rect.x0, fog.cell_x()),
                  edge(kept.start_z, fog.rect.z0, fog.cell_z()),
                  edge(kept.start_x + kept.width(), fog.rect.x0, fog.cell_x()),
                  edge(kept.start_z + kept.height(), fog.rect.z0, fog.cell_z())};
    return made;
}

Result<Fog> decomposed_as(const Fog& fog, int degree, int levels) {
    const Decomposition<float>& d = fog.decomposition;
    return fog_like(fog, map_of(fog), {.degree = degree, .levels = levels, .boundary = d.boundary});
}

}  // namespace wavefog
