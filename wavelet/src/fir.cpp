#include "fir.h"

#include <vector>

namespace wavefog {
namespace {

int wrapped(int index, int period) {
    const int rest = index % period;
    return rest < 0 ? rest + period : rest;
}

// Position in `range` of a sample index, or -1 where zero extension leaves nothing.
int position(int index, Range range, Boundary boundary) {
    if (boundary == Boundary::repeat) return wrapped(index - range.first, range.size());
    return range.contains(index) ? index - range.first : -1;
}

void analyse_z(const Taps& taps, const Grid<double>& in, Range fine, Range out_range,
               Boundary boundary, Grid<double>& out) {
    for (int k = out_range.first; k <= out_range.last; ++k)
        for (int n = taps.start; n <= taps.last(); ++n) {
            const int row = position(2 * k + n, fine, boundary);
            if (row >= 0)
                out.row(k - out_range.first) +=
                    taps.values[static_cast<std::size_t>(n - taps.start)] * in.row(row);
        }
}

void synthesise_z(const Taps& taps, const Grid<double>& in, Range coarse, Range fine,
                  Boundary boundary, Grid<double>& out) {
    for (int k = coarse.first; k <= coarse.last; ++k)
        for (int n = taps.start; n <= taps.last(); ++n) {
            const int row = position(2 * k + n, fine, boundary);
            if (row >= 0)
                out.row(row) += taps.values[static_cast<std::size_t>(n - taps.start)] *
                                in.row(k - coarse.first);
        }
}

// One line split into even and odd samples, so that every tap is a unit-stride loop.
using Line = Eigen::Array<double, 1, Eigen::Dynamic>;

void analyse_x(const Taps& taps, const Grid<double>& in, Range fine, Range out_range,
               Boundary boundary, Grid<double>& out) {
    const int base = half_down(2 * out_range.first + taps.start);
    const int count = half_down(2 * out_range.last + taps.last()) - base + 1;
    Line phase[2] = {Line::Zero(count), Line::Zero(count)};
    const int size = out_range.size();
    for (Eigen::Index j = 0; j < in.rows(); ++j) {
        for (int i = 0; i < 2 * count; ++i) {
            const int column = position(2 * base + i, fine, boundary);
            phase[i & 1](i / 2) = column >= 0 ? in(j, column) : 0.0;
        }
        for (int n = taps.start; n <= taps.last(); ++n) {
            const int first = 2 * out_range.first + n - 2 * base;
            out.row(j) += taps.values[static_cast<std::size_t>(n - taps.start)] *
                          phase[first & 1].segment(first / 2, size);
        }
    }
}

void synthesise_x(const Taps& taps, const Grid<double>& in, Range coarse, Range fine,
                  Boundary boundary, Grid<double>& out) {
    const int base = half_down(2 * coarse.first + taps.start);
    const int count = half_down(2 * coarse.last + taps.last()) - base + 1;
    Line phase[2] = {Line::Zero(count), Line::Zero(count)};
    const int size = coarse.size();
    for (Eigen::Index j = 0; j < in.rows(); ++j) {
        phase[0].setZero();
        phase[1].setZero();
        for (int n = taps.start; n <= taps.last(); ++n) {
            const int first = 2 * coarse.first + n - 2 * base;
            phase[first & 1].segment(first / 2, size) +=
                taps.values[static_cast<std::size_t>(n - taps.start)] * in.row(j);
        }
        for (int i = 0; i < 2 * count; ++i) {
            const int column = position(2 * base + i, fine, boundary);
            if (column >= 0) out(j, column) += phase[i & 1](i / 2);
        }
    }
}

}  // namespace

Range analysed_range(const Taps& taps, Range fine) {
    const Range range{half_up(fine.first - taps.last()), half_down(fine.last - taps.start)};
    if (range.size() > 0) return range;
    // Interpolating taps can miss a lone sample: keep one zero so that no band is ever empty.
    return {half_down(fine.first), half_down(fine.first)};
}

Range synthesised_range(const Taps& taps, Range coarse) {
    return {2 * coarse.first + taps.start, 2 * coarse.last + taps.last()};
}

Grid<double> analyse(Axis axis, const Taps& taps, const Grid<double>& in, Range fine,
                     Range out_range, Boundary boundary) {
    Grid<double> out = Grid<double>::Zero(axis == Axis::z ? out_range.size() : in.rows(),
                                          axis == Axis::x ? out_range.size() : in.cols());
    if (axis == Axis::x)
        analyse_x(taps, in, fine, out_range, boundary, out);
    else
        analyse_z(taps, in, fine, out_range, boundary, out);
    return out;
}

void synthesise_into(Axis axis, const Taps& taps, const Grid<double>& in, Range coarse, Range fine,
                     Boundary boundary, Grid<double>& out) {
    if (axis == Axis::x)
        synthesise_x(taps, in, coarse, fine, boundary, out);
    else
        synthesise_z(taps, in, coarse, fine, boundary, out);
}

}  // namespace wavefog
