#include "tile_errors.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "vector_clones.h"

namespace wavefog::wfog {

using std::size_t;

void Errors::add(const Errors& other) {
    most = std::max(most, other.most);
    squares += other.squares;
    negative = negative || other.negative;
}

WAVEFOG_VECTOR_CLONES
Errors errors_of(const float* original, const float* decoded, size_t count) {
    // Sums of every fourth pixel, side by side: an order that vectors can keep.
    constexpr size_t kLanes = 4;
    std::array<double, kLanes> most{}, squares{};
    int negative = 0;
    const auto add = [&](size_t i, size_t lane) {
        const double a = double(original[i]), b = double(decoded[i]);
        const double error = std::fabs(a - b);
        most[lane] = most[lane] < error ? error : most[lane];
        squares[lane] += error * error;
        negative |= (a >= 0 ? 1 : 0) & (b < 0 ? 1 : 0);
    };
    size_t i = 0;
    for (; i + kLanes <= count; i += kLanes)
        for (size_t lane = 0; lane < kLanes; ++lane) add(i + lane, lane);
    for (; i < count; ++i) add(i, 0);
    return {*std::max_element(most.begin(), most.end()),
            (squares[0] + squares[1]) + (squares[2] + squares[3]), negative != 0};
}

bool TileErrors::add(size_t tile, const Place& place, const Tile& values) {
    const auto width = size_t(place.width);
    std::vector<std::int32_t> integers(exact_ ? width : 0);
    std::vector<float> densities(width);
    Errors errors;
    for (int j = 0; j < place.height; ++j) {
        const size_t at = place.index(j, static_cast<int>(map_.cols()));
        const float* const original = map_.data() + at;
        if (exact_ && !(scale_.integers(original, width, integers.data()) &&
                        std::equal(integers.begin(), integers.end(), values.row(j))))
            return false;
        float* const row = decoded_ ? decoded_->data() + at : densities.data();
        scale_.densities(values.row(j), width, row);
        errors.add(errors_of(original, row, width));
    }
    errors_[tile] = errors;
    return true;
}

Errors TileErrors::sum() const {
    Errors sum;
    for (const Errors& each : errors_) sum.add(each);
    return sum;
}

}  // namespace wavefog::wfog
