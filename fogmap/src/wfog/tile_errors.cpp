#include "tile_errors.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>
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
    std::uint32_t signs = 0;  // -0 is seen as well
    for (size_t i = 0; i < count; ++i) signs |= std::bit_cast<std::uint32_t>(decoded[i]);
    bool negative = false;
    for (size_t i = 0; i < count && signs >> 31 != 0; ++i)
        negative = negative || (original[i] >= 0 && decoded[i] < 0);
    // Of every eighth pixel, side by side: an order that vectors can keep. The bits of floats that
    // are not negative rise with them, and compare as fast as integers.
    constexpr size_t kLanes = 8;
    std::array<double, kLanes> squares{};
    std::array<std::int32_t, kLanes> most{};
    const auto add = [&](size_t i, size_t lane) {
        const float error = std::fabs(original[i] - decoded[i]);
        squares[lane] += double(error) * double(error);
        const auto bits = std::bit_cast<std::int32_t>(error);
        most[lane] = most[lane] < bits ? bits : most[lane];
    };
    size_t i = 0;
    for (; i + kLanes <= count; i += kLanes)
        for (size_t lane = 0; lane < kLanes; ++lane) add(i + lane, lane);
    for (; i < count; ++i) add(i, 0);
    // A difference is at most the float after the one that it was rounded to.
    const std::int32_t largest = *std::max_element(most.begin(), most.end());
    return {double(std::bit_cast<float>(largest == 0 ? 0 : largest + 1)),
            std::accumulate(squares.begin(), squares.end(), 0.0), negative};
}

bool TileErrors::add(size_t tile, const Place& place, const Tile& values) {
    const auto width = size_t(place.width);
    std::vector<std::int32_t> integers(exact_ ? width : 0);
    std::vector<float> densities(width);
    Errors errors;
    for (int j = 0; j < place.height; ++j) {
        const size_t at = place.index(j, static_cast<int>(map_.cols()));
        const float* const original = map_.data() + at;
        float* const row = decoded_ ? decoded_->data() + at : densities.data();
        scale_.densities(values.row(j), width, row);
        if (std::memcmp(row, original, width * sizeof(float)) == 0) continue;  // nothing is lost
        if (exact_ && !(scale_.integers(original, width, integers.data()) &&
                        std::equal(integers.begin(), integers.end(), values.row(j))))
            return false;
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
