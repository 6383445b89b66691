#include "wavefog/wavelet/quantise.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>

#include "scheme.h"

namespace wavefog {
namespace {

Eigen::half next_up(Eigen::half value) {
    constexpr std::uint16_t kSign = 0x8000;
    const std::uint16_t bits = value.x;
    if (bits == kSign || bits == 0) return Eigen::half_impl::raw_uint16_to_half(1);
    const int step = (bits & kSign) != 0 ? -1 : 1;
    return Eigen::half_impl::raw_uint16_to_half(static_cast<std::uint16_t>(bits + step));
}

template <class T, class Act>
void for_each_detail_band(Detail<T>& detail, const Act& act) {
    act(detail.phi_psi);
    act(detail.psi_phi);
    act(detail.psi_psi);
    act(detail.residual);
}

// False if any value is not below max_half in magnitude (or is not a number).
bool fits_half(const Grid<float>& values) {
    return values.size() == 0 || (values.abs() <= max_half).all();
}

Band<double> rounded_up(const Band<double>& band) {
    return {band.values.unaryExpr([](double x) { return static_cast<double>(half_above(x)); }),
            band.start_x, band.start_z};
}

Band<double> to_double(const Band<float>& band) {
    return {band.values.cast<double>(), band.start_x, band.start_z};
}

Band<float> to_float(const Band<double>& band) {
    return {band.values.cast<float>(), band.start_x, band.start_z};
}

Decomposition<float> closed_loop(const Decomposition<float>& exact) {
    const Result<Scheme> scheme = Scheme::make(exact.family, exact.boundary);
    assert(scheme.has_value());
    const std::vector<IndexRect> rects =
        scheme->level_rects(exact.width, exact.height, exact.levels());
    Decomposition<float> out = exact;
    Band<double> truth = to_double(exact.approximation);
    Band<double> rounded = rounded_up(truth);
    out.approximation = to_float(rounded);
    for (std::size_t l = 1; l < rects.size(); ++l) {
        const IndexRect target = scheme->synthesised(rects[l]);
        const Band<double> residual = cropped(to_double(exact.details[l - 1].residual), target);
        truth = scheme->prolong(truth, rects[l], target);
        truth.values += residual.values;
        if (l + 1 == rects.size() && truth.values.size() > 0) {
            // A density of 0 came back as 0 minus the rounding of float: it is 0.
            const double rounding = 0x1p-20 * truth.values.abs().maxCoeff();
            truth.values =
                (truth.values.abs() <= rounding).select(truth.values.max(0), truth.values);
        }
        const Band<double> predicted = scheme->prolong(rounded, rects[l], target);
        Band<double> error{truth.values - predicted.values, target.x.first, target.z.first};
        error = rounded_up(error);
        out.details[l - 1].residual = to_float(error);
        error.values += predicted.values;
        rounded = cropped(error, rects[l]);
        truth = cropped(truth, rects[l]);
    }
    return out;
}

}  // namespace

float nearest_half(float x) {
    return static_cast<float>(Eigen::half(x));
}

float half_above(double x) {
    const Eigen::half near(static_cast<float>(x));
    return static_cast<float>(static_cast<double>(static_cast<float>(near)) < x ? next_up(near)
                                                                                : near);
}

Result<void> round_to_half_closed_loop(Decomposition<float>& decomposition) {
    Decomposition<float> out = decomposition;
    if (out.form == Form::scaling) {
        out = closed_loop(decomposition);
    } else {
        const auto round = [](Band<float>& band) {
            band.values = band.values.unaryExpr([](float x) { return nearest_half(x); }).eval();
        };
        round(out.approximation);
        for (Detail<float>& detail : out.details) for_each_detail_band(detail, round);
    }
    bool fits = fits_half(out.approximation.values);
    for (Detail<float>& detail : out.details)
        for_each_detail_band(
            detail, [&](const Band<float>& band) { fits = fits && fits_half(band.values); });
    if (!fits)
        return data_error(
            "half float: a coefficient exceeds 65504; scale the map to a maximum of 1, or use "
            "float");
    decomposition = std::move(out);
    return {};
}

template <class T>
ThresholdCount hard_threshold(Decomposition<T>& decomposition, std::span<const double> thresholds) {
    ThresholdCount count;
    for (std::size_t l = 0; l < decomposition.details.size(); ++l) {
        const double limit = l < thresholds.size() ? thresholds[l] : 0;
        for_each_detail_band(decomposition.details[l], [&](Band<T>& band) {
            for (T& value : band.values.reshaped()) {
                if (value == 0) continue;
                const bool keep = !(std::abs(static_cast<double>(value)) < limit);
                ++(keep ? count.kept : count.dropped);
                if (!keep) value = 0;
            }
        });
    }
    return count;
}
template ThresholdCount hard_threshold(Decomposition<float>&, std::span<const double>);
template ThresholdCount hard_threshold(Decomposition<double>&, std::span<const double>);

}  // namespace wavefog
