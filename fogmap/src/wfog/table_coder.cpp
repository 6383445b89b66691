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
                  Scratch& scratch, ContextsOf contexts_of, Code code) {
    const size_t widest = size_t(parts.coarse.width) + 1;
    const std::span<float> predicted = scratch.take<float>(widest);
    const std::span<float> magnitudes = scratch.take<float>(widest + 2);
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

/// Symbols of a level as they come.
struct Symbols {
    int32_t* values;
    uint8_t* contexts;
    size_t count = 0;

    int32_t* next_values() { return values + count; }
    uint8_t* next_contexts() { return contexts + count; }
    void append_to(Bytes& stream, Scratch& scratch) const {
        write_symbols({values, count}, {contexts, count}, scratch, stream);
    }
};

/// What to do with each level of a tile: its grid at first, then the parts of each further level,
/// whose `coarse` is what a decoder has; both leave there what it will have. `roughly`: with
/// weights from a few rows.
template <class First, class Next>
void for_each_level(const Tile& tile, const TileCoding& coding, bool roughly, Scratch& scratch,
                    First first, Next next) {
    // Weights come from the true pixels, those of the level before included.
    std::vector<Parts> levels(size_t(coding.levels));
    for (size_t l = levels.size(); l-- > 0;)
        levels[l] = l + 1 < levels.size() ? split(levels[l + 1].coarse, scratch)
                                          : split(tile, coding.low, scratch);
    Plane grid = levels.empty() ? plane_of(tile, coding.low, scratch) : levels[0].coarse;
    std::vector<Weights> weights;
    for (Parts& parts : levels) weights.push_back(fit(parts, roughly));
    first(grid);
    for (size_t l = 0; l < levels.size(); ++l) {
        Parts& parts = levels[l];
        parts.coarse = grid;
        next(l, parts, weights[l]);
        if (l + 1 < levels.size()) grid = merge(parts, scratch);
    }
}

Quantiser quantiser_of(const TileCoding& coding, size_t level) {
    return {static_cast<float>(2 * coding.bounds.at(static_cast<int>(level)) + 1),
            static_cast<float>(int64_t(coding.high) - coding.low)};
}

/// Pixels of a level that is missing: the means of those around.
void interpolate(Parts& parts, Scratch& scratch) {
    const Weights plain{0, {32, 32}, {0, 0}};
    std::vector<uint8_t> contexts(size_t(parts.coarse.width) + 1);
    const std::vector<int32_t> zeros(contexts.size());
    for_each_row(
        parts, plain, Quantiser(1, 1e9f), scratch, [&](int) { return contexts.data(); },
        [&](float* values, int width, const float* predicted, const uint8_t*) {
            std::copy_n(predicted, width, values);
            return zeros.data();
        });
}

}  // namespace

std::vector<Bytes> encode_tables(Tile& tile, const TileCoding& coding, Scratch& scratch) {
    std::vector<Bytes> streams;
    // Nobody needs the values any more once they are floats.
    Symbols symbols{tile.values.data(), scratch.take<uint8_t>(tile.values.size()).data()};
    for_each_level(
        tile, coding, false, scratch,
        [&](Plane& grid) {
            const Quantiser quantiser = quantiser_of(coding, 0);
            for_each_coarsest(grid, quantiser.most, [&](float& value, float predicted) {
                quantise(&predicted, 1, quantiser, &value, symbols.next_values());
                *symbols.next_contexts() = 0;
                ++symbols.count;
            });
            symbols.append_to(streams.emplace_back(), scratch);
        },
        [&](size_t level, Parts& parts, Weights& weights) {
            Bytes& stream = streams.emplace_back();
            for (const int8_t* weight : weights.all())
                stream.push_back(static_cast<uint8_t>(*weight));
            symbols.count = 0;
            const Quantiser quantiser = quantiser_of(coding, level + 1);
            for_each_row(
                parts, weights, quantiser, scratch, [&](int) { return symbols.next_contexts(); },
                [&](float* values, int width, const float* predicted, const uint8_t*) {
                    int32_t* const quotients = symbols.next_values();
                    quantise(predicted, width, quantiser, values, quotients);
                    symbols.count += size_t(width);
                    return quotients;
                });
            symbols.append_to(stream, scratch);
        });
    return streams;
}

double squared_errors(const Tile& tile, const TileCoding& coding, Scratch& scratch) {
    double sum = 0;
    const size_t widest = size_t(tile.width) + 1;
    const std::span<float> truth = scratch.take<float>(widest);
    const std::span<int32_t> quotients = scratch.take<int32_t>(widest);
    const std::span<uint8_t> contexts = scratch.take<uint8_t>(widest);
    for_each_level(
        tile, coding, true, scratch,
        [&](Plane& grid) {
            const Quantiser quantiser = quantiser_of(coding, 0);
            for_each_coarsest(grid, quantiser.most, [&](float& value, float predicted) {
                const float before = value;
                quantise(&predicted, 1, quantiser, &value, quotients.data());
                sum += squared_distance(&before, &value, 1);
            });
        },
        [&](size_t level, Parts& parts, const Weights& weights) {
            const Quantiser quantiser = quantiser_of(coding, level + 1);
            for_each_row(
                parts, weights, quantiser, scratch, [&](int) { return contexts.data(); },
                [&](float* values, int width, const float* predicted, const uint8_t*) {
                    std::copy_n(values, width, truth.data());
                    quantise(predicted, width, quantiser, values, quotients.data());
                    sum += squared_distance(truth.data(), values, width);
                    return quotients.data();
                });
        });
    return sum;
}

bool decode_tables(Tile& tile, const TileCoding& coding, std::span<const View> streams,
                   Scratch& scratch) {
    if (int64_t(coding.high) - coding.low > kTableRange || coding.bounds.finest > kTableRange)
        return false;
    Plane grid(multiples(tile.width, coding.levels), multiples(tile.height, coding.levels),
               scratch);
    {
        SymbolReader reader(streams[0], grid.pixels());
        const Quantiser quantiser = quantiser_of(coding, 0);
        for_each_coarsest(grid, quantiser.most, [&](float& value, float predicted) {
            constexpr uint8_t context = 0;
            int32_t q = 0;
            reader.read(&context, 1, &q);
            restore(&predicted, &q, 1, quantiser, &value);
        });
        if (reader.failed()) return false;
    }
    const std::span<uint8_t> contexts = scratch.take<uint8_t>(size_t(tile.width) + 1);
    const std::span<int32_t> quotients = scratch.take<int32_t>(size_t(tile.width) + 1);
    for (int l = 0; l < coding.levels; ++l) {
        const int coarser = coding.levels - l - 1;
        Parts parts(multiples(tile.width, coarser), multiples(tile.height, coarser), scratch);
        parts.coarse = grid;
        if (size_t(l) + 1 < streams.size()) {
            Reader head(streams[size_t(l) + 1]);
            Weights weights;
            for (int8_t* weight : weights.all()) *weight = static_cast<int8_t>(head.byte());
            if (head.failed()) return false;
            SymbolReader reader(head.take(head.left()), parts.pixels());
            if (reader.failed()) return false;
            const Quantiser quantiser = quantiser_of(coding, size_t(l) + 1);
            for_each_row(
                parts, weights, quantiser, scratch, [&](int) { return contexts.data(); },
                [&](float* values, int width, const float* predicted, const uint8_t* of_row) {
                    reader.read(of_row, size_t(width), quotients.data());
                    restore(predicted, quotients.data(), width, quantiser, values);
                    return quotients.data();
                });
            if (reader.failed()) return false;
        } else {
            interpolate(parts, scratch);
        }
        if (coarser == 0)
            merge(parts, coding.low, tile);
        else
            grid = merge(parts, scratch);
    }
    if (coding.levels == 0)
        for (int j = 0; j < tile.height; ++j)
            for (int i = 0; i < tile.width; ++i)
                tile.row(j)[i] = static_cast<int32_t>(grid.row(j)[i]) + coding.low;
    return true;
}

}  // namespace wavefog::wfog
