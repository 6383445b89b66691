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
std::vector<IndexRect> level_rects(const Scheme& scheme, const Decomposition<T>& decomposition) {
    return scheme.level_rects(decomposition.width, decomposition.height, decomposition.levels());
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
            const IndexRect rect = rect_of(fine), target = scheme.synthesised(rect);
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
bool uses_lifting(const Decomposition<T>& decomposition) {
    return decomposition.form == Form::wavelet && decomposition.levels() > 0 &&
           has_lifting(decomposition.family, decomposition.boundary);
}

// Lifting writes bands of known rectangles only. A decomposition whose bands differ (edited or read
// from elsewhere) is cropped or filled with zeros into `storage`, as filtering does by itself.
template <class T>
const Decomposition<T>& fitted(const Decomposition<T>& given, const Scheme& scheme,
                               const std::vector<IndexRect>& rects, Decomposition<T>& storage) {
    bool fits = rect_of(given.approximation) == rects[0];
    const auto for_each_band = [&](std::size_t l, auto& detail, const auto& act) {
        const IndexRect& fine = rects[l + 1];
        const Range phi_x = scheme.coarse(Part::low, fine.x);
        const Range phi_z = scheme.coarse(Part::low, fine.z);
        const Range psi_x = scheme.coarse(Part::high, fine.x);
        const Range psi_z = scheme.coarse(Part::high, fine.z);
        act(detail.phi_psi, IndexRect{phi_x, psi_z});
        act(detail.psi_phi, IndexRect{psi_x, phi_z});
        act(detail.psi_psi, IndexRect{psi_x, psi_z});
    };
    for (std::size_t l = 0; l < given.details.size(); ++l)
        for_each_band(l, given.details[l], [&](const Band<T>& band, const IndexRect& rect) {
            fits = fits && rect_of(band) == rect;
        });
    if (fits) return given;
    storage = given;
    storage.approximation = cropped(given.approximation, rects[0]);
    for (std::size_t l = 0; l < storage.details.size(); ++l)
        for_each_band(l, storage.details[l],
                      [](Band<T>& band, const IndexRect& rect) { band = cropped(band, rect); });
    return storage;
}

Band<double> merge_filtering(Form form, const Scheme& scheme, const Band<double>& coarse,
                             const Detail<double>& detail, const IndexRect& rect) {
    if (form == Form::wavelet) return scheme.merge(coarse, detail, rect, rect);
    Band<double> out = scheme.prolong(coarse, rect, rect);
    out.values += cropped(detail.residual, rect).values;
    return out;
}

// Calls visit(l, c_l) from the coarsest level to the finest; c_l may be moved from at the finest.
// True coefficients are 0 outside their level's rectangle, so cropping there loses nothing.
template <class T, class Visit>
void filter_up(const Scheme& scheme, const Decomposition<T>& decomposition,
               const std::vector<IndexRect>& rects, const Visit& visit) {
    Band<double> level = cast<double>(cropped(decomposition.approximation, rects[0]));
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
Result<void> decompose_into(const Grid<T>& map, const Family& family, int levels, Form form,
                            Boundary boundary, Decomposition<T>& out) {
    if (map.rows() < 1 || map.cols() < 1)
        return usage_error("map: has no pixels; give at least 1x1");
    if (levels < 0)
        return usage_error("levels " + std::to_string(levels) +
                           ": must not be negative; use 0 or more");
    if (family.kind == Family::Kind::positive && form == Form::wavelet)
        return usage_error("family positive: has no wavelets; use the scaling form");
    const Result<Scheme> scheme = Scheme::make(family, boundary);
    if (!scheme) return tl::unexpected<Error>(scheme.error());

    out.family = family;
    out.form = form;
    out.boundary = boundary;
    out.width = static_cast<int>(map.cols());
    out.height = static_cast<int>(map.rows());
    const int used = std::min(levels, max_levels(family, out.width, out.height, boundary));
    out.details.resize(static_cast<std::size_t>(used));
    if (used == 0)
        out.approximation = {map};
    else if (uses_lifting(out))
        lifting_split<T>(out.degree(), map, {{0, out.width - 1}, {0, out.height - 1}}, out.details,
                         out.approximation);
    else
        decompose_filtering(*scheme, map, out);
    return {};
}

template <class T>
Result<Decomposition<T>> decompose(const Grid<T>& map, const Family& family, int levels, Form form,
                                   Boundary boundary) {
    Decomposition<T> out;
    const Result<void> done = decompose_into(map, family, levels, form, boundary, out);
    if (!done) return tl::unexpected<Error>(done.error());
    return out;
}

template <class T>
Pyramid<T> approximations(const Decomposition<T>& decomposition) {
    Pyramid<T> pyramid{decomposition.degree(),
                       decomposition.boundary,
                       decomposition.width,
                       decomposition.height,
                       {}};
    const Scheme scheme = scheme_of(decomposition);
    const std::vector<IndexRect> rects = level_rects(scheme, decomposition);
    if (!uses_lifting(decomposition)) {
        filter_up(scheme, decomposition, rects, [&](int, const Band<double>& level) {
            pyramid.levels.push_back(cast<T>(level));
        });
        return pyramid;
    }
    Decomposition<T> storage;
    const Decomposition<T>& from = fitted(decomposition, scheme, rects, storage);
    pyramid.levels.resize(rects.size());
    pyramid.levels[0] = from.approximation;
    for (std::size_t l = 1; l < rects.size(); ++l) {
        Band<T>& level = pyramid.levels[l];
        level.start_x = rects[l].x.first;
        level.start_z = rects[l].z.first;
        lifting_merge<T>(from.degree(), pyramid.levels[l - 1], {&from.details[l - 1], 1}, rects[l],
                         level.values);
    }
    return pyramid;
}

template <class T>
void reconstruct_into(const Decomposition<T>& decomposition, Grid<T>& out) {
    const Scheme scheme = scheme_of(decomposition);
    const std::vector<IndexRect> rects = level_rects(scheme, decomposition);
    if (uses_lifting(decomposition)) {
        Decomposition<T> storage;
        const Decomposition<T>& from = fitted(decomposition, scheme, rects, storage);
        lifting_merge<T>(from.degree(), from.approximation, from.details, rects.back(), out);
        return;
    }
    filter_up(scheme, decomposition, rects, [&](int l, Band<double>& level) {
        if (l == decomposition.levels()) assign(out, level.values);
    });
}

template <class T>
Grid<T> reconstruct(const Decomposition<T>& decomposition) {
    Grid<T> out;
    reconstruct_into(decomposition, out);
    return out;
}

template <class T>
Decomposition<T> to_scaling_form(const Decomposition<T>& decomposition) {
    if (decomposition.form == Form::scaling) return decomposition;
    const Scheme scheme = scheme_of(decomposition);
    const std::vector<IndexRect> rects = level_rects(scheme, decomposition);
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

std::string level_cap_message(int requested, int used, int width, int height, Boundary boundary) {
    if (used >= requested) return {};
    if (boundary == Boundary::repeat)
        return "levels " + std::to_string(requested) + ": a repeated map of " +
               std::to_string(width) + "x" + std::to_string(height) +
               " can be halved while both sides are even; used " + std::to_string(used);
    return "levels " + std::to_string(requested) + ": a map of " + std::to_string(width) + "x" +
           std::to_string(height) + " gains nothing beyond " + std::to_string(used) + "; used " +
           std::to_string(used);
}

#define WAVEFOG_INSTANTIATE(T)                                                               \
    template Result<Decomposition<T>> decompose(const Grid<T>&, const Family&, int, Form,    \
                                                Boundary);                                   \
    template Result<void> decompose_into(const Grid<T>&, const Family&, int, Form, Boundary, \
                                         Decomposition<T>&);                                 \
    template Grid<T> reconstruct(const Decomposition<T>&);                                   \
    template void reconstruct_into(const Decomposition<T>&, Grid<T>&);                       \
    template Decomposition<T> to_scaling_form(const Decomposition<T>&);                      \
    template Pyramid<T> approximations(const Decomposition<T>&);
WAVEFOG_INSTANTIATE(float)
WAVEFOG_INSTANTIATE(double)
#undef WAVEFOG_INSTANTIATE

}  // namespace wavefog
