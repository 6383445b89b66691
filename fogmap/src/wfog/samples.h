// Densities as integers, without loss where they allow it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "wavefog/wavelet/grid.h"

namespace wavefog::wfog {

/// How an integer k of the file becomes a density, the same float on every machine.
struct Scale {
    enum class Kind : std::uint8_t {
        ratio,       ///< float(double(k) / divisor)
        step,        ///< float(double(k) * step)
        float_bits,  ///< the float whose bits are k << shift, or minus that of -k-1 below 0
        table,       ///< values[k]
        companded,   ///< float(step * q(q(double(k)))), q(x) = x + growth * x * |x|
    };
    Kind kind = Kind::ratio;
    std::uint32_t divisor = 255;
    double step = 1;
    unsigned shift = 0;
    std::vector<float> values = {};  ///< rising, at most kMaxTable
    double growth = 0;               ///< of companded steps: more than 0, at most 1

    float density(std::int32_t k) const;
    /// The nearest integer; nothing if the density is too large for 30 bits, or not in the table.
    std::optional<std::int32_t> integer(float density) const;
    /// density() of `count` integers, and integer() of as many densities: false if one has none.
    void densities(const std::int32_t* integers, std::size_t count, float* densities) const;
    bool integers(const float* densities, std::size_t count, std::int32_t* integers) const;
    bool operator==(const Scale&) const = default;
};

/// The largest difference of two arrays of densities, at most one bit of a float above it.
float largest_difference(const float* a, const float* b, std::size_t count);

inline constexpr std::size_t kMaxTable = 1 << 16;

/// Steps of `step` at 0 that become `coarseness` (above 1) times as large up to `most`, or as large
/// as growth allows.
Scale companded_scale(double step, double coarseness, double most);

/// The mean of the binary logarithm of how much coarser the steps are at a map's densities than at
/// 0: what they save, in bits a pixel.
double mean_coarseness(const Scale& companded, const Grid<float>& map);

/// A density that occurs so often is worth its entry in a table.
inline constexpr std::size_t kUsesOfTable = 8;

/// A scale for any floats, bit for bit: a table if a value occurs `uses` times on the mean and all
/// fit into one, else their bits without those that are 0 in all.
Scale exact_scale(const Grid<float>& map, std::size_t uses);

/// The scale of which every density is a value up to `slack` times the largest one: a ratio of 255,
/// 65535, a power of ten or of two, or a divisor of one. A map that a transform has been through
/// has lost its last bits.
std::optional<Scale> ratio_of(const Grid<float>& map, double slack);

/// What "full scale" means for a promise: 1 for maps in steps of 1/255, the range for those in
/// steps of 1/65535, else the range up to the 99.9th percentile, so that a few hot pixels do not
/// loosen the promise for the rest.
double full_scale(const Grid<float>& map, const std::optional<Scale>& ratio);

}  // namespace wavefog::wfog
