#include "smoothness.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "vector_clones.h"

namespace wavefog::wfog {

namespace {

using std::int32_t;
using std::int64_t;
using std::size_t;

/// How many pixels of a row, its ends left out, the mean of the four around them foretells within
/// the bound. `Int` holds four times any integer and the bound.
template <class Int>
[[gnu::always_inline]] inline int32_t count_foretold(const int32_t* above, const int32_t* here,
                                                     const int32_t* below, size_t width,
                                                     Int bound) {
    int32_t count = 0;
    for (size_t i = 1; i + 1 < width; ++i) {
        const Int around = Int(here[i - 1]) + here[i + 1] + above[i] + below[i];
        const Int off = 4 * Int(here[i]) - around;
        count += (off <= 4 * bound ? 1 : 0) & (off >= -4 * bound ? 1 : 0);
    }
    return count;
}

WAVEFOG_VECTOR_CLONES
int32_t count_narrow(const int32_t* above, const int32_t* here, const int32_t* below, size_t width,
                     int32_t bound) {
    return count_foretold(above, here, below, width, bound);
}

/// The sum of the squared distances of integers to the nearest of low, low + step, ...
WAVEFOG_VECTOR_CLONES
double squared_remainders(const int32_t* integers, size_t count, double low, double step) {
    constexpr size_t kLanes = 4;
    std::array<double, kLanes> sums{};
    const double inverse = 1 / step;
    const auto add = [&](size_t i, size_t lane) {
        const double above = static_cast<double>(integers[i]) - low;
        // The nearest multiple: halves do not occur, as steps are odd.
        const double nearest =
            static_cast<double>(static_cast<int32_t>(above * inverse + 0.5)) * step;
        const double off = above - nearest;
        sums[lane] += off * off;
    };
    size_t i = 0;
    for (; i + kLanes <= count; i += kLanes)
        for (size_t lane = 0; lane < kLanes; ++lane) add(i + lane, lane);
    for (; i < count; ++i) add(i, 0);
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

/// The same of integers below 2^21 above `low` and steps below 2^8: those floats and sums of row
/// after row are exact enough for the same result.
WAVEFOG_VECTOR_CLONES
double squared_remainders_narrow(const int32_t* integers, size_t count, int32_t low, int32_t step) {
    constexpr size_t kBlock = 1 << 16;
    double sum = 0;
    const float inverse = 1 / static_cast<float>(step);
    for (size_t begin = 0; begin < count; begin += kBlock) {
        const size_t end = std::min(count, begin + kBlock);
        int32_t squares = 0;
        for (size_t i = begin; i < end; ++i) {
            const int32_t above = integers[i] - low;
            const auto nearest =
                static_cast<int32_t>(static_cast<float>(above) * inverse + 0.5f) * step;
            squares += (above - nearest) * (above - nearest);
        }
        sum += squares;
    }
    return sum;
}

}  // namespace

bool mostly_foretold(const Grid<float>& map, const Scale& scale, int64_t bound, double share) {
    const auto width = size_t(map.cols()), rows = size_t(map.rows());
    if (width < 3 || rows < 3) return false;
    const auto pixels = static_cast<double>((rows - 1) / 2 * (width - 2));
    const int64_t largest = std::max<int64_t>(
        std::abs(int64_t(scale.integer(map.abs().maxCoeff()).value_or(0))), bound);
    const bool narrow = largest < (1 << 27);
    std::array<std::vector<int32_t>, 3> around;
    for (std::vector<int32_t>& row : around) row.resize(width);
    const auto read = [&](size_t row, std::vector<int32_t>& to) {
        scale.integers(map.data() + row * width, width, to.data());
    };
    auto& [above, here, below] = around;
    read(0, above);
    int64_t missed = 0;
    for (size_t row = 1; row + 2 <= rows; row += 2) {
        read(row, here);
        read(row + 1, below);
        const int32_t count =
            narrow ? count_narrow(above.data(), here.data(), below.data(), width,
                                  static_cast<int32_t>(bound))
                   : count_foretold<int64_t>(above.data(), here.data(), below.data(), width, bound);
        missed += int64_t(width) - 2 - count;
        if (!(pixels - static_cast<double>(missed) > share * pixels)) return false;
        std::swap(above, below);
    }
    return true;
}

double prequantised_rms(const Grid<float>& map, const Scale& scale, int64_t bound, bool roughly) {
    const auto width = size_t(map.cols());
    std::vector<int32_t> row(width);
    const int32_t low = scale.integer(map.minCoeff()).value_or(0);
    const int64_t range = int64_t(scale.integer(map.maxCoeff()).value_or(0)) - low;
    const int64_t step = 2 * bound + 1;
    const bool narrow = range < (1 << 21) && step < (1 << 8);
    const Eigen::Index every = roughly && map.rows() >= 256 ? 4 : 1;
    double squares = 0, pixels = 0;
    for (Eigen::Index j = 0; j < map.rows(); j += every) {
        scale.integers(map.data() + size_t(j) * width, width, row.data());
        squares +=
            narrow ? squared_remainders_narrow(row.data(), width, low, static_cast<int32_t>(step))
                   : squared_remainders(row.data(), width, low, static_cast<double>(step));
        pixels += static_cast<double>(width);
    }
    return std::sqrt(squares / pixels) * double(scale.density(1));
}

}  // namespace wavefog::wfog
