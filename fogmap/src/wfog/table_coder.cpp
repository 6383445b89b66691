#include "table_coder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "token_stream.h"

namespace wavefog::wfog {

namespace {

using std::int32_t;
using std::int64_t;
using std::int8_t;
using std::size_t;
using std::uint8_t;

/// A grid of floats with a margin of 2 on all sides.
class Plane {
  public:
    static constexpr int kMargin = 2;

    Plane() = default;
    Plane(int w, int h)
        : width(w),
          height(h),
          stride_(size_t(w) + 2 * kMargin),
          values_(stride_ * (size_t(h) + 2 * kMargin)) {}
    float* row(int j) { return values_.data() + size_t(j + kMargin) * stride_ + kMargin; }
    const float* row(int j) const { return const_cast<Plane*>(this)->row(j); }

    /// Fills the margin with the nearest values inside; of an empty plane, with those of `other`.
    void extend(const Plane& other) {
        for (int j = -kMargin; j < height + kMargin; ++j) {
            const bool empty = width == 0 || height == 0;
            const float* from = empty ? other.row(std::clamp(j, 0, other.height - 1))
                                      : row(std::clamp(j, 0, height - 1));
            const int last = (empty ? other.width : width) - 1;
            float* to = row(j);
            if (from != to)
                for (int i = 0; i < width; ++i) to[i] = from[std::min(i, last)];
            for (int i = -kMargin; i < 0; ++i) to[i] = from[0];
            for (int i = width; i < width + kMargin; ++i) to[i] = from[std::min(i, last)];
        }
    }

    int width = 0, height = 0;

  private:
    size_t stride_ = 0;
    std::vector<float> values_;
};

/// A level's grid by the parity of its coordinates; `coarse` is the grid of the level before.
struct Parts {
    Plane coarse;      ///< x even, y even
    Plane centres;     ///< x odd, y odd
    Plane horizontal;  ///< x odd, y even
    Plane vertical;    ///< x even, y odd
};

/// Weights of a level's predictors, in 64ths.
struct Weights {
    int8_t centre = 8;  ///< how far beyond the inner mean, seen from the outer one
    std::array<int8_t, 2> along = {32, 32};  ///< of the pair along x, for horizontal and vertical
    std::array<int8_t, 2> beyond = {8, 8};
};

/// What is known around a row of pixels: the inner pairs and the outer ring of eight.
struct Row {
    // The pair along x, the pair along y (centres: the two diagonals), and the ring.
    const float *a0, *a1, *b0, *b1;
    std::array<const float*, 8> ring;
};

Row centre_row(const Plane& p, int j) {
    const float *up = p.row(j - 1), *n = p.row(j), *s = p.row(j + 1), *down = p.row(j + 2);
    return {n, s + 1, n + 1, s, {n - 1, n + 2, s - 1, s + 2, up, up + 1, down, down + 1}};
}
Row horizontal_row(const Plane& p, const Plane& c, int j) {
    const float *n = c.row(j - 1), *s = c.row(j), *up = p.row(j - 1), *down = p.row(j + 1);
    return {p.row(j), p.row(j) + 1, n, s, {n - 1, n + 1, s - 1, s + 1, up, up + 1, down, down + 1}};
}
Row vertical_row(const Plane& p, const Plane& c, int j) {
    const float *n = p.row(j), *s = p.row(j + 1), *w = c.row(j) - 1, *up = c.row(j - 1) - 1,
                *down = c.row(j + 1) - 1;
    return {w, w + 1, n, s, {n - 1, n + 1, s - 1, s + 1, up, up + 1, down, down + 1}};
}

struct Mixture {
    float a = 0.5f, beyond = 0;
};

Mixture mixture_of(const Weights& weights, int part) {
    if (part == 0) return {0.5f, float(weights.centre) / 64};
    return {float(weights.along[size_t(part) - 1]) / 64,
            float(weights.beyond[size_t(part) - 1]) / 64};
}

/// Predictions and contexts of a row. `before`: magnitudes of the row above in the same part.
void predict(const Row& row, const Mixture& mix, float inverse_step, float most,
             const float* before, int width, float* predicted, uint8_t* contexts) {
    const float a = mix.a, b = 1 - mix.a, t = mix.beyond;
    for (int i = 0; i < width; ++i) {
        const float x = row.a0[i] + row.a1[i], y = row.b0[i] + row.b1[i];
        const float ring = ((row.ring[0][i] + row.ring[1][i]) + (row.ring[2][i] + row.ring[3][i])) +
                           ((row.ring[4][i] + row.ring[5][i]) + (row.ring[6][i] + row.ring[7][i]));
        const float trend = (x + y) * 0.25f - ring * 0.125f;
        float p = x * 0.5f * a + y * 0.5f * b + trend * t;
        p = p < 0 ? 0.0f : p;
        p = p > most ? most : p;
        predicted[i] = static_cast<float>(static_cast<int32_t>(p + 0.5f));
        const float spread = std::fabs(row.a0[i] - row.a1[i]) + std::fabs(row.b0[i] - row.b1[i]) +
                             std::fabs(x - y) * 0.5f + std::fabs(trend) * 2.0f;
        const float activity =
            spread * inverse_step + (before[i - 1] + before[i] * 2.0f + before[i + 1]) * 0.5f;
        // Two classes an octave, from the exponent and the first bit of the mantissa.
        const int32_t c = (std::bit_cast<int32_t>(activity + 0.25f) >> 22) - (0x3e800000 >> 22);
        contexts[i] =
            static_cast<uint8_t>(c > int32_t(kTokenContexts) - 1 ? int32_t(kTokenContexts) - 1 : c);
    }
}

/// The quotients of a row, and what a decoder will see in place of its values.
void quantise(const float* predicted, int width, float step, float inverse_step, float most,
              float* values, int32_t* quotients) {
    for (int i = 0; i < width; ++i) {
        const float d = (values[i] - predicted[i]) * inverse_step;
        const auto q = static_cast<int32_t>(d + (d < 0 ? -0.5f : 0.5f));
        quotients[i] = q;
        float v = predicted[i] + static_cast<float>(q) * step;
        v = v < 0 ? 0.0f : v;
        values[i] = v > most ? most : v;
    }
}

void restore(const float* predicted, const int32_t* quotients, int width, float step, float most,
             float* values) {
    for (int i = 0; i < width; ++i) {
        float v = predicted[i] + static_cast<float>(quotients[i]) * step;
        v = v < 0 ? 0.0f : v;
        values[i] = v > most ? most : v;
    }
}

void remember(const int32_t* quotients, int width, float* before) {
    for (int i = 0; i < width; ++i) before[i] = static_cast<float>(std::abs(quotients[i]));
    before[-1] = before[0];
    before[width] = before[width - 1];
}

Parts split(const Plane& grid) {
    const int w = grid.width, h = grid.height;
    Parts parts{Plane((w + 1) / 2, (h + 1) / 2), Plane(w / 2, h / 2), Plane(w / 2, (h + 1) / 2),
                Plane((w + 1) / 2, h / 2)};
    for (int j = 0; j < h; ++j) {
        const float* from = grid.row(j);
        float* even = (j % 2 ? parts.vertical : parts.coarse).row(j / 2);
        float* odd = (j % 2 ? parts.centres : parts.horizontal).row(j / 2);
        for (int i = 0; i < w / 2; ++i) {
            even[i] = from[2 * i];
            odd[i] = from[2 * i + 1];
        }
        if (w % 2) even[w / 2] = from[w - 1];
    }
    return parts;
}

void merge(const Parts& parts, Plane& grid) {
    const int w = grid.width;
    for (int j = 0; j < grid.height; ++j) {
        float* to = grid.row(j);
        const float* even = (j % 2 ? parts.vertical : parts.coarse).row(j / 2);
        const float* odd = (j % 2 ? parts.centres : parts.horizontal).row(j / 2);
        for (int i = 0; i < w / 2; ++i) {
            to[2 * i] = even[i];
            to[2 * i + 1] = odd[i];
        }
        if (w % 2) to[w - 1] = even[w / 2];
    }
}

/// Least squares on the original values; every fourth row will do.
Weights fit(Parts& parts) {
    Weights weights;
    const auto quantised = [](double x) {
        return static_cast<int8_t>(std::clamp(std::lround(x * 64), -64l, 127l));
    };
    parts.coarse.extend(parts.coarse);
    parts.centres.extend(parts.coarse);
    const auto skip = [](int height) { return height > 64 ? 4 : 1; };
    double tt = 0, td = 0;
    for (int j = 0; j < parts.centres.height; j += skip(parts.centres.height)) {
        const Row r = centre_row(parts.coarse, j);
        const float* truth = parts.centres.row(j);
        float row_tt = 0, row_td = 0;
        for (int i = 0; i < parts.centres.width; ++i) {
            const float mean = (r.a0[i] + r.a1[i] + r.b0[i] + r.b1[i]) * 0.25f;
            float ring = 0;
            for (const float* each : r.ring) ring += each[i];
            const float t = mean - ring * 0.125f;
            row_tt += t * t;
            row_td += t * (truth[i] - mean);
        }
        tt += double(row_tt);
        td += double(row_td);
    }
    if (tt > 0) weights.centre = quantised(td / tt);
    for (const int part : {1, 2}) {
        const Plane& plane = part == 1 ? parts.horizontal : parts.vertical;
        // truth - y = a (x - y) + t trend
        double uu = 0, ut = 0, ud = 0, td2 = 0, tt2 = 0;
        for (int j = 0; j < plane.height; j += skip(plane.height)) {
            const Row r = part == 1 ? horizontal_row(parts.coarse, parts.centres, j)
                                    : vertical_row(parts.coarse, parts.centres, j);
            const float* truth = plane.row(j);
            float sums[5] = {0, 0, 0, 0, 0};
            for (int i = 0; i < plane.width; ++i) {
                const float x = (r.a0[i] + r.a1[i]) * 0.5f, y = (r.b0[i] + r.b1[i]) * 0.5f;
                float ring = 0;
                for (const float* each : r.ring) ring += each[i];
                const float u = x - y, t = (x + y) * 0.5f - ring * 0.125f, d = truth[i] - y;
                sums[0] += u * u;
                sums[1] += u * t;
                sums[2] += u * d;
                sums[3] += t * t;
                sums[4] += t * d;
            }
            uu += double(sums[0]);
            ut += double(sums[1]);
            ud += double(sums[2]);
            tt2 += double(sums[3]);
            td2 += double(sums[4]);
        }
        const double determinant = uu * tt2 - ut * ut;
        if (determinant > 1e-6 * uu * tt2 && determinant > 0) {
            weights.along[size_t(part) - 1] = quantised((ud * tt2 - td2 * ut) / determinant);
            weights.beyond[size_t(part) - 1] = quantised((td2 * uu - ud * ut) / determinant);
        }
    }
    return weights;
}

/// What encoder and decoder share: the walk over the rows of a level. `code(part, j, width,
/// predicted, contexts, quotients)` turns the values of a row into those that a decoder sees.
template <class Code>
void for_each_row(Parts& parts, const Weights& weights, float step, float most, Code code) {
    const float inverse = 1 / step;
    const int widest = parts.coarse.width + 1;
    std::vector<float> predicted(size_t(widest), 0.0f), magnitudes(size_t(widest) + 2);
    std::vector<uint8_t> contexts(size_t(widest), uint8_t(0));
    std::vector<int32_t> quotients(size_t(widest), 0);
    parts.coarse.extend(parts.coarse);
    for (int part = 0; part < 3; ++part) {
        if (part == 1) parts.centres.extend(parts.coarse);
        Plane& plane = part == 0 ? parts.centres : part == 1 ? parts.horizontal : parts.vertical;
        if (plane.width == 0) continue;
        std::fill(magnitudes.begin(), magnitudes.end(), 0.0f);
        float* const before = magnitudes.data() + 1;
        const Mixture mix = mixture_of(weights, part);
        for (int j = 0; j < plane.height; ++j) {
            const Row row = part == 0   ? centre_row(parts.coarse, j)
                            : part == 1 ? horizontal_row(parts.coarse, parts.centres, j)
                                        : vertical_row(parts.coarse, parts.centres, j);
            predict(row, mix, inverse, most, before, plane.width, predicted.data(),
                    contexts.data());
            code(plane.row(j), plane.width, predicted.data(), contexts.data(), quotients.data());
            remember(quotients.data(), plane.width, before);
        }
    }
}

/// The coarsest grid: each pixel from its western or northern neighbour. `code(value, predicted,
/// context)` returns what a decoder sees.
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

Plane coarsest_grid(const Tile& tile, int levels) {
    const int h = 1 << levels;
    return Plane((tile.width - 1) / h + 1, (tile.height - 1) / h + 1);
}

void interpolate(Parts& parts) {
    const Weights plain{0, {32, 32}, {0, 0}};
    for_each_row(parts, plain, 1, 1e9f,
                 [](float* values, int width, const float* predicted, const uint8_t*, int32_t* q) {
                     std::copy_n(predicted, width, values);
                     std::fill_n(q, width, 0);
                 });
}

}  // namespace

std::vector<Bytes> encode_tables(Tile& tile, const TileCoding& coding) {
    const auto most = static_cast<float>(int64_t(coding.high) - coding.low);
    Plane whole(tile.width, tile.height);
    for (int j = 0; j < tile.height; ++j)
        for (int i = 0; i < tile.width; ++i)
            whole.row(j)[i] = static_cast<float>(tile.values[tile.index(i, j)] - coding.low);
    std::vector<Parts> levels(size_t(coding.levels));
    for (size_t l = levels.size(); l-- > 0;) {
        levels[l] = split(whole);
        whole = levels[l].coarse;
    }

    std::vector<Bytes> streams;
    Symbols symbols;
    const auto step_of = [&](size_t level) {
        return static_cast<float>(2 * coding.bounds.at(static_cast<int>(level)) + 1);
    };
    float step = step_of(0);
    for_each_coarsest(whole, most, [&](float& value, float predicted) {
        int32_t q;
        quantise(&predicted, 1, step, 1 / step, most, &value, &q);
        symbols.values.push_back(q);
        symbols.contexts.push_back(0);
    });
    streams.push_back(write_symbols(symbols));
    for (size_t l = 0; l < levels.size(); ++l) {
        Parts& parts = levels[l];
        step = step_of(l + 1);
        const Weights weights = fit(parts);
        parts.coarse = std::move(whole);
        symbols.values.clear();
        symbols.contexts.clear();
        for_each_row(parts, weights, step, most,
                     [&](float* values, int width, const float* predicted, const uint8_t* contexts,
                         int32_t* quotients) {
                         quantise(predicted, width, step, 1 / step, most, values, quotients);
                         symbols.values.insert(symbols.values.end(), quotients, quotients + width);
                         symbols.contexts.insert(symbols.contexts.end(), contexts,
                                                 contexts + width);
                     });
        Writer stream;
        for (const int8_t w : {weights.centre, weights.along[0], weights.along[1],
                               weights.beyond[0], weights.beyond[1]})
            stream.byte(static_cast<uint8_t>(w));
        stream.append(write_symbols(symbols));
        streams.push_back(std::move(stream.bytes));
        whole = Plane(parts.coarse.width + parts.horizontal.width,
                      parts.coarse.height + parts.vertical.height);
        merge(parts, whole);
    }
    for (int j = 0; j < tile.height; ++j)
        for (int i = 0; i < tile.width; ++i)
            tile.values[tile.index(i, j)] = static_cast<int32_t>(whole.row(j)[i]) + coding.low;
    return streams;
}

bool decode_tables(Tile& tile, const TileCoding& coding, std::span<const View> streams) {
    const int64_t range = int64_t(coding.high) - coding.low;
    if (range > kTableRange || coding.bounds.finest > kTableRange) return false;
    const auto most = static_cast<float>(range);
    const auto step_of = [&](int level) {
        return static_cast<float>(2 * coding.bounds.at(level) + 1);
    };
    Plane grid = coarsest_grid(tile, coding.levels);
    {
        SymbolReader reader(streams[0], size_t(grid.width) * size_t(grid.height));
        for_each_coarsest(grid, most, [&](float& value, float predicted) {
            constexpr uint8_t context = 0;
            int32_t q = 0;
            reader.read(&context, 1, &q);
            restore(&predicted, &q, 1, step_of(0), most, &value);
        });
        if (reader.failed()) return false;
    }
    for (int l = 0; l < coding.levels; ++l) {
        const int h = 1 << (coding.levels - l - 1);
        Plane finer((tile.width - 1) / h + 1, (tile.height - 1) / h + 1);
        const int w = finer.width, v = finer.height;
        Parts parts{std::move(grid), Plane(w / 2, v / 2), Plane(w / 2, (v + 1) / 2),
                    Plane((w + 1) / 2, v / 2)};
        if (size_t(l) + 1 < streams.size()) {
            Reader head(streams[size_t(l) + 1]);
            Weights weights;
            for (int8_t* w8 : {&weights.centre, &weights.along[0], &weights.along[1],
                               &weights.beyond[0], &weights.beyond[1]})
                *w8 = static_cast<int8_t>(head.byte());
            if (head.failed()) return false;
            const float step = step_of(l + 1);
            const size_t count =
                size_t(w) * size_t(v) - size_t(parts.coarse.width) * size_t(parts.coarse.height);
            SymbolReader reader(head.take(head.left()), count);
            if (reader.failed()) return false;
            for_each_row(parts, weights, step, most,
                         [&](float* values, int width, const float* predicted,
                             const uint8_t* contexts, int32_t* quotients) {
                             reader.read(contexts, size_t(width), quotients);
                             restore(predicted, quotients, width, step, most, values);
                         });
            if (reader.failed()) return false;
        } else {
            interpolate(parts);
        }
        merge(parts, finer);
        grid = std::move(finer);
    }
    for (int j = 0; j < tile.height; ++j)
        for (int i = 0; i < tile.width; ++i)
            tile.values[tile.index(i, j)] = static_cast<int32_t>(grid.row(j)[i]) + coding.low;
    return true;
}

}  // namespace wavefog::wfog
