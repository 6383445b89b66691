#include "scheme.h"

#include "chui_wang.h"

namespace wavefog {

Result<Scheme> Scheme::make(const Family& family, Boundary boundary) {
    if (family.degree < 0 || family.degree > max_degree)
        return usage_error("degree " + std::to_string(family.degree) + ": use 0 to " +
                           std::to_string(max_degree));
    Scheme scheme;
    scheme.family_ = family;
    scheme.boundary_ = boundary;
    if (!scheme.interval()) {
        Result<Filters> bank = filters(family);
        if (!bank) return tl::unexpected<Error>(bank.error());
        scheme.filters_ = std::move(*bank);
    }
    return scheme;
}

Range Scheme::coarse(Part part, Range fine) const {
    if (boundary_ == Boundary::repeat) return {0, fine.size() / 2 - 1};
    if (interval()) {
        const int low = IntervalLevel::coarse_size(fine.size(), family_.degree);
        return {0, (part == Part::low ? low : fine.size() - low) - 1};
    }
    return analysed_range(analysis_taps(part), fine);
}

Range Scheme::synthesised(Range fine) const {
    if (boundary_ == Boundary::repeat || interval()) return fine;
    // Q high reaches no further: it equals -P low outside `fine`.
    return hull(fine, synthesised_range(filters_.p, coarse(Part::low, fine)));
}

std::vector<Rect> Scheme::level_rects(int width, int height, int levels) const {
    std::vector<Rect> rects(static_cast<std::size_t>(levels) + 1);
    rects.back() = {{0, width - 1}, {0, height - 1}};
    for (std::size_t l = rects.size() - 1; l > 0; --l) rects[l - 1] = coarse(rects[l]);
    return rects;
}

template <class T>
Grid<T> Scheme::analyse(Axis axis, Part part, const Grid<T>& in, Range fine) const {
    if (!interval())
        return wavefog::analyse(axis, analysis_taps(part), in, fine, coarse(part, fine), boundary_);
    const IntervalLevel level(fine.size(), family_.degree, part == Part::high);
    const SplineSubspace& space = part == Part::low ? level.approximation : level.details;
    if (axis == Axis::z) return space.project(in.template cast<double>()).template cast<T>();
    return space.project(in.transpose().template cast<double>()).transpose().template cast<T>();
}

template <class T>
void Scheme::synthesise_into(Axis axis, Part part, const Grid<T>& in, Range fine, Range target,
                             Grid<T>& out) const {
    if (!interval()) {
        wavefog::synthesise_into(axis, synthesis_taps(part), in, coarse(part, fine), target,
                                 boundary_, out);
        return;
    }
    const IntervalLevel level(fine.size(), family_.degree, part == Part::high);
    const SplineSubspace& space = part == Part::low ? level.approximation : level.details;
    if (axis == Axis::z)
        out += space.expand(in.template cast<double>()).template cast<T>();
    else
        out += space.expand(in.transpose().template cast<double>()).transpose().template cast<T>();
}

template <class T>
Band<T> Scheme::restrict_band(const Band<T>& fine) const {
    const Rect from = rect_of(fine), to = coarse(from);
    return {analyse(Axis::z, Part::low, analyse(Axis::x, Part::low, fine.values, from.x), from.z),
            to.x.first, to.z.first};
}

template <class T>
Band<T> Scheme::prolong(const Band<T>& band, const Rect& fine, const Rect& target) const {
    const Rect from = coarse(fine);
    Grid<T> rows = Grid<T>::Zero(target.z.size(), from.x.size());
    synthesise_into(Axis::z, Part::low, cropped(band, from).values, fine.z, target.z, rows);
    Band<T> out{Grid<T>::Zero(target.z.size(), target.x.size()), target.x.first, target.z.first};
    synthesise_into(Axis::x, Part::low, rows, fine.x, target.x, out.values);
    return out;
}

template <class T>
Band<T> Scheme::split(const Band<T>& fine, Detail<T>& detail) const {
    const Rect from = rect_of(fine);
    const Grid<T> low = analyse(Axis::x, Part::low, fine.values, from.x);
    const Grid<T> high = analyse(Axis::x, Part::high, fine.values, from.x);
    const Range phi_x = coarse(Part::low, from.x), psi_x = coarse(Part::high, from.x);
    const Range phi_z = coarse(Part::low, from.z), psi_z = coarse(Part::high, from.z);
    detail.phi_psi = {analyse(Axis::z, Part::high, low, from.z), phi_x.first, psi_z.first};
    detail.psi_phi = {analyse(Axis::z, Part::low, high, from.z), psi_x.first, phi_z.first};
    detail.psi_psi = {analyse(Axis::z, Part::high, high, from.z), psi_x.first, psi_z.first};
    return {analyse(Axis::z, Part::low, low, from.z), phi_x.first, phi_z.first};
}

template <class T>
Band<T> Scheme::merge(const Band<T>& band, const Detail<T>& detail, const Rect& fine,
                      const Rect& target) const {
    const Range phi_x = coarse(Part::low, fine.x), psi_x = coarse(Part::high, fine.x);
    const Range phi_z = coarse(Part::low, fine.z), psi_z = coarse(Part::high, fine.z);
    Grid<T> low = Grid<T>::Zero(target.z.size(), phi_x.size());
    Grid<T> high = Grid<T>::Zero(target.z.size(), psi_x.size());
    const auto along_z = [&](Part part, const Band<T>& from, Range x, Range z, Grid<T>& out) {
        synthesise_into(Axis::z, part, cropped(from, {x, z}).values, fine.z, target.z, out);
    };
    along_z(Part::low, band, phi_x, phi_z, low);
    along_z(Part::high, detail.phi_psi, phi_x, psi_z, low);
    along_z(Part::low, detail.psi_phi, psi_x, phi_z, high);
    along_z(Part::high, detail.psi_psi, psi_x, psi_z, high);
    Band<T> out{Grid<T>::Zero(target.z.size(), target.x.size()), target.x.first, target.z.first};
    synthesise_into(Axis::x, Part::low, low, fine.x, target.x, out.values);
    synthesise_into(Axis::x, Part::high, high, fine.x, target.x, out.values);
    return out;
}

#define WAVEFOG_INSTANTIATE(T)                                                                 \
    template Grid<T> Scheme::analyse(Axis, Part, const Grid<T>&, Range) const;                 \
    template void Scheme::synthesise_into(Axis, Part, const Grid<T>&, Range, Range, Grid<T>&)  \
        const;                                                                                 \
    template Band<T> Scheme::restrict_band(const Band<T>&) const;                              \
    template Band<T> Scheme::prolong(const Band<T>&, const Rect&, const Rect&) const;          \
    template Band<T> Scheme::split(const Band<T>&, Detail<T>&) const;                          \
    template Band<T> Scheme::merge(const Band<T>&, const Detail<T>&, const Rect&, const Rect&) \
        const;
WAVEFOG_INSTANTIATE(float)
WAVEFOG_INSTANTIATE(double)
#undef WAVEFOG_INSTANTIATE

}  // namespace wavefog
