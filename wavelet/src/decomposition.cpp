#include "wavefog/wavelet/decomposition.h"

#include <algorithm>
#include <cassert>

#include "chui_wang.h"
#include "scheme.h"

namespace wavefog {
namespace {

// Scheme of a decomposition that decompose() or unpack() made, so of a family that exists.
template <class T>
Scheme scheme_of(const Decomposition<T>& decomposition) {
    Result<Scheme> scheme = Scheme::make(decomposition.family, decomposition.boundary);
    assert(scheme.has_value());
    return std::move(*scheme);
}

// c_l from c_{l-1} on `target`.
template <class T>
Band<T> refine(const Scheme& scheme, Form form, const Band<T>& coarse, const Detail<T>& detail,
               const Rect& fine, const Rect& target) {
    if (form == Form::wavelet) return scheme.merge(coarse, detail, fine, target);
    Band<T> out = scheme.prolong(coarse, fine, target);
    out.values += cropped(detail.residual, target).values;
    return out;
}

}  // namespace

template <class T>
Result<Decomposition<T>> decompose(const Grid<T>& map, const Family& family, int levels, Form form,
                                   Boundary boundary) {
    if (map.rows() < 1 || map.cols() < 1)
        return usage_error("map: has no pixels; give at least 1x1");
    if (levels < 0)
        return usage_error("levels " + std::to_string(levels) +
                           ": must not be negative; use 0 or more");
    if (family.kind == Family::Kind::positive && form == Form::wavelet)
        return usage_error("family positive: has no wavelets; use the scaling form");
    const Result<Scheme> made = Scheme::make(family, boundary);
    if (!made) return tl::unexpected<Error>(made.error());
    const Scheme& scheme = *made;

    Decomposition<T> out;
    out.family = family;
    out.form = form;
    out.boundary = boundary;
    out.width = static_cast<int>(map.cols());
    out.height = static_cast<int>(map.rows());
    out.details.resize(static_cast<std::size_t>(
        std::min(levels, max_levels(family, out.width, out.height, boundary))));
    out.approximation.values = map;
    for (auto detail = out.details.rbegin(); detail != out.details.rend(); ++detail) {
        const Band<T>& fine = out.approximation;
        if (form == Form::wavelet) {
            out.approximation = scheme.split(fine, *detail);
            continue;
        }
        const Rect rect = rect_of(fine), target = scheme.synthesised(rect);
        Band<T> coarse = scheme.restrict_band(fine);
        detail->residual = cropped(fine, target);
        detail->residual.values -= scheme.prolong(coarse, rect, target).values;
        out.approximation = std::move(coarse);
    }
    return out;
}

template <class T>
Pyramid<T> approximations(const Decomposition<T>& decomposition) {
    const Scheme scheme = scheme_of(decomposition);
    const std::vector<Rect> rects =
        scheme.level_rects(decomposition.width, decomposition.height, decomposition.levels());
    Pyramid<T> pyramid{decomposition.degree(),
                       decomposition.boundary,
                       decomposition.width,
                       decomposition.height,
                       {}};
    pyramid.levels.push_back(cropped(decomposition.approximation, rects[0]));
    // True coefficients are 0 outside their rectangle, so cropping there loses nothing.
    for (std::size_t l = 1; l < rects.size(); ++l)
        pyramid.levels.push_back(refine(scheme, decomposition.form, pyramid.levels.back(),
                                        decomposition.details[l - 1], rects[l], rects[l]));
    return pyramid;
}

template <class T>
Grid<T> reconstruct(const Decomposition<T>& decomposition) {
    const Scheme scheme = scheme_of(decomposition);
    const std::vector<Rect> rects =
        scheme.level_rects(decomposition.width, decomposition.height, decomposition.levels());
    Band<T> fine = cropped(decomposition.approximation, rects[0]);
    for (std::size_t l = 1; l < rects.size(); ++l)
        fine = refine(scheme, decomposition.form, fine, decomposition.details[l - 1], rects[l],
                      rects[l]);
    return std::move(fine.values);
}

template <class T>
Decomposition<T> to_scaling_form(const Decomposition<T>& decomposition) {
    if (decomposition.form == Form::scaling) return decomposition;
    const Scheme scheme = scheme_of(decomposition);
    const std::vector<Rect> rects =
        scheme.level_rects(decomposition.width, decomposition.height, decomposition.levels());
    Decomposition<T> out = decomposition;
    out.form = Form::scaling;
    for (std::size_t l = 1; l < rects.size(); ++l) {
        const Band<T> nothing = cropped(Band<T>{}, rects[l - 1]);
        Detail<T> detail;
        detail.residual = scheme.merge(nothing, decomposition.details[l - 1], rects[l],
                                       scheme.synthesised(rects[l]));
        out.details[l - 1] = std::move(detail);
    }
    return out;
}

int max_levels(int width, int height, Boundary boundary) {
    int levels = 0;
    if (boundary == Boundary::repeat)
        for (int w = width, h = height; w > 0 && h > 0 && w % 2 == 0 && h % 2 == 0; w /= 2, h /= 2)
            ++levels;
    else
        for (int side = 1; side<std::max(width, height); side = side>(1 << 29) ? 1 << 30 : 2 * side)
            ++levels;
    return levels;
}

int max_levels(const Family& family, int width, int height, Boundary boundary) {
    if (family.kind != Family::Kind::chui_wang || boundary == Boundary::repeat)
        return max_levels(width, height, boundary);
    int levels = 0;
    const auto coarse = [&](int n) { return IntervalLevel::coarse_size(n, family.degree); };
    for (int w = coarse(width), h = coarse(height); w > 0 && h > 0; w = coarse(w), h = coarse(h))
        ++levels;
    return levels;
}

std::string level_cap_message(int requested, int used, int width, int height) {
    if (used >= requested) return {};
    return "levels " + std::to_string(requested) + ": a map of " + std::to_string(width) + "x" +
           std::to_string(height) + " gains nothing beyond " + std::to_string(used) + "; used " +
           std::to_string(used);
}

#define WAVEFOG_INSTANTIATE(T)                                                            \
    template Result<Decomposition<T>> decompose(const Grid<T>&, const Family&, int, Form, \
                                                Boundary);                                \
    template Grid<T> reconstruct(const Decomposition<T>&);                                \
    template Decomposition<T> to_scaling_form(const Decomposition<T>&);                   \
    template Pyramid<T> approximations(const Decomposition<T>&);
WAVEFOG_INSTANTIATE(float)
WAVEFOG_INSTANTIATE(double)
#undef WAVEFOG_INSTANTIATE

}  // namespace wavefog
