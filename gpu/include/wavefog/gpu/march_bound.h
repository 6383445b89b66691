// A certified bound on what method march:N leaves out between its samples.
#pragma once

#include "wavefog/fogmap/fog.h"

namespace wavefog {

/// With steps of h metres the mid-point rule is off by at most h^2/8 times the variation of the
/// density's derivative along the ray (Peano kernel), for Haar by h/2 times the variation of the
/// density itself. Both are bounded for every cell, and a segment's sum by heaviest_segment().
/// Further terms: a height profile is held for a step (h/2 times its fall, times the densest fog);
/// a quadratic surface is read bilinearly (the second differences of its coefficients over 8);
/// texture units may weigh in steps of 1/256.
class MarchBound {
  public:
    /// `fog` must pass Fog::validate().
    explicit MarchBound(const Fog& fog);

    /// |tau_march - tau| for every segment of at most `length` metres whose ends differ by at most
    /// `rise` metres in height, of which `samples` are taken.
    double optical_depth(int samples, double length, double rise) const;

  private:
    Grid<float> sampled_;               ///< by blocks: times h^2 (Haar: h) the error per metre
    Grid<float> read_;                  ///< by blocks: the error per metre of reading the map, 1/m
    double block_x_ = 1, block_z_ = 1;  ///< metres
    double jump_ = 0;                   ///< the largest variation across one line between cells
    double densest_ = 0;                ///< 1/m
    bool repeat_ = false, stepped_ = false, held_ = false;
};

}  // namespace wavefog
