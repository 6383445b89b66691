// A terrain's heights from a picture, as a smooth function of world x and z.
#pragma once

#include "wavefog/fogmap/scene.h"
#include "wavefog/wavelet/grid.h"

namespace wavefog {

/// Heights between pixel centres are bicubic (Catmull-Rom, through the pixels); outside the
/// outermost centres the border pixel continues.
class HeightField {
  public:
    /// The picture's least and greatest pixel become terrain.height_min and height_max. Steps of
    /// 8-bit pictures are smoothed, each height staying within half a step of its pixel.
    static Result<HeightField> load(const Terrain& terrain);
    /// Heights in metres, one a pixel (row j along +z).
    HeightField(Grid<float> heights, const Rect& rect)
        : heights_(std::move(heights)), rect_(rect) {}

    /// World metres.
    double height(double x, double z) const;
    const Rect& rect() const { return rect_; }
    int columns() const { return int(heights_.cols()); }
    int rows() const { return int(heights_.rows()); }

  private:
    Grid<float> heights_;
    Rect rect_;
};

}  // namespace wavefog
