#include "wavefog/wavelet/decomposition.h"

#include <cassert>

#include "chui_wang.h"
#include "lifting.h"
#include "scheme.h"

namespace wavefog {
namespace {

template <class To, class From>
Band<To> cast(const Band<From>& band) {
    return {band.values.template cast<To>(), band.start_x, band.start_z};
}

template <class To, class From>
Detail<To> cast(const Detail<From>& detail) {
    return {cast<To>(detail.phi_psi), cast<To>(detail.psi_phi), cast<To>(detail.psi_psi),
            cast<To>(detail.residual)};
}

// Scheme of a decomposition that decompose() or unpack() made, so of a family that exists.
template <class T>
Scheme scheme_of(const Decomposition<T>& decomposition) {
    Result<Scheme> scheme = Scheme::make(decomposition.family, decomposition.boundary);
    assert(scheme.has_value());
    return std::move(*scheme);
}

template <class T>
std::vector<Rect> level_rects(const Scheme& scheme, const Decomposition<T>& decomposition) {
    return scheme.level_rects(decomposition.width, decomposition.height, decomposition.levels());
}

template <class T>
void decompose_lifting(const Grid<T>& map, Decomposition<T>& out) {
    const Grid<T>* fine = &map;
    Rect rect{{0, out.width - 1}, {0, out.height - 1}};
    for (auto detail = out.details.rbegin(); detail != out.details.rend(); ++detail) {
        out.approximation = lifting_split(out.degree(), *fine, rect, *detail);
        fine = &out.approximation.values;
        rect = rect_of(out.approximation);
    }
}

// All arithmetic is in double, so a float map is rounded once per stored coefficient: that alone
// takes the round trip of 4,6 at 1000x1001 from 18 to 3 units of 2^-24 of the maximum.
template <class T>
void decompose_filtering(const Scheme& scheme, const Grid<T>& map, Decomposition<T>& out) {
    Band<double> fine{map.template cast<double>()};
    for (auto detail = out.details.rbegin(); detail != out.details.rend(); ++detail) {
        Detail<double> exact;
        Band<double> coarse;
        if (out.form == Form::wavelet) {
            coarse = scheme.split(fine, exact);
        } else {
            const Rect rect = rect_of(fine), target = scheme.synthesised(rect);
            coarse = scheme.restrict_band(fine);
            exact.residual = cropped(fine, target);
            exact.residual.values -= scheme.prolong(coarse, rect, target).values;
        }
        *detail = cast<T>(exact);
        fine = std::move(coarse);
    }
    out.approximation = cast<T>(fine);
}

template <class T>
Band<T> merge_lifting(const Decomposition<T>& decomposition, const Scheme& scheme,
                      const Band<T>& coarse, const Detail<T>& detail, const Rect& rect) {
    const Range phi_x = scheme.coarse(Part::low, rect.x), psi_x = scheme.coarse(Part::high, rect.x);
    const Range phi_z = scheme.coarse(Part::low, rect.z), psi_z = scheme.coarse(Part::high, rect.z);
    const Rect phi_psi{phi_x, psi_z}, psi_phi{psi_x, phi_z}, psi_psi{psi_x, psi_z};
    const bool fits = rect_of(detail.phi_psi) == phi_psi && rect_of(detail.psi_phi) == psi_phi &&
                      rect_of(detail.psi_psi) == psi_psi;
    const auto merged = [&](const Detail<T>& fitting) {
        return Band<T>{lifting_merge(decomposition.degree(), coarse, fitting, rect), rect.x.first,
                       rect.z.first};
    };
    if (fits) return merged(detail);
    return merged({cropped(detail.phi_psi, phi_psi),
                   cropped(detail.psi_phi, psi_phi),
                   cropped(detail.psi_psi, psi_psi),
                   {}});
}

Band<double> merge_filtering(Form form, const Scheme& scheme, const Band<double>& coarse,
                             const Detail<double>& detail, const Rect& rect) {
    if (form == Form::wavelet) return scheme.merge(coarse, detail, rect, rect);
    Band<double> out = scheme.prolong(coarse, rect, rect);
    out.values += cropped(detail.residual, rect).values;
    return out;
}

// Calls visit(l, c_l) from the coarsest level to the finest; c_l may be moved from at the finest.
// True coefficients are 0 outside their level's rectangle, so cropping there loses nothing.
template <class T, class Visit>
void synthesise(const Decomposition<T>& decomposition, const Visit& visit) {
    const Scheme scheme = scheme_of(decomposition);
    const std::vector<Rect> rects = level_rects(scheme, decomposition);
    Band<T> coarsest = cropped(decomposition.approximation, rects[0]);
    if (decomposition.form == Form::wavelet &&
        has_lifting(decomposition.family, decomposition.boundary)) {
        visit(0, coarsest);
        for (std::size_t l = 1; l < rects.size(); ++l) {
            coarsest = merge_lifting(decomposition, scheme, coarsest, decomposition.details[l - 1],
                                     rects[l]);
            visit(static_cast<int>(l), coarsest);
        }
        return;
    }
    Band<double> level = cast<double>(coarsest);
    visit(0, level);
    for (std::size_t l = 1; l < rects.size(); ++l) {
        level = merge_filtering(decomposition.form, scheme, level,
                                cast<double>(decomposition.details[l - 1]), rects[l]);
        visit(static_cast<int>(l), level);
    }
}

// Moves where the types agree, converts where they do not.
template <class To, class From>
void assign(Grid<To>& to, Grid<From>& from) {
    if constexpr (std::is_same_v<To, From>)
        to = std::move(from);
    else
        to = from.template cast<To>();
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
    const Result<Scheme> scheme = Scheme::make(family, boundary);
    if (!scheme) return tl::unexpected<Error>(scheme.error());

    Decomposition<T> out;
    out.family = family;
    out.form = form;
    out.boundary = boundary;
    out.width = static_cast<int>(map.cols());
    out.height = static_cast<int>(map.rows());
    const int used = std::min(levels, max_levels(family, out.width, out.height, boundary));
    out.details.resize(static_cast<std::size_t>(used));
    if (used == 0)
        out.approximation.values = map;
    else if (form == Form::wavelet && has_lifting(family, boundary))
        decompose_lifting(map, out);
    else
        decompose_filtering(*scheme, map, out);
    return out;
}

template <class T>
Pyramid<T> approximations(const Decomposition<T>& decomposition) {
    Pyramid<T> pyramid{decomposition.degree(),
                       decomposition.boundary,
                       decomposition.width,
                       decomposition.height,
                       {}};
    synthesise(decomposition,
               [&](int, const auto& level) { pyramid.levels.push_back(cast<T>(level)); });
    return pyramid;
}

template <class T>
Grid<T> reconstruct(const Decomposition<T>& decomposition) {
    Grid<T> finest;
    synthesise(decomposition, [&](int l, auto& level) {
        if (l == decomposition.levels()) assign(finest, level.values);
    });
    return finest;
}

template <class T>
Decomposition<T> to_scaling_form(const Decomposition<T>& decomposition) {
    if (decomposition.form == Form::scaling) return decomposition;
    const Scheme scheme = scheme_of(decomposition);
    const std::vector<Rect> rects = level_rects(scheme, decomposition);
    Decomposition<T> out = decomposition;
    out.form = Form::scaling;
    for (std::size_t l = 1; l < rects.size(); ++l) {
        Detail<double> residual;
        residual.residual = scheme.merge({}, cast<double>(decomposition.details[l - 1]), rects[l],
                                         scheme.synthesised(rects[l]));
        out.details[l - 1] = cast<T>(residual);
    }
    return out;
}

int max_levels(int width, int height, Boundary boundary) {
    int levels = 0;
    if (boundary == Boundary::repeat) {
        for (; width > 0 && height > 0 && width % 2 == 0 && height % 2 == 0; ++levels) {
            width /= 2;
            height /= 2;
        }
        return levels;
    }
    for (int side = std::max(width, height); side > 1; side = side / 2 + side % 2) ++levels;
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
