#include "wavefog/wavelet/standard.h"

#include <cassert>

#include "scheme.h"

namespace wavefog {
namespace {

// Ranges of the approximations along one axis, coarsest first.
std::vector<Range> axis_ranges(const Scheme& scheme, int size, int levels) {
    std::vector<Range> ranges(static_cast<std::size_t>(levels) + 1);
    ranges.back() = {0, size - 1};
    for (std::size_t l = ranges.size() - 1; l > 0; --l)
        ranges[l - 1] = scheme.coarse(Part::low, ranges[l]);
    return ranges;
}

// Range of the coefficients in part l: the approximation (0) or the details 1..levels.
Range part_range(const Scheme& scheme, const std::vector<Range>& ranges, std::size_t l) {
    return l == 0 ? ranges[0] : scheme.coarse(Part::high, ranges[l]);
}

std::vector<Grid<double>> analyse_axis(const Scheme& scheme, Axis axis, Grid<double> fine,
                                       const std::vector<Range>& ranges) {
    std::vector<Grid<double>> parts(ranges.size());
    for (std::size_t l = ranges.size() - 1; l > 0; --l) {
        parts[l] = scheme.analyse(axis, Part::high, fine, ranges[l]);
        fine = scheme.analyse(axis, Part::low, fine, ranges[l]);
    }
    parts[0] = std::move(fine);
    return parts;
}

Grid<double> synthesise_axis(const Scheme& scheme, Axis axis,
                             const std::vector<Grid<double>>& parts,
                             const std::vector<Range>& ranges) {
    Grid<double> fine = parts[0];
    for (std::size_t l = 1; l < ranges.size(); ++l) {
        const Eigen::Index size = ranges[l].size();
        Grid<double> next = Grid<double>::Zero(axis == Axis::z ? size : fine.rows(),
                                               axis == Axis::x ? size : fine.cols());
        scheme.synthesise_into(axis, Part::low, fine, ranges[l], ranges[l], next);
        scheme.synthesise_into(axis, Part::high, parts[l], ranges[l], ranges[l], next);
        fine = std::move(next);
    }
    return fine;
}

}  // namespace

template <class T>
Result<StandardDecomposition<T>> decompose_standard(const Grid<T>& map, const Family& family,
                                                    int levels, Boundary boundary) {
    if (map.rows() < 1 || map.cols() < 1)
        return usage_error("map: has no pixels; give at least 1x1");
    if (levels < 0)
        return usage_error("levels " + std::to_string(levels) +
                           ": must not be negative; use 0 or more");
    if (family.kind == Family::Kind::positive)
        return usage_error("family positive: has no wavelets; use another one");
    const Result<Scheme> scheme = Scheme::make(family, boundary);
    if (!scheme) return tl::unexpected<Error>(scheme.error());

    StandardDecomposition<T> out;
    out.family = family;
    out.boundary = boundary;
    out.width = static_cast<int>(map.cols());
    out.height = static_cast<int>(map.rows());
    out.levels_x = std::min(levels, max_levels(family, out.width, out.width, boundary));
    out.levels_z = std::min(levels, max_levels(family, out.height, out.height, boundary));
    const std::vector<Range> xs = axis_ranges(*scheme, out.width, out.levels_x);
    const std::vector<Range> zs = axis_ranges(*scheme, out.height, out.levels_z);
    out.bands.resize(xs.size() * zs.size());
    const auto along_x = analyse_axis(*scheme, Axis::x, map.template cast<double>(), xs);
    for (int lx = 0; lx <= out.levels_x; ++lx) {
        const auto x = static_cast<std::size_t>(lx);
        const auto along_z = analyse_axis(*scheme, Axis::z, along_x[x], zs);
        for (int lz = 0; lz <= out.levels_z; ++lz) {
            const auto z = static_cast<std::size_t>(lz);
            out.band(lx, lz) = {along_z[z].template cast<T>(), part_range(*scheme, xs, x).first,
                                part_range(*scheme, zs, z).first};
        }
    }
    return out;
}

template <class T>
Grid<T> reconstruct_standard(const StandardDecomposition<T>& decomposition) {
    const Result<Scheme> scheme = Scheme::make(decomposition.family, decomposition.boundary);
    assert(scheme.has_value());
    const std::vector<Range> xs = axis_ranges(*scheme, decomposition.width, decomposition.levels_x);
    const std::vector<Range> zs =
        axis_ranges(*scheme, decomposition.height, decomposition.levels_z);
    std::vector<Grid<double>> along_x(xs.size()), along_z(zs.size());
    for (std::size_t x = 0; x < xs.size(); ++x) {
        for (std::size_t z = 0; z < zs.size(); ++z) {
            const Band<T>& band = decomposition.band(static_cast<int>(x), static_cast<int>(z));
            along_z[z] = cropped(band, {part_range(*scheme, xs, x), part_range(*scheme, zs, z)})
                             .values.template cast<double>();
        }
        along_x[x] = synthesise_axis(*scheme, Axis::z, along_z, zs);
    }
    return synthesise_axis(*scheme, Axis::x, along_x, xs).template cast<T>();
}

template Result<StandardDecomposition<float>> decompose_standard(const Grid<float>&, const Family&,
                                                                 int, Boundary);
template Result<StandardDecomposition<double>> decompose_standard(const Grid<double>&,
                                                                  const Family&, int, Boundary);
template Grid<float> reconstruct_standard(const StandardDecomposition<float>&);
template Grid<double> reconstruct_standard(const StandardDecomposition<double>&);

}  // namespace wavefog
