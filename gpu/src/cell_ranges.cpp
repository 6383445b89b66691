#include "cell_ranges.h"

#include <algorithm>
#include <cmath>

#include "wavefog/wavelet/cell.h"

namespace wavefog {
namespace {

const CellRange kNoFog;

int wrapped(int i, int count) {
    return (i % count + count) % count;
}

struct Span {
    float low = INFINITY, high = -INFINITY;
    void include(double v) {
        low = std::min(low, static_cast<float>(v));
        high = std::max(high, static_cast<float>(v));
    }
    float largest() const { return std::max({-low, high, 0.0f}); }
};

}  // namespace

CellRanges::CellRanges(const Band<float>& map, int degree, Boundary boundary,
                       const Eigen::Vector2d& cell_metres, double factor)
    : degree_(degree),
      width_(map.width() + (boundary == Boundary::zero ? degree : 0)),
      height_(map.height() + (boundary == Boundary::zero ? degree : 0)),
      repeat_(boundary == Boundary::repeat),
      factor_(factor),
      polynomials_(cell_polynomials(map, degree, boundary, width_, height_)) {
    const auto c = [&](int i, int j) {
        if (repeat_) {
            i = wrapped(i, map.width());
            j = wrapped(j, map.height());
        }
        return factor * static_cast<double>(map.at(i, j));
    };
    const double per_x = 1 / cell_metres.x(), per_z = 1 / cell_metres.y();
    const int d = degree, border = repeat_ ? 0 : 1;
    ranges_.reserve(static_cast<std::size_t>(width_ + border) *
                    static_cast<std::size_t>(height_ + border));
    // Coefficients x - d .. x reach cell x.
    for (int z = 0; z < height_ + border; ++z)
        for (int x = 0; x < width_ + border; ++x) {
            Span value, dx, dz, dxx, dxz, dzz, jump_x, jump_z;
            for (int j = z - d; j <= z; ++j)
                for (int i = x - d; i <= x; ++i) {
                    value.include(c(i, j));
                    if (i < x) dx.include((c(i + 1, j) - c(i, j)) * per_x);
                    if (j < z) dz.include((c(i, j + 1) - c(i, j)) * per_z);
                    if (i < x && j < z)
                        dxz.include((c(i + 1, j + 1) - c(i + 1, j) - c(i, j + 1) + c(i, j)) *
                                    per_x * per_z);
                    if (i < x - 1)
                        dxx.include((c(i + 2, j) - 2 * c(i + 1, j) + c(i, j)) * per_x * per_x);
                    if (j < z - 1)
                        dzz.include((c(i, j + 2) - 2 * c(i, j + 1) + c(i, j)) * per_z * per_z);
                }
            if (d == 0) {
                jump_x.include(c(x, z) - c(x - 1, z));
                jump_z.include(c(x, z) - c(x, z - 1));
            } else if (d == 1) {
                for (int k = -1; k <= 0; ++k) {
                    jump_x.include((c(x, z + k) - 2 * c(x - 1, z + k) + c(x - 2, z + k)) * per_x);
                    jump_z.include((c(x + k, z) - 2 * c(x + k, z - 1) + c(x + k, z - 2)) * per_z);
                }
            }
            CellRange range;
            range.low = value.low;
            range.high = value.high;
            if (d > 0) {
                range.x_low = dx.low;
                range.x_high = dx.high;
                range.z_low = dz.low;
                range.z_high = dz.high;
            }
            range.xx = dxx.largest();
            range.xz = dxz.largest();
            range.zz = dzz.largest();
            range.jump_x = jump_x.largest();
            range.jump_z = jump_z.largest();
            largest_ = std::max(largest_, static_cast<double>(value.high));
            ranges_.push_back(range);
        }
}

const CellRange& CellRanges::at(int x, int z) const {
    const int border = repeat_ ? 0 : 1;
    if (repeat_) {
        x = wrapped(x, width_);
        z = wrapped(z, height_);
    } else if (x < 0 || z < 0 || x > width_ || z > height_) {
        return kNoFog;
    }
    return ranges_[static_cast<std::size_t>(z) * static_cast<std::size_t>(width_ + border) +
                   static_cast<std::size_t>(x)];
}

CellRange CellRanges::of(int x0, int x1, int z0, int z1) const {
    CellRange sum = at(x0, z0);
    sum.jump_x = sum.jump_z = 0;
    for (int z = z0; z <= z1; ++z) {
        float jump = 0;
        for (int x = x0; x <= x1; ++x) {
            const CellRange& cell = at(x, z);
            sum.low = std::min(sum.low, cell.low);
            sum.high = std::max(sum.high, cell.high);
            sum.x_low = std::min(sum.x_low, cell.x_low);
            sum.x_high = std::max(sum.x_high, cell.x_high);
            sum.z_low = std::min(sum.z_low, cell.z_low);
            sum.z_high = std::max(sum.z_high, cell.z_high);
            sum.xx = std::max(sum.xx, cell.xx);
            sum.xz = std::max(sum.xz, cell.xz);
            sum.zz = std::max(sum.zz, cell.zz);
            jump = std::max(jump, cell.jump_z);
        }
        if (z > z0) sum.jump_z += jump;
    }
    for (int x = x0 + 1; x <= x1; ++x) {
        float jump = 0;
        for (int z = z0; z <= z1; ++z) jump = std::max(jump, at(x, z).jump_x);
        sum.jump_x += jump;
    }
    return sum;
}

double CellRanges::value(int x, int z, const Eigen::Vector2d& point) const {
    const double u = point.x() - x, v = point.y() - z;
    if (repeat_) {
        x = wrapped(x, width_);
        z = wrapped(z, height_);
    } else if (x < 0 || z < 0 || x >= width_ || z >= height_) {
        return 0;
    }
    const int order = degree_ + 1;
    const float* c = &polynomials_[(static_cast<std::size_t>(z) * static_cast<std::size_t>(width_) +
                                    static_cast<std::size_t>(x)) *
                                   static_cast<std::size_t>(order * order)];
    double sum = 0;
    for (int m = degree_; m >= 0; --m) {
        double row = 0;
        for (int n = degree_; n >= 0; --n) row = row * u + static_cast<double>(c[m * order + n]);
        sum = sum * v + row;
    }
    return factor_ * sum;
}

}  // namespace wavefog
