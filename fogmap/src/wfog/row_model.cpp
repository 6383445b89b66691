#include "row_model.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdlib>

#include "token_stream.h"
#include "vector_clones.h"

namespace wavefog::wfog {

using std::int32_t;
using std::size_t;
using std::uint8_t;

Mixture mixture_of(const Weights& weights, int part) {
    if (part == 0) return {0.5f, float(weights.centre) / 64};
    return {float(weights.along[size_t(part) - 1]) / 64,
            float(weights.beyond[size_t(part) - 1]) / 64};
}

Row row_of(const Parts& parts, int part, int j) {
    const Plane &p = parts.coarse, &c = parts.centres;
    if (part == 0) {
        const float *up = p.row(j - 1), *n = p.row(j), *s = p.row(j + 1), *down = p.row(j + 2);
        return {n, s + 1, n + 1, s, {n - 1, n + 2, s - 1, s + 2, up, up + 1, down, down + 1}};
    }
    if (part == 1) {
        const float *n = c.row(j - 1), *s = c.row(j), *up = p.row(j - 1), *down = p.row(j + 1);
        return {
            p.row(j), p.row(j) + 1, n, s, {n - 1, n + 1, s - 1, s + 1, up, up + 1, down, down + 1}};
    }
    const float *n = p.row(j), *s = p.row(j + 1), *w = c.row(j) - 1, *up = c.row(j - 1) - 1,
                *down = c.row(j + 1) - 1;
    return {w, w + 1, n, s, {n - 1, n + 1, s - 1, s + 1, up, up + 1, down, down + 1}};
}

WAVEFOG_VECTOR_CLONES
void predict(const Row& row, const Mixture& mix, const Quantiser& quantiser,
             const float* __restrict before, int width, float* __restrict predicted,
             uint8_t* __restrict contexts) {
    const float a = mix.a, b = 1 - mix.a, t = mix.beyond;
    const float most = quantiser.most, inverse_step = quantiser.inverse_step;
    const float *a0 = row.a0, *a1 = row.a1, *b0 = row.b0, *b1 = row.b1;
    const auto [r0, r1, r2, r3, r4, r5, r6, r7] = row.ring;
    constexpr int32_t kLast = int32_t(kTokenContexts) - 1;
    for (int i = 0; i < width; ++i) {
        const float x = a0[i] + a1[i], y = b0[i] + b1[i];
        const float ring =
            ((r0[i] + r1[i]) + (r2[i] + r3[i])) + ((r4[i] + r5[i]) + (r6[i] + r7[i]));
        const float trend = (x + y) * 0.25f - ring * 0.125f;
        float p = x * 0.5f * a + y * 0.5f * b + trend * t;
        p = p > 0 ? p : 0.0f;
        p = p < most ? p : most;
        predicted[i] = static_cast<float>(static_cast<int32_t>(p + 0.5f));
        const float spread = std::fabs(a0[i] - a1[i]) + std::fabs(b0[i] - b1[i]) +
                             std::fabs(x - y) * 0.5f + std::fabs(trend) * 2.0f;
        const float activity =
            spread * inverse_step + (before[i - 1] + before[i] * 2.0f + before[i + 1]) * 0.5f;
        // Two classes an octave, from the exponent and the first bit of the mantissa.
        const int32_t c = (std::bit_cast<int32_t>(activity + 0.25f) >> 22) - (0x3e800000 >> 22);
        contexts[i] = static_cast<uint8_t>(c > kLast ? kLast : c);
    }
}

WAVEFOG_VECTOR_CLONES
void quantise(const float* __restrict predicted, int width, const Quantiser& quantiser,
              float* __restrict values, int32_t* __restrict quotients) {
    const float step = quantiser.step, inverse_step = quantiser.inverse_step, most = quantiser.most;
    for (int i = 0; i < width; ++i) {
        const float d = (values[i] - predicted[i]) * inverse_step;
        const auto q = static_cast<int32_t>(d + std::copysign(0.5f, d));
        quotients[i] = q;
        float v = predicted[i] + static_cast<float>(q) * step;
        v = v > 0 ? v : 0.0f;
        values[i] = v < most ? v : most;
    }
}

WAVEFOG_VECTOR_CLONES
void restore(const float* __restrict predicted, const int32_t* __restrict quotients, int width,
             const Quantiser& quantiser, float* __restrict values) {
    const float step = quantiser.step, most = quantiser.most;
    for (int i = 0; i < width; ++i) {
        float v = predicted[i] + static_cast<float>(quotients[i]) * step;
        v = v > 0 ? v : 0.0f;
        values[i] = v < most ? v : most;
    }
}

WAVEFOG_VECTOR_CLONES
void remember(const int32_t* __restrict quotients, int width, float* __restrict before) {
    for (int i = 0; i < width; ++i) before[i] = static_cast<float>(std::abs(quotients[i]));
    before[-1] = before[0];
    before[width] = before[width - 1];
}

namespace {

/// Sums of products along a row, as so many running side by side: an order that vectors keep.
constexpr int kLanes = 8;
using Lanes = std::array<float, kLanes>;

double total(const Lanes& lanes) {
    double sum = 0;
    for (const float lane : lanes) sum += double(lane);
    return sum;
}

}  // namespace

WAVEFOG_VECTOR_CLONES
double squared_distance(const float* a, const float* b, int width) {
    Lanes sums{};
    int i = 0;
    for (; i + kLanes <= width; i += kLanes)
        for (int lane = 0; lane < kLanes; ++lane) {
            const float d = a[i + lane] - b[i + lane];
            sums[size_t(lane)] += d * d;
        }
    for (; i < width; ++i) sums[0] += (a[i] - b[i]) * (a[i] - b[i]);
    return total(sums);
}

namespace {

/// The moments of truth - y = a (x - y) + t trend over every `skip`-th row of a part, x and y the
/// means of the pairs: uu, ut, ud, tt, td.
struct Moments {
    double uu = 0, ut = 0, ud = 0, tt = 0, td = 0;
};

WAVEFOG_VECTOR_CLONES
Moments moments_of(const Parts& parts, int part, const Plane& plane, int skip) {
    Moments m;
    for (int j = 0; j < plane.height; j += skip) {
        const Row row = row_of(parts, part, j);
        const float *a0 = row.a0, *a1 = row.a1, *b0 = row.b0, *b1 = row.b1;
        const std::array<const float*, 8> r = row.ring;
        const float* truth = plane.row(j);
        Lanes uu{}, ut{}, ud{}, tt{}, td{};
        const auto add = [&](int i, int lane) {
            const auto k = size_t(lane);
            const float x = (a0[i] + a1[i]) * 0.5f, y = (b0[i] + b1[i]) * 0.5f;
            const float ring = ((r[0][i] + r[1][i]) + (r[2][i] + r[3][i])) +
                               ((r[4][i] + r[5][i]) + (r[6][i] + r[7][i]));
            const float u = x - y, t = (x + y) * 0.5f - ring * 0.125f, d = truth[i] - y;
            uu[k] += u * u;
            ut[k] += u * t;
            ud[k] += u * d;
            tt[k] += t * t;
            td[k] += t * d;
        };
        int i = 0;
        for (; i + kLanes <= plane.width; i += kLanes)
            for (int lane = 0; lane < kLanes; ++lane) add(i + lane, lane);
        for (; i < plane.width; ++i) add(i, 0);
        m.uu += total(uu);
        m.ut += total(ut);
        m.ud += total(ud);
        m.tt += total(tt);
        m.td += total(td);
    }
    return m;
}

}  // namespace

Weights fit(Parts& parts, bool roughly) {
    Weights weights;
    const int skip = roughly || parts.centres.height > 64 ? 4 : 1;
    const auto in_64ths = [](double x) {
        return static_cast<std::int8_t>(std::clamp(std::lround(x * 64), -64l, 127l));
    };
    parts.coarse.extend(parts.coarse);
    parts.centres.extend(parts.coarse);
    const Moments centre = moments_of(parts, 0, parts.centres, skip);
    // There the weight of the pairs is fixed: truth - (x + y) / 2 = t trend.
    if (centre.tt > 0) weights.centre = in_64ths((centre.td - centre.ut / 2) / centre.tt);
    for (const int part : {1, 2}) {
        const Moments m =
            moments_of(parts, part, part == 1 ? parts.horizontal : parts.vertical, skip);
        const double determinant = m.uu * m.tt - m.ut * m.ut;
        if (determinant > 1e-6 * m.uu * m.tt && determinant > 0) {
            weights.along[size_t(part) - 1] = in_64ths((m.ud * m.tt - m.td * m.ut) / determinant);
            weights.beyond[size_t(part) - 1] = in_64ths((m.td * m.uu - m.ud * m.ut) / determinant);
        }
    }
    return weights;
}

}  // namespace wavefog::wfog
