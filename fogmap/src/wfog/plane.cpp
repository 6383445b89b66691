#include "plane.h"

#include <algorithm>
#include <atomic>
#include <cfenv>
#include <limits>

#include "mixing_coder.h"
#include "parallel.h"
#include "table_coder.h"

namespace wavefog::wfog {

namespace {

using std::int32_t;
using std::int64_t;
using std::size_t;

enum class TileCoder : unsigned { constant = 0, mixing = 1, tables = 2 };
constexpr unsigned kMarksLow = 4;
constexpr size_t kSmallTile = 128 * 128;

/// Rounding to nearest and denormal numbers as the standard has them, whatever the program that
/// calls has set: the models of encoder and decoder compute with floats.
class StandardFloats {
  public:
    StandardFloats() {
        std::fegetenv(&saved_);
        std::fesetenv(FE_DFL_ENV);
    }
    ~StandardFloats() { std::fesetenv(&saved_); }
    StandardFloats(const StandardFloats&) = delete;
    StandardFloats& operator=(const StandardFloats&) = delete;

  private:
    std::fenv_t saved_;
};

struct Place {
    int x, y, width, height;
};

Place place_of(size_t tile, const PlaneCoding& coding) {
    const int side = 1 << coding.tile_bits;
    const int x = static_cast<int>(tile % size_t(coding.tiles_x())) * side;
    const int y = static_cast<int>(tile / size_t(coding.tiles_x())) * side;
    return {x, y, std::min(side, coding.width - x), std::min(side, coding.height - y)};
}

template <class Copy>
void for_each_row(const Place& place, const PlaneCoding& coding, std::vector<int32_t>& values,
                  Tile& tile, Copy copy) {
    for (int j = 0; j < place.height; ++j) {
        int32_t* const outside =
            values.data() + size_t(place.y + j) * size_t(coding.width) + size_t(place.x);
        int32_t* const inside = tile.values.data() + tile.index(0, j);
        copy(outside, inside, size_t(place.width));
    }
}

std::vector<Bytes> encode_tile(Tile& tile, const PlaneCoding& plane, bool best) {
    const auto [least, most] = std::minmax_element(tile.values.begin(), tile.values.end());
    TileCoding coding;
    coding.levels = plane.levels;
    coding.bounds = plane.bounds;
    coding.low = *least;
    coding.high = *most;
    const auto lows = std::count(tile.values.begin(), tile.values.end(), coding.low);
    coding.marks_low = size_t(lows) > tile.values.size() / 10;

    const int64_t range = int64_t(coding.high) - coding.low;
    // A small tile takes no time either way, and the tables of one weigh more.
    const bool quick = !best && tile.values.size() >= kSmallTile && range <= kTableRange &&
                       coding.bounds.finest <= kTableRange;
    const TileCoder coder = range == 0 ? TileCoder::constant
                            : quick    ? TileCoder::tables
                                       : TileCoder::mixing;
    Writer head;
    head.byte(static_cast<unsigned>(coder) | (coding.marks_low ? kMarksLow : 0u));
    head.signed_length(coding.low);
    if (coder == TileCoder::constant) {
        std::vector<Bytes> streams(size_t(plane.levels) + 1);
        streams[0] = std::move(head.bytes);
        return streams;
    }
    head.length(static_cast<std::uint64_t>(range));
    std::vector<Bytes> streams =
        coder == TileCoder::tables ? encode_tables(tile, coding) : encode_mixing(tile, coding);
    head.append(streams[0]);
    streams[0] = std::move(head.bytes);
    return streams;
}

bool decode_tile(std::vector<View> streams, const PlaneCoding& plane, Tile& tile) {
    Reader head(streams[0]);
    const unsigned flags = head.byte();
    if (flags > (kMarksLow | 3u)) return false;
    constexpr int64_t smallest = std::numeric_limits<int32_t>::min();
    constexpr int64_t largest = std::numeric_limits<int32_t>::max();
    TileCoding coding;
    coding.levels = plane.levels;
    coding.bounds = plane.bounds;
    coding.marks_low = (flags & kMarksLow) != 0;
    const int64_t low = head.signed_length();
    if (head.failed() || low < smallest || low > largest) return false;
    coding.low = static_cast<int32_t>(low);
    const auto coder = static_cast<TileCoder>(flags & 3u);
    if (coder == TileCoder::constant) {
        std::fill(tile.values.begin(), tile.values.end(), coding.low);
        return std::all_of(streams.begin() + 1, streams.end(),
                           [](View each) { return each.empty(); }) &&
               head.left() == 0;
    }
    const std::uint64_t range = head.length();
    if (head.failed() || range > static_cast<std::uint64_t>(largest - low)) return false;
    coding.high = static_cast<int32_t>(low + static_cast<int64_t>(range));
    streams[0] = head.take(head.left());
    if (coder == TileCoder::tables) return decode_tables(tile, coding, streams);
    if (coder != TileCoder::mixing) return false;
    decode_mixing(tile, coding, streams);
    interpolate_levels(tile, plane.levels, static_cast<int>(streams.size()) - 1);
    return true;
}

}  // namespace

int default_stream_levels(int width, int height, int tile_bits) {
    int levels = 0;
    while (levels < tile_bits && (std::max(width, height) >> (levels + 1)) >= 16) ++levels;
    return levels;
}

bool encode_plane(std::vector<int32_t>& values, const PlaneCoding& coding, bool best, int threads,
                  const std::stop_token& stop, PlaneStreams& streams) {
    streams.assign(size_t(coding.levels) + 1, std::vector<Bytes>(coding.tiles()));
    return for_each_parallel(coding.tiles(), threads, stop, [&](size_t t) {
        const StandardFloats standard;
        const Place place = place_of(t, coding);
        Tile tile(place.width, place.height);
        for_each_row(place, coding, values, tile,
                     [](int32_t* from, int32_t* to, size_t n) { std::copy_n(from, n, to); });
        std::vector<Bytes> coded = encode_tile(tile, coding, best);
        for (size_t level = 0; level < coded.size(); ++level)
            streams[level][t] = std::move(coded[level]);
        for_each_row(place, coding, values, tile,
                     [](int32_t* to, int32_t* from, size_t n) { std::copy_n(from, n, to); });
    });
}

PlaneResult decode_plane(const PlaneViews& streams, const PlaneCoding& coding, int threads,
                         const std::stop_token& stop, std::vector<int32_t>& values) {
    std::atomic<bool> damaged = false;
    const bool done = for_each_parallel(coding.tiles(), threads, stop, [&](size_t t) {
        if (damaged) return;
        const StandardFloats standard;
        const Place place = place_of(t, coding);
        Tile tile(place.width, place.height);
        std::vector<View> own;
        for (const std::vector<View>& level : streams) own.push_back(level[t]);
        if (!decode_tile(std::move(own), coding, tile)) {
            damaged = true;
            return;
        }
        for_each_row(place, coding, values, tile,
                     [](int32_t* to, int32_t* from, size_t n) { std::copy_n(from, n, to); });
    });
    return damaged ? PlaneResult::damaged : done ? PlaneResult::done : PlaneResult::stopped;
}

}  // namespace wavefog::wfog
