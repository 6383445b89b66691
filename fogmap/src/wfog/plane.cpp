#include "plane.h"

#include <algorithm>
#include <atomic>
#include <cfenv>
#include <limits>
#include <numeric>

#include "mixing_coder.h"
#include "parallel.h"
#include "plain_coder.h"
#include "run_coder.h"
#include "table_coder.h"
#include "vector_clones.h"

namespace wavefog::wfog {

namespace {

using std::int32_t;
using std::int64_t;
using std::size_t;

enum class TileCoder : unsigned { constant = 0, mixing = 1, tables = 2, runs = 3, plain = 16 };
constexpr unsigned kMarksLow = 4, kPacked = 8, kCoders = 19;
constexpr int64_t kSmallest = std::numeric_limits<int32_t>::min();
constexpr int64_t kLargest = std::numeric_limits<int32_t>::max();
/// Tiles that reach further have their values, not ranks.
constexpr int64_t kMaxPackedRange = 1 << 16;
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

Place place_of(size_t tile, const PlaneCoding& coding) {
    const int side = 1 << coding.tile_bits;
    const int x = static_cast<int>(tile % size_t(coding.tiles_x())) * side;
    const int y = static_cast<int>(tile / size_t(coding.tiles_x())) * side;
    return {x, y, std::min(side, coding.width - x), std::min(side, coding.height - y)};
}

/// Calls body(at, count) for pieces of `values`, in order, each of one value only: 16 at once where
/// they are as the one before, else one after the other. False as soon as `body` is.
template <class Body>
bool for_each_piece(std::span<const int32_t> values, Body body) {
    constexpr size_t kAtOnce = 16;
    size_t at = 0;
    int32_t last = values[0];
    for (; at + kAtOnce <= values.size(); at += kAtOnce) {
        const int32_t* const next = values.data() + at;
        int32_t differ = 0;
        for (size_t i = 0; i < kAtOnce; ++i) differ |= next[i] ^ last;
        if (differ == 0) {
            if (!body(at, kAtOnce)) return false;
            continue;
        }
        last = next[kAtOnce - 1];
        for (size_t i = 0; i < kAtOnce; ++i)
            if (!body(at + i, size_t(1))) return false;
    }
    for (; at < values.size(); ++at)
        if (!body(at, size_t(1))) return false;
    return true;
}

/// Puts replacement(value) where each value is.
template <class Replacement>
void replace_values(Tile& tile, Replacement replacement) {
    for_each_piece(tile.values, [&](size_t at, size_t count) {
        std::fill_n(&tile.values[at], count, replacement(tile.values[at]));
        return true;
    });
}

/// Whether some neighbours differ, and by no more than `reach`.
WAVEFOG_VECTOR_CLONES
bool any_near(const int32_t* values, size_t count, int32_t reach) {
    int32_t near = 0;
    for (size_t i = 1; i < count; ++i) {
        const int32_t d = std::abs(values[i] - values[i - 1]);
        near |= (d != 0 ? 1 : 0) & (d <= reach ? 1 : 0);
    }
    return near != 0;
}

/// The values of a tile, rising, if their ranks are as good: so far apart that none could stand for
/// two, and with as many that do not occur between. Else nothing.
std::vector<int32_t> values_apart(const Tile& tile, int32_t low, int32_t high, int64_t bound) {
    const int64_t range = int64_t(high) - low;
    if (range == 0 || range >= kMaxPackedRange) return {};
    // Most maps show in some pixels that they are not so.
    const auto reach = static_cast<int32_t>(2 * std::min(bound, range));
    if (any_near(tile.values.data(), std::min(tile.values.size(), size_t(4096)), reach)) return {};
    std::vector<std::uint8_t> occurs(size_t(range) + 1);
    int64_t left = (range + 1) / 2;
    const bool few = for_each_piece(tile.values, [&](size_t at, size_t) {
        std::uint8_t& here = occurs[size_t(tile.values[at] - low)];
        if (here) return true;
        here = 1;
        return left-- > 0;
    });
    if (!few) return {};
    std::vector<int32_t> values;
    for (int64_t k = 0; k <= range; ++k) {
        if (!occurs[size_t(k)]) continue;
        const auto value = static_cast<int32_t>(low + k);
        if (!values.empty() && int64_t(value) - values.back() <= 2 * bound) return {};
        values.push_back(value);
    }
    return values;
}

void to_ranks(const std::vector<int32_t>& table, Tile& tile) {
    std::vector<int32_t> ranks(size_t(int64_t(table.back()) - table[0]) + 1);
    for (size_t r = 0; r < table.size(); ++r)
        ranks[size_t(table[r] - table[0])] = static_cast<int32_t>(r);
    replace_values(tile, [&](int32_t value) { return ranks[size_t(value - table[0])]; });
}

void use_ranks(const std::vector<int32_t>& table, TileCoding& coding) {
    coding.low = 0;
    coding.high = static_cast<int32_t>(table.size()) - 1;
    coding.bounds = {};
}

void from_ranks(const std::vector<int32_t>& table, Tile& tile) {
    replace_values(tile, [&](int32_t value) { return table[size_t(value)]; });
}

/// The differences of a table that starts at `low`.
void write_table(const std::vector<int32_t>& table, Writer& head) {
    head.length(table.size());
    for (size_t r = 1; r < table.size(); ++r)
        head.length(static_cast<std::uint64_t>(int64_t(table[r]) - table[r - 1]));
}

bool read_table(Reader& head, int32_t low, std::vector<int32_t>& table) {
    const std::uint64_t size = head.length();
    if (head.failed() || size < 2 || size > kMaxPackedRange || size - 1 > head.left()) return false;
    table.assign(1, low);
    while (table.size() < size) {
        const std::uint64_t more = head.length();
        if (more < 1 || more > kMaxPackedRange || table.back() > kLargest - int64_t(more))
            return false;
        table.push_back(static_cast<int32_t>(table.back() + int64_t(more)));
    }
    return !head.failed();
}

struct Extremes {
    int32_t least, most;
};

/// Of at least one value.
WAVEFOG_VECTOR_CLONES
Extremes extremes_of(const int32_t* values, size_t count) {
    int32_t least = values[0], most = values[0];
    for (size_t i = 0; i < count; ++i) {
        least = values[i] < least ? values[i] : least;
        most = values[i] > most ? values[i] : most;
    }
    return {least, most};
}

/// How many of at most 2^31 values are `value`.
WAVEFOG_VECTOR_CLONES
size_t count_of(int32_t value, const int32_t* values, size_t count) {
    std::uint32_t found = 0;
    for (size_t i = 0; i < count; ++i) found += values[i] == value ? 1 : 0;
    return found;
}

/// What a tile's values are coded with, but the coder.
struct Measured {
    TileCoding coding;
    int32_t low = 0;
    std::vector<int32_t> table;  ///< of ranks, else empty
    int64_t range = 0;
    Flatness flatness = Flatness::none;
};

Measured measure(const Tile& tile, const PlaneCoding& plane) {
    Measured measured;
    TileCoding& coding = measured.coding;
    const Extremes extremes = extremes_of(tile.values.data(), tile.values.size());
    coding.levels = plane.levels;
    coding.bounds = plane.bounds;
    coding.low = measured.low = extremes.least;
    coding.high = extremes.most;
    measured.range = int64_t(coding.high) - coding.low;
    coding.marks_low =
        count_of(coding.low, tile.values.data(), tile.values.size()) > tile.values.size() / 10;
    if (measured.range <= kTableRange)
        measured.flatness = flatness_of(tile, 2 * coding.bounds.finest);
    measured.table = values_apart(tile, coding.low, coding.high, coding.bounds.finest);
    return measured;
}

/// Calls body(t, place, scratch) for every tile. False if stopped.
template <class Body>
bool for_each_place(const PlaneCoding& coding, int threads, const std::stop_token& stop,
                    Body body) {
    return for_each_parallel(coding.tiles(), threads, stop, [&](size_t t, Scratch& scratch) {
        const StandardFloats standard;
        body(t, place_of(t, coding), scratch);
    });
}

/// A tile's streams with what a decoder has to know first.
std::vector<Bytes> with_head(TileCoder coder, const Measured& measured,
                             std::vector<Bytes> streams) {
    const bool packed = !measured.table.empty();
    Writer head;
    head.byte(static_cast<unsigned>(coder) | (measured.coding.marks_low ? kMarksLow : 0u) |
              (packed ? kPacked : 0u));
    head.signed_length(measured.low);
    if (packed)
        write_table(measured.table, head);
    else if (coder != TileCoder::constant)
        head.length(static_cast<std::uint64_t>(measured.range));
    head.append(streams[0]);
    streams[0] = std::move(head.bytes);
    return streams;
}

size_t size_of(const std::vector<Bytes>& streams) {
    return std::accumulate(streams.begin(), streams.end(), size_t(0),
                           [](size_t sum, const Bytes& each) { return sum + each.size(); });
}

/// Of the values or their ranks.
TileCoding coding_of(const Measured& measured) {
    TileCoding coding = measured.coding;
    if (!measured.table.empty()) use_ranks(measured.table, coding);
    return coding;
}

/// `tile` is of no use afterwards.
std::vector<Bytes> encode_by(TileCoder coder, const Measured& measured, Tile& tile,
                             Scratch& scratch) {
    const TileCoding coding = coding_of(measured);
    if (!measured.table.empty()) to_ranks(measured.table, tile);
    switch (coder) {
        case TileCoder::tables:
            return with_head(coder, measured, encode_tables(tile, coding, scratch));
        case TileCoder::runs:
            return with_head(coder, measured, encode_runs(tile, coding, scratch));
        case TileCoder::plain:
            return with_head(coder, measured, encode_plain(tile, coding));
        default:
            return with_head(coder, measured, encode_mixing(tile, coding));
    }
}

/// A way to code a tile.
struct Way {
    TileCoder coder;
    const Measured* measured;
};

std::vector<Bytes> encode_tile(const Place& place, const TileSource& source,
                               const PlaneCoding& plane, bool best, Scratch& scratch) {
    Tile tile(place.width, place.height, scratch);
    source(place, tile);
    Measured measured = measure(tile, plane);
    const int64_t range = measured.range, bound = measured.coding.bounds.finest;
    if (range <= bound) {
        measured.low = static_cast<int32_t>(measured.low + range / 2);
        return with_head(TileCoder::constant, measured,
                         std::vector<Bytes>(size_t(plane.levels) + 1));
    }
    // Few values may take fewer bits exactly than a slope within bounds.
    Measured exact = measured;
    if (measured.table.empty() && bound > 0)
        exact.table = values_apart(tile, measured.coding.low, measured.coding.high, 0);
    // The tables of a small tile weigh more, and it takes no time either way.
    const bool fits = range <= kTableRange && bound <= kTableRange;
    const bool quick = !best && tile.values.size() >= kSmallTile && fits;
    std::vector<Way> ways;
    if (exact.flatness != Flatness::none) ways.push_back({TileCoder::runs, &exact});
    if (!quick || exact.flatness != Flatness::edges) {
        const bool two = measured.table.empty() && !exact.table.empty();
        for (const Measured* each : {&measured, two ? &exact : nullptr}) {
            if (each == nullptr) continue;
            if (fits) ways.push_back({TileCoder::tables, each});
            if (!quick) ways.push_back({TileCoder::mixing, each});
        }
    }
    std::vector<Bytes> smallest;
    const Scratch::Mark before = scratch.mark();
    const auto attempt = [&](TileCoder coder, const Measured& by) {
        scratch.release(before);
        if (!smallest.empty()) source(place, tile);
        std::vector<Bytes> streams = encode_by(coder, by, tile, scratch);
        if (smallest.empty() || size_of(streams) < size_of(smallest)) smallest = std::move(streams);
    };
    for (const Way& way : ways) attempt(way.coder, *way.measured);
    if (plain_size(tile, coding_of(exact)) + exact.table.size() < size_of(smallest))
        attempt(TileCoder::plain, exact);
    return smallest;
}

bool decode_tile(std::vector<View> streams, const PlaneCoding& plane, Tile& tile,
                 Scratch& scratch) {
    Reader head(streams[0]);
    const unsigned flags = head.byte();
    if (flags > (kPacked | kMarksLow | kCoders)) return false;
    TileCoding coding;
    coding.levels = plane.levels;
    coding.bounds = plane.bounds;
    coding.marks_low = (flags & kMarksLow) != 0;
    const int64_t low = head.signed_length();
    if (head.failed() || low < kSmallest || low > kLargest) return false;
    coding.low = static_cast<int32_t>(low);
    const auto coder = static_cast<TileCoder>(flags & kCoders);
    if (coder == TileCoder::constant) {
        std::fill(tile.values.begin(), tile.values.end(), coding.low);
        return std::all_of(streams.begin() + 1, streams.end(),
                           [](View each) { return each.empty(); }) &&
               head.left() == 0;
    }
    std::vector<int32_t> table;
    if (flags & kPacked) {
        if (!read_table(head, coding.low, table)) return false;
        use_ranks(table, coding);
    } else {
        const std::uint64_t range = head.length();
        if (head.failed() || range > static_cast<std::uint64_t>(kLargest - low)) return false;
        coding.high = static_cast<int32_t>(low + static_cast<int64_t>(range));
    }
    streams[0] = head.take(head.left());
    if (coder == TileCoder::tables) {
        if (!decode_tables(tile, coding, streams, scratch)) return false;
    } else {
        if (coder == TileCoder::mixing) {
            decode_mixing(tile, coding, streams);
        } else if (coder == TileCoder::runs) {
            if (int64_t(coding.high) - coding.low > kTableRange) return false;
            decode_runs(tile, coding, streams, scratch);
        } else if (coder != TileCoder::plain || !decode_plain(tile, coding, streams)) {
            return false;
        }
        interpolate_levels(tile, plane.levels, static_cast<int>(streams.size()) - 1);
    }
    if (flags & kPacked) from_ranks(table, tile);
    return true;
}

}  // namespace

int default_stream_levels(int width, int height, int tile_bits) {
    int levels = 0;
    while (levels < tile_bits && (std::max(width, height) >> (levels + 1)) >= 16) ++levels;
    return levels;
}

PlaneResult encode_plane(const PlaneCoding& coding, bool best, int threads,
                         const std::stop_token& stop, const TileSource& source,
                         const TileSink& check, PlaneStreams& streams) {
    streams.assign(size_t(coding.levels) + 1, std::vector<Bytes>(coding.tiles()));
    std::atomic<bool> damaged = false;
    const bool done =
        for_each_place(coding, threads, stop, [&](size_t t, const Place& place, Scratch& scratch) {
            scratch.clear();
            std::vector<Bytes> coded = encode_tile(place, source, coding, best, scratch);
            scratch.clear();
            Tile decoded(place.width, place.height, scratch);
            if (!decode_tile({coded.begin(), coded.end()}, coding, decoded, scratch) ||
                !check(t, place, decoded))
                damaged = true;
            for (size_t level = 0; level < coded.size(); ++level)
                streams[level][t] = std::move(coded[level]);
        });
    return damaged ? PlaneResult::damaged : done ? PlaneResult::done : PlaneResult::stopped;
}

bool heed_bounds(const std::vector<Bytes>& first_level) {
    return std::any_of(first_level.begin(), first_level.end(), [](const Bytes& tile) {
        const auto coder = static_cast<TileCoder>(tile[0] & kCoders);
        return (coder == TileCoder::mixing || coder == TileCoder::tables) &&
               (tile[0] & kPacked) == 0;
    });
}

PlaneResult decode_plane(const PlaneViews& streams, const PlaneCoding& coding, int threads,
                         const std::stop_token& stop, const TileSink& sink) {
    std::atomic<bool> damaged = false;
    const bool done =
        for_each_place(coding, threads, stop, [&](size_t t, const Place& place, Scratch& scratch) {
            if (damaged) return;
            scratch.clear();
            Tile tile(place.width, place.height, scratch);
            std::vector<View> own;
            for (const std::vector<View>& level : streams) own.push_back(level[t]);
            if (!decode_tile(std::move(own), coding, tile, scratch) || !sink(t, place, tile))
                damaged = true;
        });
    return damaged ? PlaneResult::damaged : done ? PlaneResult::done : PlaneResult::stopped;
}

std::optional<double> squared_error_of(const PlaneCoding& coding, Strips strips, int threads,
                                       const std::stop_token& stop, const TileSource& source) {
    constexpr int kRows = 32, kEvery = 4 * kRows;
    const int begin = strips == Strips::first ? 0 : 2 * kRows;
    std::vector<double> sums(coding.tiles()), pixels(coding.tiles());
    std::atomic<bool> too_wide = coding.bounds.finest > kTableRange;
    const bool done =
        for_each_place(coding, threads, stop, [&](size_t t, const Place& place, Scratch& scratch) {
            const bool all = place.height < 2 * kEvery;
            const int rows = all ? place.height : kRows;
            for (int y = all ? 0 : begin; y + rows <= place.height && !too_wide;
                 y += all ? rows : kEvery) {
                scratch.clear();
                Tile strip(place.width, rows, scratch);
                source({place.x, place.y + y, place.width, rows}, strip);
                const Measured measured = measure(strip, coding);
                if (measured.range > kTableRange) too_wide = true;
                pixels[t] += double(strip.values.size());
                if (too_wide || measured.range == 0 || !measured.table.empty() ||
                    measured.flatness == Flatness::edges)
                    continue;
                sums[t] += squared_errors(strip, measured.coding, scratch);
            }
        });
    if (!done || too_wide) return {};
    return std::accumulate(sums.begin(), sums.end(), 0.0) /
           std::accumulate(pixels.begin(), pixels.end(), 0.0);
}

}  // namespace wavefog::wfog
