// What method radial's table leaves out between two neighbouring columns.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "cell_ranges.h"
#include "glsl_in_cpp.h"
#include "wavefog/fogmap/bound.h"

namespace wavefog {

/// Distances from the eye's place on the ground between two rows; all optical depths are of
/// horizontal rays without a height profile.
struct RadialStretch {
    int row = 0;               ///< the nearer one
    double near = 0, far = 0;  ///< metres from the first row
    /// Bound on the error of interpolating between columns, and of coarser levels, up to either
    /// end. It only grows: between two distances it is off by the difference at most.
    double angular_near = 0, angular = 0;
    /// Bound on what interpolating between rows adds: to A_1, and to A_2 in metres.
    double radial = 0, radial_2 = 0;
    double relative = 0;        ///< row 0 at the eye: bound on the error per metre from the eye
    double low = 0, low_2 = 0;  ///< the least A_1 and A_2 at `near`
    double high = 0;            ///< the largest A_1 at `far`
    double high_2 = 0;          ///< and A_2
    double density_low = 0;     ///< 1/m, in the stretch
    double density_high = 0;    ///< 1/m
    double slope = 0;           ///< 1/m^2, of the density along rays, at most
    double mass_low = 0;        ///< the least integral of the density over the stretch
    double missing = 0;         ///< of a column that ended, at `far`
};

/// The wedges between a table's columns.
class RadialWedges {
  public:
    /// `layer`: of the tables, one below the other. `eye`: in cells from the map's box.
    RadialWedges(const CellRanges& ranges, const DetailBound& dropped,
                 const shader::RadialBlock& block, const Eigen::Vector2d& eye, int layer,
                 double stops);

    /// -1 and count() - 1 are rays beside the first and the last column.
    int first() const { return -1; }
    int count() const { return block_.size.x; }
    double start() const { return start_; }
    double length() const { return distance_.back(); }
    /// Wider wedges are not bounded.
    bool narrow() const;

    /// Stretches outwards until `visit` returns false. `exit`: where the first ray leaves the map.
    void walk(int wedge, const std::function<bool(const RadialStretch&, double exit)>& visit);

  private:
    struct Column {
        std::vector<double> a1, a2;  ///< at the rows
        double exit = 0;
    };
    struct Sides;
    struct Sum;

    Eigen::Vector2d direction(double angle) const;
    double angle(double a) const;
    Eigen::Vector2d largest_slopes(double a, double b) const;
    const Column& column(int i);
    Sides sides(int wedge) const;
    double dropped(int row, const Eigen::Vector2d& low, const Eigen::Vector2d& high) const;
    void add(const Sides& sides, int row, double from, double to, Sum& sum) const;

    const CellRanges& ranges_;
    const DetailBound& dropped_;
    shader::RadialBlock block_;
    Eigen::Vector2d eye_, cell_;
    int layer_;
    double start_, stops_;
    std::vector<double> distance_;  ///< of the rows
    Column columns_[2];
    int held_[2] = {-2, -2};
};

}  // namespace wavefog
