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

std::vector<IndexRect> Scheme::level_rects(int width, int height, int levels) const {
    std::vector<IndexRect> rects(static_cast<std::size_t>(levels) + 1);
    rects.back() = {{0, width - 1}, {0, height - 1}};
    for (std::size_t l = rects.size() - 1; l > 0; --l) rects[l - 1] = coarse(rects[l]);
    return rects;
}

Grid<double> Scheme::analyse(Axis axis, Part part, const Grid<double>& in, Range fine) const {
    if (!interval())
        return wavefog::analyse(axis, analysis_taps(part), in, fine, coarse(part, fine), boundary_);
    const IntervalLevel level(fine.size(), family_.degree, part == Part::high);
    const SplineSubspace& space = part == Part::low ? level.approximation : level.details;
    if (axis == Axis::z) return space.project(in);
    return space.project(in.transpose()).transpose();
}

void Scheme::synthesise_into(Axis axis, Part part, const Grid<double>& in, Range fine, Range target,
                             Grid<double>& out) const {
    if (!interval()) {
        wavefog::synthesise_into(axis, synthesis_taps(part), in, coarse(part, fine), target,
                                 boundary_, out);
        return;
    }
    const IntervalLevel level(fine.size(), family_.degree, part == Part::high);
    const SplineSubspace& space = part == Part::low ? level.approximation : level.details;
    if (axis == Axis::z)
        out += space.expand(in);
    else
        out += space.expand(in.transpose()).transpose();
}

Band<double> Scheme::restrict_band(const Band<double>& fine) const {
    const IndexRect from = rect_of(fine), to = coarse(from);
    return {analyse(Axis::z, Part::low, analyse(Axis::x, Part::low, fine.values, from.x), from.z),
            to.x.first, to.z.first};
}

Band<double> Scheme::prolong(const Band<double>& band, const IndexRect& fine,
                             const IndexRect& target) const {
    const IndexRect from = coarse(fine);
    Grid<double> rows = Grid<double>::Zero(target.z.size(), from.x.size());
    synthesise_into(Axis::z, Part::low, cropped(band, from).values, fine.z, target.z, rows);
    Band<double> out{Grid<double>::Zero(target.z.size(), target.x.size()), target.x.first,
                     target.z.first};
    synthesise_into(Axis::x, Part::low, rows, fine.x, target.x, out.values);
    return out;
}

Band<double> Scheme::split(const Band<double>& fine, Detail<double>& detail) const {
    const IndexRect from = rect_of(fine);
    const Grid<double> low = analyse(Axis::x, Part::low, fine.values, from.x);
    const Grid<double> high = analyse(Axis::x, Part::high, fine.values, from.x);
    const Range phi_x = coarse(Part::low, from.x), psi_x = coarse(Part::high, from.x);
    const Range phi_z = coarse(Part::low, from.z), psi_z = coarse(Part::high, from.z);
    detail.phi_psi = {analyse(Axis::z, Part::high, low, from.z), phi_x.first, psi_z.first};
    detail.psi_phi = {analyse(Axis::z, Part::low, high, from.z), psi_x.first, phi_z.first};
    detail.psi_psi = {analyse(Axis::z, Part::high, high, from.z), psi_x.first, psi_z.first};
    return {analyse(Axis::z, Part::low, low, from.z), phi_x.first, phi_z.first};
}

Band<double> Scheme::merge(const Band<double>& band, const Detail<double>& detail,
                           const IndexRect& fine, const IndexRect& target) const {
    const Range phi_x = coarse(Part::low, fine.x), psi_x = coarse(Part::high, fine.x);
    const Range phi_z = coarse(Part::low, fine.z), psi_z = coarse(Part::high, fine.z);
    Grid<double> low = Grid<double>::Zero(target.z.size(), phi_x.size());
    Grid<double> high = Grid<double>::Zero(target.z.size(), psi_x.size());
    const auto along_z = [&](Part part, const Band<double>& from, Range x, Range z,
                             Grid<double>& out) {
        synthesise_into(Axis::z, part, cropped(from, {x, z}).values, fine.z, target.z, out);
    };
    along_z(Part::low, band, phi_x, phi_z, low);
    along_z(Part::high, detail.phi_psi, phi_x, psi_z, low);
    along_z(Part::low, detail.psi_phi, psi_x, phi_z, high);
    along_z(Part::high, detail.psi_psi, psi_x, psi_z, high);
    Band<double> out{Grid<double>::Zero(target.z.size(), target.x.size()), target.x.first,
                     target.z.first};
    synthesise_into(Axis::x, Part::low, low, fine.x, target.x, out.values);
    synthesise_into(Axis::x, Part::high, high, fine.x, target.x, out.values);
    return out;
}

}  // namespace wavefog
