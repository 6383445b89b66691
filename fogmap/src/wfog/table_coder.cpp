#include "table_coder.h"

#include <algorithm>
#include <cmath>

#include "parts.h"
#include "row_model.h"
#include "token_stream.h"

namespace wavefog::wfog {

namespace {

using std::int32_t;
using std::int64_t;
using std::int8_t;
using std::size_t;
using std::uint8_t;

/// What encoder and decoder share: the walk over the rows of a level. `code(values, width,
/// predicted, contexts)` turns the values of a row into those that a decoder sees and returns
/// its quotients; `contexts_of(width)` says where the contexts of the next row shall stand.
template <class ContextsOf, class Code>
void for_each_row(Parts& parts, const Weights& weights, const Quantiser& quantiser,
                  ContextsOf contexts_of, Code code) {
    const size_t widest = size_t(parts.coarse.width) + 1;
    std::vector<float> predicted(widest), magnitudes(widest + 2);
    parts.coarse.extend(parts.coarse);
    for (int part = 0; part < 3; ++part) {
        if (part == 1) parts.centres.extend(parts.coarse);
        Plane& plane = part == 0 ? parts.centres : part == 1 ? parts.horizontal : parts.vertical;
        if (plane.width == 0) continue;
        std::fill(magnitudes.begin(), magnitudes.end(), 0.0f);
        float* const before = magnitudes.data() + 1;
        const Mixture mix = mixture_of(weights, part);
        for (int j = 0; j < plane.height; ++j) {
            uint8_t* const contexts = contexts_of(plane.width);
            predict(row_of(parts, part, j), mix, quantiser, before, plane.width, predicted.data(),
                    contexts);
            const int32_t* const quotients =
                code(plane.row(j), plane.width, predicted.data(), contexts);
            remember(quotients, plane.width, before);
        }
    }
}

/// The coarsest grid: each pixel from its western or northern neighbour. `code(value, predicted)`
/// turns the value into what a decoder sees.
template <class Code>
void for_each_coarsest(Plane& grid, float most, Code code) {
    for (int j = 0; j < grid.height; ++j)
        for (int i = 0; i < grid.width; ++i) {
            const float predicted = i > 0   ? grid.row(j)[i - 1]
                                    : j > 0 ? grid.row(j - 1)[i]
                                            : std::floor(most / 2);
            code(grid.row(j)[i], predicted);
        }
}

/// How many pixels of a row or column of `count` are multiples of 2^coarser.
int multiples(int count, int coarser) {
    return ((count - 1) >> coarser) + 1;
}

/// The pixels of a tile whose coordinates are multiples of 2^coarser.
Plane grid_of(const Tile& tile, int coarser, int32_t low) {
    Plane grid(multiples(tile.width, coarser), multiples(tile.height, coarser));
    for (int j = 0; j < grid.height; ++j) {
        const int32_t* const from = tile.values.data() + tile.index(0, j << coarser);
        float* const to = grid.row(j);
        for (int i = 0; i < grid.width; ++i) to[i] = static_cast<float>(from[i << coarser] - low);
    }
    return grid;
}

void write_tile(const Plane& grid, int32_t low, Tile& tile) {
    for (int j = 0; j < tile.height; ++j) {
        const float* const from = grid.row(j);
        int32_t* const to = tile.values.data() + tile.index(0, j);
        for (int i = 0; i < tile.width; ++i) to[i] = static_cast<int32_t>(from[i]) + low;
    }
}

/// Symbols of a level as they come.
class Symbols {
  public:
    explicit Symbols(size_t most)
        : values_(std::make_unique_for_overwrite<int32_t[]>(most)),
          contexts_(std::make_unique_for_overwrite<uint8_t[]>(most)) {}
    int32_t* values() { return values_.get() + count_; }
    uint8_t* contexts() { return contexts_.get() + count_; }
    void add(int count) { count_ += size_t(count); }
    void append_to(Bytes& stream) const {
        const Bytes bytes = write_symbols({values_.get(), count_}, {contexts_.get(), count_});
        stream.insert(stream.end(), bytes.begin(), bytes.end());
    }

  private:
    std::unique_ptr<int32_t[]> values_;
    std::unique_ptr<uint8_t[]> contexts_;
    size_t count_ = 0;
};

/// Pixels of a level that is missing: the means of those around.
void interpolate(Parts& parts) {
    const Weights plain{0, {32, 32}, {0, 0}};
    std::vector<uint8_t> contexts(size_t(parts.coarse.width) + 1);
    const std::vector<int32_t> zeros(contexts.size());
    for_each_row(
        parts, plain, Quantiser(1, 1e9f), [&](int) { return contexts.data(); },
        [&](float* values, int width, const float* predicted, const uint8_t*) {
            std::copy_n(predicted, width, values);
            return zeros.data();
        });
}

}  // namespace

std::vector<Bytes> encode_tables(Tile& tile, const TileCoding& coding) {
    const auto most = static_cast<float>(int64_t(coding.high) - coding.low);
    const auto quantiser_of = [&](size_t level) {
        const int64_t bound = coding.bounds.at(static_cast<int>(level));
        return Quantiser(static_cast<float>(2 * bound + 1), most);
    };
    std::vector<Parts> levels(size_t(coding.levels));
    // Their weights come from the true pixels of the level before.
    const Plane whole = grid_of(tile, 0, coding.low);
    for (size_t l = levels.size(); l-- > 0;)
        levels[l] = split(l + 1 < levels.size() ? levels[l + 1].coarse : whole);

    std::vector<Bytes> streams;
    Plane grid = grid_of(tile, coding.levels, coding.low);
    Symbols coarsest(grid.pixels());
    for_each_coarsest(grid, most, [&](float& value, float predicted) {
        quantise(&predicted, 1, quantiser_of(0), &value, coarsest.values());
        *coarsest.contexts() = 0;
        coarsest.add(1);
    });
    coarsest.append_to(streams.emplace_back());
    for (size_t l = 0; l < levels.size(); ++l) {
        Parts& parts = levels[l];
        const Quantiser quantiser = quantiser_of(l + 1);
        Weights weights = fit(parts);
        Bytes& stream = streams.emplace_back();
        for (const int8_t* weight : weights.all()) stream.push_back(static_cast<uint8_t>(*weight));
        parts.coarse = std::move(grid);
        Symbols symbols(parts.pixels());
        for_each_row(
            parts, weights, quantiser, [&](int) { return symbols.contexts(); },
            [&](float* values, int width, const float* predicted, const uint8_t*) {
                int32_t* const quotients = symbols.values();
                quantise(predicted, width, quantiser, values, quotients);
                symbols.add(width);
                return quotients;
            });
        symbols.append_to(stream);
        grid = merge(parts);
        parts = {};
    }
    write_tile(grid, coding.low, tile);
    return streams;
}

bool decode_tables(Tile& tile, const TileCoding& coding, std::span<const View> streams) {
    const int64_t range = int64_t(coding.high) - coding.low;
    if (range > kTableRange || coding.bounds.finest > kTableRange) return false;
    const auto most = static_cast<float>(range);
    const auto quantiser_of = [&](int level) {
        return Quantiser(static_cast<float>(2 * coding.bounds.at(level) + 1), most);
    };
    Plane grid(multiples(tile.width, coding.levels), multiples(tile.height, coding.levels));
    {
        SymbolReader reader(streams[0], grid.pixels());
        for_each_coarsest(grid, most, [&](float& value, float predicted) {
            constexpr uint8_t context = 0;
            int32_t q = 0;
            reader.read(&context, 1, &q);
            restore(&predicted, &q, 1, quantiser_of(0), &value);
        });
        if (reader.failed()) return false;
    }
    std::vector<uint8_t> contexts(size_t(tile.width) + 1);
    std::vector<int32_t> quotients(contexts.size());
    for (int l = 0; l < coding.levels; ++l) {
        const int coarser = coding.levels - l - 1;
        Parts parts(multiples(tile.width, coarser), multiples(tile.height, coarser));
        parts.coarse = std::move(grid);
        if (size_t(l) + 1 < streams.size()) {
            Reader head(streams[size_t(l) + 1]);
            Weights weights;
            for (int8_t* weight : weights.all()) *weight = static_cast<int8_t>(head.byte());
            if (head.failed()) return false;
            SymbolReader reader(head.take(head.left()), parts.pixels());
            if (reader.failed()) return false;
            const Quantiser quantiser = quantiser_of(l + 1);
            for_each_row(
                parts, weights, quantiser, [&](int) { return contexts.data(); },
                [&](float* values, int width, const float* predicted, const uint8_t* of_row) {
                    reader.read(of_row, size_t(width), quotients.data());
                    restore(predicted, quotients.data(), width, quantiser, values);
                    return quotients.data();
                });
            if (reader.failed()) return false;
        } else {
            interpolate(parts);
        }
        grid = merge(parts);
    }
    write_tile(grid, coding.low, tile);
    return true;
}

}  // namespace wavefog::wfog
