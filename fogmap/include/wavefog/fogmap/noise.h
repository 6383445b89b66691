// Fractal noise for fogmaps, from the lattice noises of GLM (gtc/noise).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "wavefog/wavelet/grid.h"
#include "wavefog/wavelet/result.h"

namespace wavefog {

/// A sum of octaves of gradient noise (fractional Brownian motion): octave i has lacunarity^i times
/// as many features and gain^i times the height.
struct NoiseOptions {
    enum class Kind {
        perlin,  ///< on squares
        simplex  ///< on simplices: no direction stands out; GLM's has steps of up to 1/100
    };
    Kind kind = Kind::perlin;
    std::uint64_t seed = 0;
    int features = 4;    ///< banks of the first octave across the width, 1 to 256
    int octaves = 6;     ///< 1 to 16
    double gain = 0.5;   ///< 0 to 1
    int lacunarity = 2;  ///< 2 to 8
    double warp = 0;     ///< how far other noise moves each point, in features, 0 to 4
    bool tile = false;   ///< left edge continues the right one, top the bottom one
};

/// Noise over a picture of a given shape. Safe in several threads at once.
class Noise {
  public:
    /// A usage error names the option that is out of range. `aspect` is height / width; Perlin
    /// tiles have a whole number of features along both.
    static Result<Noise> create(const NoiseOptions& options, double aspect);

    /// Within -1 to 1, mean about 0; u and v in [0, 1] across and down the picture.
    double operator()(double u, double v) const;

  private:
    struct Octave {
        double height;
        Eigen::Array2d cells;      ///< across and down
        Eigen::Array4d elsewhere;  ///< where in the endless noise, by the seed
    };
    using Octaves = std::vector<Octave>;

    Octaves make_octaves(int count, double aspect, std::uint64_t& state) const;
    double at(const Octave& octave, double u, double v) const;
    double sum(const Octaves& octaves, double u, double v) const;

    NoiseOptions options_;
    Octaves octaves_, warp_u_, warp_v_;
    double scale_ = 1;  ///< 1 / sum of heights
};

/// Turns noise (or any values) into fog: the highest `coverage` (0 to 1) of all pixels keep what
/// they rise above the others, scaled so that the highest is 1; the rest becomes 0. Equal values
/// everywhere become 1, unless coverage is 0.
void keep_highest(Grid<float>& map, double coverage);

}  // namespace wavefog
