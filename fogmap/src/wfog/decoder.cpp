#include "decoder.h"

#include <fmt/format.h>

#include <algorithm>

#include "../finite.h"
#include "bands.h"
#include "plane.h"

namespace wavefog::wfog {

using std::size_t;

namespace {

tl::unexpected<Error> damaged_stream() {
    return data_error("damaged: a stream is impossible; get the file again");
}

tl::unexpected<Error> not_finite() {
    return data_error("damaged: a density is not finite; get the file again");
}

}  // namespace

tl::unexpected<Error> cancelled() {
    return data_error("cancelled; nothing was written");
}

Result<Decomposition<float>> decompose_as(const Grid<float>& map, const Decomposition<float>& like,
                                          int levels) {
    return decompose(map, like.family, levels, like.form, like.boundary);
}

PlaneCoding coding_of(const Head& head, int width, int height, int levels) {
    return {width, height, head.tile_bits, levels, head.bounds};
}

bool split_chunk(View chunk, size_t tiles, std::vector<View>& parts) {
    if (tiles == 1) {
        parts.push_back(chunk);
        return true;
    }
    Reader r(chunk);
    if (tiles > chunk.size()) return false;
    std::vector<std::uint64_t> sizes(tiles);
    for (std::uint64_t& size : sizes) size = r.length();
    for (const std::uint64_t size : sizes) parts.push_back(r.take(size));
    return !r.failed() && r.left() == 0;
}

namespace {

/// Tiles as densities of a map.
TileSink into(Grid<float>& map, const Scale& scale) {
    return [&](size_t, const Place& place, const Tile& tile) {
        for (int j = 0; j < place.height; ++j)
            scale.densities(tile.row(j), size_t(place.width),
                            map.data() + place.index(j, static_cast<int>(map.cols())));
        return true;
    };
}

Result<void> decoded(PlaneResult result) {
    if (result == PlaneResult::damaged) return damaged_stream();
    if (result == PlaneResult::stopped) return cancelled();
    return {};
}

Result<void> decode_pixels(const Chunks& chunks, const WfogLimits& limits, DecodedFog& out) {
    const Head& head = chunks.head;
    Decomposition<float>& d = out.fog.decomposition;
    const PlaneCoding coding = coding_of(head, d.width, d.height, head.stream_levels);
    PlaneViews streams;
    for (int level = 0; level < out.levels; ++level)
        if (!split_chunk(chunks.streams[size_t(level)], coding.tiles(), streams.emplace_back()))
            return damaged_stream();
    out.map.resize(d.height, d.width);
    if (auto ok = decoded(
            decode_plane(streams, coding, limits.threads, limits.stop, into(out.map, head.scale)));
        !ok)
        return ok;
    if (!detail::all_finite(out.map)) return not_finite();
    auto decomposed = decompose_as(out.map, d, head.levels);
    if (!decomposed) return tl::unexpected(decomposed.error());
    d = std::move(*decomposed);
    return {};
}

Result<void> decode_coefficients(const Chunks& chunks, const WfogLimits& limits, DecodedFog& out) {
    const Head& head = chunks.head;
    Decomposition<float>& d = out.fog.decomposition;
    // The bands of an empty map lie where those of the file do.
    auto empty = decompose_as(Grid<float>(Grid<float>::Zero(d.height, d.width)), d, head.levels);
    if (!empty) return tl::unexpected(empty.error());
    d = std::move(*empty);
    if (d.levels() != head.levels) return damaged_stream();
    const auto bands = bands_of(d);
    for (size_t level = 0; level < size_t(out.levels); ++level) {
        Reader r(chunks.streams[level]);
        for (Band<float>* band : bands[level]) {
            if (band->values.size() == 0) continue;
            const PlaneCoding coding =
                coding_of(head, band->width(), band->height(), band_levels(*band, head.tile_bits));
            PlaneViews streams(size_t(coding.levels) + 1);
            for (std::vector<View>& stream : streams)
                for (size_t tile = 0; tile < coding.tiles(); ++tile)
                    stream.push_back(r.take(r.length()));
            if (r.failed()) return damaged_stream();
            if (auto ok = decoded(decode_plane(streams, coding, limits.threads, limits.stop,
                                               into(band->values, head.scale)));
                !ok)
                return ok;
        }
        if (r.left() != 0) return damaged_stream();
    }
    out.map = reconstruct(d);
    if (!detail::all_finite(out.map)) return not_finite();
    return {};
}

}  // namespace

Result<DecodedFog> decode(View bytes, const WfogLimits& limits) {
    auto chunks = read_chunks(bytes, limits.partial);
    if (!chunks) return tl::unexpected(chunks.error());
    const Head& head = chunks->head;
    const Decomposition<float>& d = head.fog.decomposition;
    const double needed = double(d.width) * double(d.height) * double(sizeof(float));
    if (needed > static_cast<double>(limits.max_map_bytes))
        return data_error(fmt::format(
            "{} x {} pixels need {:.0f} MiB, above the limit of {:.0f} MiB for files that nobody "
            "vouches for; use a smaller map (WfogLimits::max_map_bytes raises the limit)",
            d.width, d.height, needed / (1 << 20),
            static_cast<double>(limits.max_map_bytes) / (1 << 20)));
    DecodedFog out;
    out.fog = head.fog;
    out.of_levels = chunks->expected();
    out.levels = std::min(
        {std::max(limits.levels, 1), chunks->expected(), static_cast<int>(chunks->streams.size())});
    out.max_error = double(head.max_error);
    const auto done = head.content == Content::pixels ? decode_pixels(*chunks, limits, out)
                                                      : decode_coefficients(*chunks, limits, out);
    if (!done) return tl::unexpected(done.error());
    if (auto ok = out.fog.validate(); !ok) return tl::unexpected(ok.error());
    return out;
}

}  // namespace wavefog::wfog
