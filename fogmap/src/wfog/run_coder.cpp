#include "run_coder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdlib>
#include <cstring>

#include "context_mixer.h"
#include "parts.h"
#include "range_coder.h"
#include "row_model.h"
#include "vector_clones.h"

namespace wavefog::wfog {

namespace {

using std::int32_t;
using std::int64_t;
using std::size_t;
using std::uint32_t;
using std::uint64_t;
using std::uint8_t;

/// How many pixels of some rows differ from the one to the west and to the north, and how many of
/// these differences are small.
struct Changes {
    uint32_t to_west = 0, to_north = 0, small = 0;
};

/// Of a row with the one above.
WAVEFOG_VECTOR_CLONES
Changes changes_of(const int32_t* __restrict row, const int32_t* __restrict above, int width,
                   int32_t reach) {
    Changes changes;
    for (int i = 1; i < width; ++i) {
        const int32_t west = std::abs(row[i] - row[i - 1]), north = std::abs(row[i] - above[i]);
        changes.to_west += west != 0 ? 1u : 0u;
        changes.to_north += north != 0 ? 1u : 0u;
        changes.small += (west != 0 ? 1u : 0u) & (west <= reach ? 1u : 0u);
        changes.small += (north != 0 ? 1u : 0u) & (north <= reach ? 1u : 0u);
    }
    return changes;
}

/// Where not all four around a pixel are alike.
WAVEFOG_VECTOR_CLONES
void find_edges(const float* a0, const float* a1, const float* b0, const float* b1, int width,
                uint8_t* __restrict edges) {
    for (int i = 0; i < width; ++i)
        edges[i] =
            ((a0[i] == a1[i] ? 0 : 1) | (b0[i] == b1[i] ? 0 : 1) | (a0[i] == b0[i] ? 0 : 1)) != 0
                ? 1
                : 0;
}

/// Whether a pixel differs from those around it, which are alike.
WAVEFOG_VECTOR_CLONES
bool any_surprise(const float* around, const uint8_t* edges, const float* values, int count) {
    int surprises = 0;
    for (int i = 0; i < count; ++i) surprises |= (values[i] != around[i] ? 1 : 0) & (edges[i] ^ 1);
    return surprises != 0;
}

/// A probability that learns, as the mixer's estimates do.
class Chance {
  public:
    template <class Coder>
    bool code(Coder& coder, bool bit, const MixerTables& tables) {
        const bool is = coder.code(bit ? 1 : 0, std::clamp(estimate_, 1u, 65535u)) != 0;
        const uint32_t rate = tables.paces[seen_].rate;
        const uint32_t flip = is ? 0xffff : 0, rest = estimate_ ^ flip;
        estimate_ = (rest - (rest * rate >> 16)) ^ flip;
        if (seen_ < kMostSeen) ++seen_;
        return is;
    }

  private:
    static constexpr uint32_t kMostSeen = 250;
    uint32_t estimate_ = 32768, seen_ = 0;
};

/// Neighbours that say what a pixel may be: the four around it, those to the west and north in its
/// part, and the two at the corners beside that.
constexpr size_t kNear = 8;
using Near = std::array<float, kNear>;

/// How much those of `same`, a bit each, say for their value.
constexpr std::array<uint8_t, 256> kScores = [] {
    std::array<uint8_t, 256> scores{};
    constexpr std::array<int, kNear> weights = {4, 4, 4, 4, 3, 3, 2, 2};
    for (size_t same = 0; same < scores.size(); ++same)
        for (size_t n = 0; n < kNear; ++n)
            scores[same] = uint8_t(scores[same] + (same >> n & 1 ? weights[n] : 0));
    return scores;
}();
/// Classes of how many of the ring of eight have a value.
constexpr std::array<uint8_t, 9> kRings = {0, 1, 1, 2, 2, 2, 3, 3, 3};

/// Which of eight are `value`, a bit each.
inline uint32_t bits_of(const Near& near, float value) {
    uint32_t bits = 0;
    for (uint32_t n = 0; n < kNear; ++n) bits |= near[n] == value ? 1u << n : 0u;
    return bits;
}

/// Calls body(i) for the `count` bytes that are not 0.
template <class Body>
void for_each_set(const uint8_t* bytes, int count, Body body) {
    int i = 0;
    for (; i + 8 <= count; i += 8) {
        uint64_t eight;
        std::memcpy(&eight, bytes + i, sizeof eight);
        if (eight == 0) continue;
        for (int k = i; k < i + 8; ++k)
            if (bytes[k] != 0) body(k);
    }
    for (; i < count; ++i)
        if (bytes[i] != 0) body(i);
}

template <class Coder>
class Model {
  public:
    Model(const TileCoding& coding, int widest, Scratch& scratch)
        : most_(static_cast<uint32_t>(int64_t(coding.high) - coding.low)),
          edges_(scratch.take<uint8_t>(size_t(widest))),
          nothing_(scratch.take<float>(size_t(widest) + 2)) {
        std::fill(nothing_.begin(), nothing_.end(), kNone);
    }

    void coarsest(Plane& grid, Coder& coder) {
        coder_ = &coder;
        const float* const none = nothing_.data() + 1;
        const Row row{none, none, none, none, {none, none, none, none, none, none, none, none}};
        for (int j = 0; j < grid.height; ++j)
            for (int i = 0; i < grid.width; ++i) pixel(row, grid, i, j, 0);
    }

    void level(Parts& parts, Coder& coder) {
        coder_ = &coder;
        parts.coarse.extend(parts.coarse);
        for (int part = 0; part < 3; ++part) {
            if (part == 1) parts.centres.extend(parts.coarse);
            Plane& plane = part == 0   ? parts.centres
                           : part == 1 ? parts.horizontal
                                       : parts.vertical;
            if (plane.width == 0) continue;
            for (int j = 0; j < plane.height; ++j)
                row(row_of(parts, part, j), plane, j, part == 0 ? 1u : 2u);
        }
    }

  private:
    static constexpr float kNone = -1;
    static constexpr int kSegment = 64;

    void row(const Row& around, Plane& plane, int j, uint32_t pass) {
        float* const values = plane.row(j);
        find_edges(around.a0, around.a1, around.b0, around.b1, plane.width, edges_.data());
        for (int begin = 0; begin < plane.width; begin += kSegment) {
            const int end = std::min(begin + kSegment, plane.width);
            const uint8_t* const edges = edges_.data() + begin;
            bool surprises = false;
            if constexpr (Coder::kEncodes)
                surprises = any_surprise(around.a0 + begin, edges, values + begin, end - begin);
            surprises = surprising_.code(*coder_, surprises, tables_);
            if constexpr (!Coder::kEncodes)
                std::copy(around.a0 + begin, around.a0 + end, values + begin);
            if (surprises) {
                for (int i = begin; i < end; ++i) pixel(around, plane, i, j, pass);
                continue;
            }
            for_each_set(edges, end - begin,
                         [&](int k) { pixel(around, plane, begin + k, j, pass); });
        }
    }

    struct Candidate {
        float value;
        uint32_t same, score;
    };

    void pixel(const Row& row, Plane& plane, int i, int j, uint32_t pass) {
        float& value = plane.row(j)[i];
        const bool west = i > 0, north = j > 0, east = i + 1 < plane.width;
        const float* const above = north ? plane.row(j - 1) + i : nullptr;
        const Near near = {row.a0[i],
                           row.a1[i],
                           row.b0[i],
                           row.b1[i],
                           west ? plane.row(j)[i - 1] : kNone,
                           north ? above[0] : kNone,
                           west && north ? above[-1] : kNone,
                           east && north ? above[1] : kNone};
        Near ring;
        for (size_t n = 0; n < kNear; ++n) ring[n] = row.ring[n][i];
        std::array<Candidate, kNear> candidates;
        size_t count = 0;
        uint32_t left = 0xffu & ~bits_of(near, kNone);
        while (left != 0) {
            const float v = near[size_t(std::countr_zero(left))];
            const uint32_t same = bits_of(near, v);
            uint32_t around = 0;
            for (const float far : ring) around += far == v ? 1u : 0u;
            left &= ~same;
            const Candidate candidate{v, same | uint32_t(kRings[around]) << 8,
                                      kScores[same] + around};
            size_t k = count++;
            for (; k > 0 && candidates[k - 1].score < candidate.score; --k)
                candidates[k] = candidates[k - 1];
            candidates[k] = candidate;
        }
        for (size_t k = 0; k < count; ++k) {
            const auto order = static_cast<uint32_t>(std::min<size_t>(k, 2));
            if (chances_[(pass * 3 + order) * 1024 + candidates[k].same].code(
                    *coder_, value == candidates[k].value, tables_)) {
                value = candidates[k].value;
                return;
            }
        }
        const auto truth = Coder::kEncodes ? static_cast<uint32_t>(value) : 0u;
        uint32_t decoded = 0;
        for (int bit = int(std::bit_width(most_)) - 1; bit >= 0; --bit)
            decoded = 2 * decoded + uint32_t(coder_->code(int(truth >> bit & 1), 32768));
        value = static_cast<float>(std::min(decoded, most_));
    }

    const MixerTables& tables_ = mixer_tables();
    const uint32_t most_;
    std::span<uint8_t> edges_;  ///< of a row
    std::span<float> nothing_;  ///< a row that is not there
    Chance surprising_;
    std::vector<Chance> chances_ = std::vector<Chance>(9 * 1024);
    Coder* coder_ = nullptr;
};

}  // namespace

Flatness flatness_of(const Tile& tile, int64_t reach) {
    constexpr int kEvery = 8;
    constexpr uint32_t kFew = 12, kEnough = 4096;  // one pixel in so many; pixels to judge by
    const auto within = static_cast<int32_t>(std::min<int64_t>(reach, 1 << 30));
    uint32_t pixels = 0;
    Changes all;
    for (int j = std::min(kEvery / 2, tile.height - 1); j < tile.height; j += kEvery) {
        const Changes here =
            changes_of(tile.row(j), tile.row(std::max(j - 1, 0)), tile.width, within);
        all.to_west += here.to_west;
        all.to_north += here.to_north;
        all.small += here.small;
        pixels += static_cast<uint32_t>(tile.width);
        if (pixels >= kEnough && std::min(all.to_west, all.to_north) > 2 * pixels / kFew)
            return Flatness::none;
    }
    if (std::min(all.to_west, all.to_north) > pixels / kFew) return Flatness::none;
    return all.small > (all.to_west + all.to_north) / 8 ? Flatness::slopes : Flatness::edges;
}

std::vector<Bytes> encode_runs(const Tile& tile, const TileCoding& coding, Scratch& scratch) {
    std::vector<Parts> parts(static_cast<size_t>(coding.levels));
    for (size_t l = parts.size(); l-- > 0;)
        parts[l] = l + 1 < parts.size() ? split(parts[l + 1].coarse, scratch)
                                        : split(tile, coding.low, scratch);
    Plane grid = parts.empty() ? plane_of(tile, coding.low, scratch) : parts[0].coarse;
    Model<RangeEncoder> model(coding, tile.width, scratch);
    std::vector<Bytes> streams;
    RangeEncoder first;
    model.coarsest(grid, first);
    streams.push_back(first.finish());
    for (Parts& level : parts) {
        RangeEncoder coder;
        model.level(level, coder);
        streams.push_back(coder.finish());
    }
    return streams;
}

void decode_runs(Tile& tile, const TileCoding& coding, std::span<const View> streams,
                 Scratch& scratch) {
    Model<RangeDecoder> model(coding, tile.width, scratch);
    int coarser = coding.levels;
    Plane grid(multiples(tile.width, coarser), multiples(tile.height, coarser), scratch);
    RangeDecoder first(streams[0]);
    model.coarsest(grid, first);
    for (const View stream : streams.subspan(1)) {
        --coarser;
        Parts parts(multiples(tile.width, coarser), multiples(tile.height, coarser), scratch);
        parts.coarse = grid;
        RangeDecoder coder(stream);
        model.level(parts, coder);
        if (coarser == 0) return merge(parts, coding.low, tile);
        grid = merge(parts, scratch);
    }
    for (int j = 0; j < grid.height; ++j)
        for (int i = 0; i < grid.width; ++i)
            tile.row(j << coarser)[size_t(i) << coarser] =
                static_cast<int32_t>(grid.row(j)[i]) + coding.low;
}

}  // namespace wavefog::wfog
