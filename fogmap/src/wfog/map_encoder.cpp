#include "map_encoder.h"

#include "decoder.h"

namespace wavefog::wfog {

using std::size_t;

tl::unexpected<Error> broken_promise() {
    return data_error("the encoded bytes do not keep the promise; this is a bug, please report it");
}

TileSource tiles_of(const Grid<float>& map, const Scale& scale) {
    return [&](const Place& place, Tile& tile) {
        for (int j = 0; j < place.height; ++j)
            scale.integers(map.data() + place.index(j, static_cast<int>(map.cols())),
                           size_t(place.width), tile.row(j));
    };
}

Result<Errors> encode_map(const Grid<float>& map, const Scale& scale, const PlaneCoding& coding,
                          const WfogOptions& options, bool exact, Grid<float>* decoded,
                          PlaneStreams& streams) {
    TileErrors errors(map, scale, coding.tiles(), exact, decoded);
    const PlaneResult result = encode_plane(
        coding, options.best, options.threads, options.stop, tiles_of(map, scale),
        [&](size_t tile, const Place& place, const Tile& values) {
            return errors.add(tile, place, values);
        },
        streams);
    if (result == PlaneResult::stopped) return cancelled();
    if (result == PlaneResult::damaged) return broken_promise();
    return errors.sum();
}

Head head_of(const Fog& fog) {
    Head head;
    head.fog.rect = fog.rect;
    head.fog.extinction = fog.extinction;
    head.fog.profile = fog.profile;
    head.fog.wind = fog.wind;
    Decomposition<float>& d = head.fog.decomposition;
    d.family = fog.decomposition.family;
    d.form = fog.decomposition.form;
    d.boundary = fog.decomposition.boundary;
    d.width = fog.decomposition.width;
    d.height = fog.decomposition.height;
    head.levels = fog.decomposition.levels();
    return head;
}

}  // namespace wavefog::wfog
