// A decomposed map in either form, and the way back to approximations.
#pragma once

#include <string>
#include <vector>

#include "wavefog/wavelet/family.h"
#include "wavefog/wavelet/grid.h"

namespace wavefog {

/// Details of one level. Form::wavelet uses the three wavelet bands, whose functions are products
/// of the level's coarse phi and psi (first factor along x, second along z, paper 004 section 3.2);
/// Form::scaling uses `residual` alone, coefficients of scaling functions of the finer grid.
template <class T>
struct Detail {
    Band<T> phi_psi;   ///< phi(x) psi(z): varies fast along z ("horizontal" edges)
    Band<T> psi_phi;   ///< psi(x) phi(z): varies fast along x
    Band<T> psi_psi;   ///< psi(x) psi(z)
    Band<T> residual;  ///< r = c_finer - P a (stability.md, conclusion 1)
};

/// Levels are numbered as in the paper: l = 0 is the approximation, l = 1..J the details from
/// coarse to fine; `details[l - 1]` holds level l.
///
/// Coordinates: the finest map c has indices 0..width-1, 0..height-1 and the field is
///     f(u, v) = sum c(i, j) phi(u - i) phi(v - j),   phi = causal B-spline, support [0, d + 1].
/// So pixel i is centred at u = i + (d + 1) / 2, and the rectangle's left edge lies at u = d / 2.
/// An approximation after J - l coarsenings uses phi(u / 2^(J-l) - k): cells nest dyadically, with
/// all knots on integers of u.
template <class T>
struct Decomposition {
    Family family;
    Form form = Form::wavelet;
    Boundary boundary = Boundary::zero;
    int width = 0;   ///< of the finest map, pixels
    int height = 0;  ///< of the finest map, pixels
    Band<T> approximation;
    std::vector<Detail<T>> details;

    int levels() const { return static_cast<int>(details.size()); }
    int degree() const { return family.degree; }
};

/// The approximation at every level: `levels[l]`, l = 0 coarsest .. J = the finest map itself.
/// levels[l] lives on cells of 2^(J-l) finest cells.
template <class T>
struct Pyramid {
    int degree = 1;
    Boundary boundary = Boundary::zero;
    int width = 0;
    int height = 0;
    std::vector<Band<T>> levels;

    int detail_levels() const { return static_cast<int>(levels.size()) - 1; }
    /// Cells of level l that cover the box [0, width + d] x [0, height + d] (zero boundary) or one
    /// period (repeat).
    int cells_x(int l) const { return cells(width, l); }
    int cells_z(int l) const { return cells(height, l); }

  private:
    int cells(int n, int l) const {
        const int extent = boundary == Boundary::zero ? n + degree : n;
        const int size = 1 << (detail_levels() - l);
        return (extent + size - 1) / size;
    }
};

/// Mallat's transform, non-standard decomposition (paper 004, section 3.2).
/// `levels` >= 0 is capped by max_levels(); Decomposition::levels() tells what was used.
/// Kind::positive exists in Form::scaling only (usage error otherwise).
/// Works for every size from 1x1 up. T = float or double.
template <class T>
Result<Decomposition<T>> decompose(const Grid<T>& map, const Family& family, int levels,
                                   Form form = Form::wavelet, Boundary boundary = Boundary::zero);

/// The finest map; the inverse of decompose up to rounding (float: 16 * 2^-24 of the maximum for
/// the default families).
template <class T>
Grid<T> reconstruct(const Decomposition<T>& decomposition);

/// The same into existing objects. With 1,1 and 2,2 in wavelet form and zero extension, storage of
/// the right size is used again: a map that changes every frame costs no allocation and no page
/// faults. `out` is unchanged after an error.
template <class T>
Result<void> decompose_into(const Grid<T>& map, const Family& family, int levels, Form form,
                            Boundary boundary, Decomposition<T>& out);
template <class T>
void reconstruct_into(const Decomposition<T>& decomposition, Grid<T>& out);

/// Turns the three wavelet bands of every level into one residual grid a level (paper 004, 4.4).
template <class T>
Decomposition<T> to_scaling_form(const Decomposition<T>& decomposition);

/// Approximations of all levels, synthesised from the coarsest one up.
template <class T>
Pyramid<T> approximations(const Decomposition<T>& decomposition);

/// The largest number of levels that gains anything: ceil(log2(max side)) with zero extension; with
/// repeat, how often both sides halve evenly.
int max_levels(int width, int height, Boundary boundary);

/// The same for a family, the cap that decompose() uses. Chui-Wang with zero extension stops where
/// no coarse B-spline fits into the shorter side: floor((n - d) / 2) of n are left on each level,
/// so a side of at most d + 1 pixels allows no level at all.
int max_levels(const Family& family, int width, int height, Boundary boundary);

/// What to tell a user who asked for more levels than Decomposition::levels(); empty if not capped.
std::string level_cap_message(int requested, int used, int width, int height,
                              Boundary boundary = Boundary::zero);

}  // namespace wavefog
