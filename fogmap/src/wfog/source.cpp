#include "source.h"

#include <cmath>

#include "bands.h"
#include "decoder.h"

namespace wavefog::wfog {

namespace {

/// A reconstruction is off by up to 16 * 2^-24 of the maximum (decomposition.h).
constexpr double kRounding = 2e-6;

/// Whether decomposing the map gives the fog's own bits.
bool gives(const Grid<float>& map, const Fog& fog) {
    const auto again = decompose_as(map, fog.decomposition, fog.decomposition.levels());
    return again && same_coefficients(*again, fog.decomposition);
}

/// Steps of a ratio have one 0 alone.
bool has_negative_zero(const Grid<float>& map) {
    return map.unaryExpr([](float value) { return value == 0 && std::signbit(value); }).any();
}

}  // namespace

Source source_of(const Fog& fog, const Grid<float>* map, bool lossless) {
    Source source;
    source.given = map;
    if (!map) source.made = reconstruct(fog.decomposition);
    source.exact = lossless && gives(source.map(), fog);
    if (map && lossless && has_negative_zero(*map)) return source;
    source.ratio = ratio_of(source.map(), 0);
    if (source.ratio || (map && source.exact)) return source;
    // Rounding may hide the steps of an integer picture.
    if (const auto ratio = ratio_of(source.map(), kRounding)) {
        Source snapped;
        snapped.ratio = ratio;
        snapped.made = source.map().unaryExpr(
            [&](float value) { return ratio->density(*ratio->integer(value)); });
        if (map && !lossless) {
            source.ratio = ratio;
            source.slack = double((*snapped.made - *map).abs().maxCoeff());
            return source;
        }
        snapped.exact = lossless && gives(snapped.map(), fog);
        if (snapped.exact || !source.exact) return snapped;
    }
    return source;
}

}  // namespace wavefog::wfog
