// The array types that everything else is made of.
#pragma once

#include <Eigen/Core>
#include <cstdint>

namespace wavefog {

/// Row-major 2-D array: `g(j, i)`, row j runs along +z, column i along +x (image order).
template <class T>
using Grid = Eigen::Array<T, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Coefficients of integer translates of one function. `values(j, i)` multiplies the function of
/// index (start_x + i, start_z + j). Zero extension makes the indices of coarse levels negative.
template <class T>
struct Band {
    Grid<T> values;
    int start_x = 0;
    int start_z = 0;

    int width() const { return static_cast<int>(values.cols()); }
    int height() const { return static_cast<int>(values.rows()); }
    /// The coefficient of index (kx, kz), 0 outside the stored range.
    T at(int kx, int kz) const {
        const int i = kx - start_x, j = kz - start_z;
        return i >= 0 && j >= 0 && i < width() && j < height() ? values(j, i) : T(0);
    }
};

/// What lies outside the map.
enum class Boundary {
    zero,    ///< Coefficients are 0 outside; the field ends at 0, d/2 cells past the rectangle.
    repeat,  ///< The map tiles the plane.
};

}  // namespace wavefog
