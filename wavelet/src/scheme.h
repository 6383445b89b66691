// One level of the transform for a family and a boundary: ranges, splitting and merging.
#pragma once

#include <vector>

#include "fir.h"
#include "range.h"
#include "wavefog/wavelet/decomposition.h"
#include "wavefog/wavelet/filters.h"

namespace wavefog {

/// Which half of a level: scaling functions phi or wavelets psi.
enum class Part { low, high };

/// A family made ready for use. All transforms are built from analyse() and synthesise() along one
/// axis; Chui-Wang with zero extension solves banded systems, everything else filters.
class Scheme {
  public:
    static Result<Scheme> make(const Family& family, Boundary boundary);

    /// Indices of the coarser level's coefficients for fine coefficients on `fine`.
    Range coarse(Part part, Range fine) const;
    IndexRect coarse(const IndexRect& fine) const {
        return {coarse(Part::low, fine.x), coarse(Part::low, fine.z)};
    }
    /// Where fine = P low + Q high can be nonzero.
    Range synthesised(Range fine) const;
    IndexRect synthesised(const IndexRect& fine) const {
        return {synthesised(fine.x), synthesised(fine.z)};
    }
    /// Rectangles of the approximations, result[l] for l = 0 (coarsest) .. levels.
    std::vector<IndexRect> level_rects(int width, int height, int levels) const;

    /// Coefficients of one part along one axis, of a grid that covers `fine` along it.
    Grid<double> analyse(Axis axis, Part part, const Grid<double>& in, Range fine) const;
    /// out += the part's functions in fine coefficients on `target`; the fine level was `fine`.
    void synthesise_into(Axis axis, Part part, const Grid<double>& in, Range fine, Range target,
                         Grid<double>& out) const;

    /// The coarse approximation alone.
    Band<double> restrict_band(const Band<double>& fine) const;
    /// P a on `target`, for a the approximation of a level that covered `fine`.
    Band<double> prolong(const Band<double>& coarse, const IndexRect& fine,
                         const IndexRect& target) const;
    /// Approximation (returned) and three wavelet bands.
    Band<double> split(const Band<double>& fine, Detail<double>& detail) const;
    /// The inverse of split, on `target`.
    Band<double> merge(const Band<double>& coarse, const Detail<double>& detail,
                       const IndexRect& fine, const IndexRect& target) const;

  private:
    bool interval() const {
        return family_.kind == Family::Kind::chui_wang && boundary_ == Boundary::zero;
    }
    const Taps& analysis_taps(Part part) const {
        return part == Part::low ? filters_.h : filters_.g;
    }
    const Taps& synthesis_taps(Part part) const {
        return part == Part::low ? filters_.p : filters_.q;
    }

    Family family_;
    Boundary boundary_ = Boundary::zero;
    Filters filters_;  // unused by interval()
};

}  // namespace wavefog
