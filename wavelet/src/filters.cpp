#include "wavefog/wavelet/filters.h"

#include <algorithm>
#include <string>

#include "chui_wang.h"
#include "wavefog/wavelet/bspline.h"

namespace wavefog {
namespace {

struct DualLowPass {
    int order, dual_moments, start;
    std::int64_t denominator;
    std::vector<std::int64_t> numerators;  // the first half; h is symmetric
    bool odd_length;                       // the last numerator is the centre, used once
};

// Dual low-pass filters h of Cohen, Daubechies and Feauveau (stability.md 1.1).
const std::vector<DualLowPass>& table() {
    static const std::vector<DualLowPass> rows = {
        {1, 1, 0, 2, {1}, false},
        {1, 3, -2, 16, {-1, 1, 8}, false},
        {2, 0, 1, 1, {1}, true},
        {2, 2, -1, 8, {-1, 2, 6}, true},
        {2, 4, -3, 128, {3, -6, -16, 38, 90}, true},
        {3, 1, 0, 4, {-1, 3}, false},
        {3, 3, -2, 64, {3, -9, -7, 45}, false},
        {3, 5, -4, 512, {-5, 15, 19, -97, -26, 350}, false},
        {3, 7, -6, 16384, {35, -105, -195, 865, 363, -3489, -307, 11025}, false},
        {4, 2, -1, 32, {3, -12, 5, 40}, true},
        {4, 4, -3, 256, {-5, 20, -1, -96, 70, 280}, true},
        {4, 6, -5, 8192, {35, -140, -55, 920, -557, -2932, 2625, 8400}, true},
    };
    return rows;
}

std::vector<std::int64_t> mirrored(const DualLowPass& row) {
    std::vector<std::int64_t> taps = row.numerators;
    taps.insert(taps.end(), row.numerators.rbegin() + (row.odd_length ? 1 : 0),
                row.numerators.rend());
    return taps;
}

// (-1)^n x_{1-n}, the alternating flip that makes high-pass filters from low-pass ones.
ExactTaps flipped(const ExactTaps& low) {
    ExactTaps high{1 - low.last(), low.denominator, {}};
    for (int n = high.start; n <= 1 - low.start; ++n)
        high.numerators.push_back(n % 2 == 0 ? low.numerator(1 - n) : -low.numerator(1 - n));
    return high;
}

Taps to_double(const ExactTaps& exact) {
    Taps taps{exact.start, {}};
    for (const std::int64_t numerator : exact.numerators)
        taps.values.push_back(static_cast<double>(numerator) /
                              static_cast<double>(exact.denominator));
    return taps;
}

}  // namespace

const std::vector<std::pair<int, int>>& cdf_pairs() {
    static const std::vector<std::pair<int, int>> pairs = [] {
        std::vector<std::pair<int, int>> all;
        for (const DualLowPass& row : table()) all.emplace_back(row.order, row.dual_moments);
        return all;
    }();
    return pairs;
}

Result<FilterBank> cdf_filters(int order, int dual_moments) {
    const auto row = std::find_if(table().begin(), table().end(), [&](const DualLowPass& r) {
        return r.order == order && r.dual_moments == dual_moments;
    });
    if (row == table().end()) {
        std::string message = "family " + std::to_string(order) + "," +
                              std::to_string(dual_moments) + ": no such filter bank; there are";
        for (const auto& [n, nt] : cdf_pairs())
            message.append(" ").append(std::to_string(n)).append(",").append(std::to_string(nt));
        return usage_error(message);
    }
    FilterBank bank;
    bank.order = order;
    bank.dual_moments = dual_moments;
    bank.h = {row->start, row->denominator, mirrored(*row)};
    // p_k = 2^-d C(d + 1, k)
    bank.p = {0, std::int64_t{1} << (order - 1), {1}};
    for (int k = 1; k <= order; ++k)
        bank.p.numerators.push_back(bank.p.numerators.back() * (order + 1 - k) / k);
    bank.g = flipped(bank.p);
    bank.g.denominator *= 2;
    bank.q = flipped(bank.h);
    for (std::int64_t& numerator : bank.q.numerators) numerator *= 2;
    return bank;
}

Result<Filters> filters(const Family& family) {
    const int d = family.degree;
    Filters out;
    out.p = {0, two_scale(d)};
    switch (family.kind) {
        case Family::Kind::cdf: {
            const Result<FilterBank> bank = cdf_filters(d + 1, family.dual_moments);
            if (!bank) return tl::unexpected<Error>(bank.error());
            out.h = to_double(bank->h);
            out.g = to_double(bank->g);
            out.q = to_double(bank->q);
            break;
        }
        case Family::Kind::positive:
            // Symmetric about the coarse B-spline's centre, so mass and its centre are kept.
            if (d % 2 == 0)
                out.h = {d / 2, {0.5, 0.5}};
            else
                out.h = {(d - 1) / 2, {0.25, 0.5, 0.25}};
            break;
        case Family::Kind::chui_wang: {
            out.q = chui_wang_wavelet(d);
            out.h = line_dual(out.p, d);
            out.g = line_dual(out.q, d);
            break;
        }
    }
    return out;
}

}  // namespace wavefog
