#include "mixing_coder.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "context_mixer.h"
#include "least_squares.h"
#include "range_coder.h"

namespace wavefog::wfog {

namespace {

using std::int32_t;
using std::int64_t;
using std::size_t;
using std::uint32_t;

/// Classes of a magnitude: the number of `limits` below it.
template <size_t Size, class... Limits>
constexpr std::array<std::uint8_t, Size> classes(Limits... limits) {
    std::array<std::uint8_t, Size> table{};
    for (size_t i = 0; i < Size; ++i)
        table[i] = static_cast<std::uint8_t>((0 + ... + (static_cast<int>(i) > limits ? 1 : 0)));
    return table;
}
constexpr auto kCoarse =
    classes<256>(0, 1, 2, 3, 4, 6, 8, 11, 15, 20, 28, 40, 56, 80, 112, 160);  // 0..16
constexpr auto kFine = classes<1024>(0, 1, 2, 3, 5, 6, 9, 12, 15, 21, 27, 36, 48, 63, 84, 111, 147,
                                     194, 255, 337, 445, 587);  // 0..22

int coarse(int e) {
    return kCoarse[size_t(std::min(e, 255))];
}
int coarse12(int e) {
    return std::min(coarse(e), 11);
}
int fine(int e) {
    return kFine[size_t(std::min(e, 1023))];
}

/// 0..14, 7 for none: a signed difference by the size of its magnitude.
template <size_t Size>
uint32_t signed_class(double x, const std::array<double, Size>& limits) {
    const double magnitude = std::fabs(x);
    uint32_t c = 0;  // counted to the end: a branch would be a guess
    for (const double limit : limits) c += magnitude >= limit ? 1 : 0;
    return x < 0 ? uint32_t(Size) - c : uint32_t(Size) + c;
}
constexpr std::array<double, 7> kBlendLimits = {0.08, 0.2, 0.4, 0.7, 1.2, 2.2, 5};
constexpr std::array<double, 7> kShapeLimits = {0.1, 0.3, 0.6, 1.2, 2.4, 5, 10};

uint32_t clipped(int value, int most) {
    return static_cast<uint32_t>(std::clamp(value, -most, most) + most);
}

// Kinds of decisions (ContextMixer::kNodes of them).
constexpr int kIsZero = 0, kSign = 1, kUnary = 2, kMostUnary = 18, kBucket = 20, kMostBuckets = 12,
              kLowBits = 32, kIsLow = 39;
constexpr int kCandidates = 4096;  // contexts by value

/// Model and coder of one tile; the same code encodes and decodes, so both always agree.
template <class Coder>
class Model {
  public:
    Model(Tile& tile, const TileCoding& coding)
        : tile_(tile), coding_(coding), quotients_(tile.values.size()) {}

    void level(int level, Coder& coder) {
        coder_ = &coder;
        bound_ = coding_.bounds.at(level);
        step_ = 2 * bound_ + 1;
        inverse_step_ = 1 / static_cast<double>(step_);
        const int h = 1 << (coding_.levels - level);
        if (level == 0) {
            for (int y = 0; y < tile_.height; y += h)
                for (int x = 0; x < tile_.width; x += h) coarsest_pixel(x, y, h);
            return;
        }
        const int depth = std::min(coding_.levels - level, 2);
        for (int pass = 0; pass < 2; ++pass) {
            for (size_t i = 0; i < 16; ++i)
                neighbours_[i] =
                    (std::ptrdiff_t(kNeighbours[size_t(pass)][i].second) * tile_.width +
                     kNeighbours[size_t(pass)][i].first) *
                    h;
            for_each_in_pass(tile_.width, tile_.height, h, pass, [&](int x, int y) {
                const bool inside =
                    x >= 3 * h && y >= 3 * h && x + 3 * h < tile_.width && y + 3 * h < tile_.height;
                if (inside)
                    pixel<true>(x, y, h, pass, depth);
                else
                    pixel<false>(x, y, h, pass, depth);
            });
        }
    }

  private:
    using Inputs = LeastSquares::Inputs;

    int code(int bit, int node, int energy_class, int second_set) {
        return mixer_.code(*coder_, bit, node, energy_class, second_set);
    }

    void coarsest_pixel(int x, int y, int h) {
        const auto at = [&](int u, int v) { return int64_t(tile_.values[tile_.index(u, v)]); };
        int64_t p = (int64_t(coding_.low) + coding_.high) / 2, change = 0;
        if (x > 0 && y > 0) {  // the median of west, north and their plane
            const int64_t w = at(x - h, y), n = at(x, y - h);
            p = std::clamp(w + n - at(x - h, y - h), std::min(w, n), std::max(w, n));
            change = std::abs(w - n) / step_;
        } else if (x > 0 || y > 0) {
            p = x > 0 ? at(x - h, y) : at(x, y - h);
        }
        const int energy = static_cast<int>(std::min<int64_t>(change, 100000));
        for (size_t kind = 1; kind < ContextMixer::kContexts; ++kind) mixer_.set(kind, 0);
        mixer_.set(0, uint32_t(coarse12(energy)));
        value(tile_.index(x, y), p, energy, 0, false);
    }

    /// `Inside`: all neighbours are in the tile.
    template <bool Inside>
    void pixel(int x, int y, int h, int pass, int depth) {
        const size_t here = tile_.index(x, y);
        Inputs v;
        std::array<int, 16> q;
        uint32_t known = 0xffff;
        if constexpr (Inside) {
            const int32_t* const value = tile_.values.data() + here;
            const std::int16_t* const quotient = quotients_.data() + here;
            for (size_t i = 0; i < 16; ++i) {
                v[i] = value[neighbours_[i]];
                q[i] = quotient[neighbours_[i]];
            }
        } else {
            known = 0;
            v.fill(0);
            q.fill(0);
            for (size_t i = 0; i < 16; ++i) {
                const auto [across, down] = kNeighbours[size_t(pass)][i];
                const int u = x + across * h, w = y + down * h;
                if (u < 0 || w < 0 || u >= tile_.width || w >= tile_.height) continue;
                known |= 1u << i;
                v[i] = tile_.values[tile_.index(u, w)];
                q[i] = quotients_[tile_.index(u, w)];
            }
        }

        // Everything relative to the mean of the pixels around.
        double base = 0, least = 1e300, most = -1e300;
        int around = 0;
        for (size_t i = 0; i < 4; ++i) {
            if (!(known >> i & 1)) continue;
            base += v[i];
            least = std::min(least, v[i]);
            most = std::max(most, v[i]);
            ++around;
        }
        base /= around;
        uint32_t lows = 0;
        if (coding_.marks_low)
            for (uint32_t i = 0; i < 12; ++i) {
                const uint32_t n = i >= 4 && i < 8 ? i + 8 : i;  // the pass's own for the outer
                lows |= (known >> n & (v[n] == coding_.low ? 1u : 0u)) << i;
            }
        for (size_t i = 0; i < 16; ++i) v[i] = known >> i & 1 ? v[i] - base : 0;
        double deviation = 0;
        for (size_t i = 0; i < 12; ++i) deviation += std::fabs(v[i]);

        LeastSquares& predictor = predictors_[size_t(pass)];
        const double step = static_cast<double>(step_), inverse = inverse_step_;
        const double range = most - least, reach = range + 2 * step;
        double predicted = base + predictor.predict(v);
        if (!(predicted >= least - reach)) predicted = least - reach;  // NaN as well
        if (predicted > most + reach) predicted = most + reach;

        // A second opinion: along the flatter of the two directions.
        const size_t a0 = 0, a1 = pass ? 1 : 3, b0 = pass ? 2 : 1, b1 = pass ? 3 : 2;
        const double a = std::fabs(v[a0] - v[a1]), b = std::fabs(v[b0] - v[b1]);
        const double along =
            base + ((v[a0] + v[a1]) / 2 * (b + 1) + (v[b0] + v[b1]) / 2 * (a + 1)) / (a + b + 2);

        const auto m = [&](size_t i) { return std::abs(q[i]); };
        const int recent = 2 * m(12) + 2 * m(13) + m(14) + m(15);
        const int inner = m(0) + m(1) + m(2) + m(3);
        int outer = 0;
        for (size_t i = 4; i < 12; ++i) outer += m(i);
        const int spread = static_cast<int>(std::min(range * inverse * 4, 1e6));
        const int deviated = static_cast<int>(std::min(deviation * inverse, 1e6));
        const int energy = (2 * recent + inner + (spread >> 1)) / 8;
        const int total = 2 * recent + inner + outer / 2;
        const int blended = fine(3 * recent + 2 * inner + outer + spread + deviated);

        const double whole = std::floor(predicted);
        const double shape = (v[0] + v[3] - v[1] - v[2]) * inverse;
        const double trend = ((v[12] + v[13]) * 0.5 - (predicted - base)) * inverse;
        const auto p = static_cast<uint32_t>(pass);
        mixer_.set(0, uint32_t(coarse12(recent) * 12 + coarse12(inner)) * 2 + p);
        mixer_.set(1, uint32_t(std::min(coarse(spread), 15) * 16 + std::min(coarse(deviated), 15)));
        mixer_.set(2, signed_class((along - predicted) * inverse, kBlendLimits) * 12 +
                          uint32_t(coarse12(total)));
        mixer_.set(3, (clipped(q[12], 3) * 7 + clipped(q[13], 3)) * 9 + clipped(q[14], 1) * 3 +
                          clipped(q[15], 1));
        mixer_.set(4, uint32_t(std::min(m(0), 3) * 64 + std::min(m(1), 3) * 16 +
                               std::min(m(2), 3) * 4 + std::min(m(3), 3)) *
                              2 +
                          p);
        mixer_.set(6,
                   static_cast<uint32_t>((predicted - whole) * 8) * 12 + uint32_t(coarse12(total)));
        mixer_.set(7, uint32_t(blended * 6 + depth * 2) + p);
        mixer_.set(
            8, ((signed_class(shape, kShapeLimits) * 15 + signed_class(trend, kShapeLimits)) * 2 +
                (predicted < along ? 1u : 0u)) *
                       2 +
                   p);
        mixer_.set(9, lows);

        value(here, static_cast<int64_t>(std::floor(predicted + 0.5)), energy, blended,
              (lows & 0xff) != 0);
        const double noise = (deviation * deviation + range * range) * 0.01 + step * step;
        predictor.learn(v, tile_.values[here] - base, 1 / noise);
    }

    /// Codes one pixel, predicted as p; in the encoder its true value stands in the tile.
    void value(size_t here, int64_t p, int energy, int second_set, bool may_be_low) {
        p = std::clamp<int64_t>(p, coding_.low, coding_.high);
        const int64_t truth = tile_.values[here];
        const int energy_class = coarse12(energy);
        if (may_be_low) {
            candidate(p);
            if (code(truth - coding_.low <= bound_, kIsLow, energy_class, second_set)) {
                tile_.values[here] = coding_.low;
                quotients_[here] = 0;
                return;
            }
        }
        int64_t quotient = 0;
        if constexpr (Coder::kEncodes) {
            const int64_t d = truth - p;
            quotient = d >= 0 ? (d + bound_) / step_ : -((bound_ - d) / step_);
        }
        // No quotient of a true stream is beyond this; others must not overflow.
        const int64_t limit = (int64_t(1) << 33) / step_ + 1;
        quotient = std::clamp(symbol(quotient, p, energy, energy_class, second_set), -limit, limit);
        tile_.values[here] = static_cast<int32_t>(
            std::clamp<int64_t>(p + quotient * step_, coding_.low, coding_.high));
        quotients_[here] = static_cast<std::int16_t>(std::clamp<int64_t>(quotient, -30000, 30000));
    }

    int64_t symbol(int64_t quotient, int64_t p, int energy, int energy_class, int second_set) {
        int shift = 0;  // large magnitudes: the bits above are coded by contexts
        while (shift < 24 && (energy >> shift) > 12) ++shift;
        const int64_t magnitude = std::abs(quotient);
        candidate(p);
        if (shift == 0) {
            expect_candidate(p - step_, kUnary);
            expect_candidate(p + step_, kUnary);
            if (code(quotient == 0, kIsZero, energy_class, second_set)) return 0;
            const int negative = code(quotient < 0, kSign, energy_class, second_set);
            const int64_t towards = negative ? -step_ : step_;
            int64_t m = 1;
            for (int u = 0;; ++u, ++m) {
                if (u == kMostUnary) {
                    m += escape(magnitude - m);
                    break;
                }
                candidate(p + m * towards);
                expect_candidate(p + (m + 1) * towards, kUnary + u + 1);
                if (!code(magnitude > m, kUnary + u, energy_class, second_set)) break;
            }
            return negative ? -m : m;
        }
        int64_t bucket = 0;
        while (bucket < kMostBuckets &&
               code(bucket < magnitude >> shift, kBucket + static_cast<int>(bucket), energy_class,
                    second_set))
            ++bucket;
        if (bucket == kMostBuckets) bucket += escape((magnitude >> shift) - bucket);
        int64_t m = bucket;
        for (int b = shift - 1; b >= 0; --b) {
            const int bit = static_cast<int>(magnitude >> b & 1);
            const int node =
                kLowBits + (shift - 1 - b) * 3 + static_cast<int>(std::min<int64_t>(bucket, 2));
            const bool modelled = b >= shift - 2 && b < 3;
            m = m * 2 +
                (modelled ? code(bit, node, energy_class, second_set) : coder_->code(bit, 32768));
        }
        if (m == 0) return 0;
        return code(quotient < 0, kSign, energy_class, second_set) ? -m : m;
    }

    /// What a decision would make of the pixel, as its context: maps with few values show it.
    void candidate(int64_t v) { mixer_.set(5, static_cast<uint32_t>(v) % kCandidates); }
    void expect_candidate(int64_t v, int node) {
        mixer_.expect(5, static_cast<uint32_t>(v) % kCandidates, node);
    }

    /// Exponential Golomb code of n >= 0, up to 34 bits.
    int64_t escape(int64_t n) {
        int bits = 0;
        while (bits < 34 && coder_->code((n + 1) >> (bits + 1) != 0, 32768)) ++bits;
        int64_t value = 1;
        for (int b = bits - 1; b >= 0; --b)
            value = value * 2 + coder_->code(static_cast<int>((n + 1) >> b & 1), 32768);
        return value - 1;
    }

    Tile& tile_;
    const TileCoding coding_;
    int64_t bound_ = 0, step_ = 1;  ///< of the level
    double inverse_step_ = 1;
    std::array<std::ptrdiff_t, 16> neighbours_{};  ///< of a pixel of the pass, from its index
    std::vector<std::int16_t> quotients_;          ///< of coded pixels, clipped
    std::array<LeastSquares, 2> predictors_;
    ContextMixer mixer_{
        {288, 256, 16 * 12, 7 * 7 * 9, 512, kCandidates, 8 * 12, 23 * 6, 15 * 16 * 4, 4096}};
    Coder* coder_ = nullptr;
};

}  // namespace

std::vector<std::vector<std::uint8_t>> encode_mixing(Tile& tile, const TileCoding& coding) {
    std::vector<std::vector<std::uint8_t>> streams;
    Model<RangeEncoder> model(tile, coding);
    for (int level = 0; level <= coding.levels; ++level) {
        RangeEncoder coder;
        model.level(level, coder);
        streams.push_back(coder.finish());
    }
    return streams;
}

void decode_mixing(Tile& tile, const TileCoding& coding,
                   std::span<const std::span<const std::uint8_t>> streams) {
    Model<RangeDecoder> model(tile, coding);
    for (int level = 0; level < static_cast<int>(streams.size()); ++level) {
        RangeDecoder coder(streams[size_t(level)]);
        model.level(level, coder);
    }
}

}  // namespace wavefog::wfog
