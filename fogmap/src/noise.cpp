#include "wavefog/fogmap/noise.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/noise.hpp>
#include <numbers>

namespace wavefog {
namespace {

constexpr int kPeriod = 289;  // of GLM's lattice
constexpr int kNear = 17;     // of it, for simplices: float32 counts to a millionth there

/// GLM scales by eye: the largest of 20 000 searches uphill in each was 1.198, 1.038 and 1.084 (in
/// three dimensions twice, in four).
constexpr double kPerlin = 1 / 1.2, kSimplex = 1 / 1.04, kTorus = 1 / 1.09;

/// SplitMix64 (Steele, Lea, Flood 2014): the same numbers everywhere, unlike <random>'s
/// distributions.
std::uint64_t next(std::uint64_t& state) {
    std::uint64_t z = state += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

Result<void> check(const NoiseOptions& options) {
    const auto within = [](const char* name, double value, double low, double high) {
        return value >= low && value <= high
                   ? Result<void>{}
                   : usage_error(
                         fmt::format("{} is {}; it must be {} to {}", name, value, low, high));
    };
    for (auto ok :
         {within("features", options.features, 1, 256), within("octaves", options.octaves, 1, 16),
          within("gain", options.gain, 0, 1), within("lacunarity", options.lacunarity, 2, 8),
          within("warp", options.warp, 0, 4)})
        if (!ok) return ok;
    return {};
}

}  // namespace

Noise::Octaves Noise::make_octaves(int count, double aspect, std::uint64_t& state) const {
    Octaves octaves;
    // Simplices are smaller than the squares that hold them.
    const double cells = options_.kind == NoiseOptions::Kind::simplex ? 0.6 : 1;
    double across = cells * options_.features, height = 1;
    for (int i = 0; i < count; ++i) {
        const double down = across * aspect;
        Octave octave;
        octave.height = height;
        octave.cells = {across, down};
        if (options_.tile && options_.kind == NoiseOptions::Kind::perlin)
            octave.cells[1] = std::max(1.0, std::round(down));
        for (double& place : octave.elsewhere) place = static_cast<double>(next(state) % kPeriod);
        if (options_.kind == NoiseOptions::Kind::simplex && !options_.tile)
            for (const int axis : {0, 1})
                octave.elsewhere[axis] = std::fmod(octave.elsewhere[axis], kNear);
        octaves.push_back(octave);
        across *= options_.lacunarity;
        height *= options_.gain;
    }
    return octaves;
}

Result<Noise> Noise::create(const NoiseOptions& options, double aspect) {
    if (auto ok = check(options); !ok) return tl::unexpected(ok.error());
    Noise noise;
    noise.options_ = options;
    std::uint64_t state = options.seed;
    noise.octaves_ = noise.make_octaves(options.octaves, aspect, state);
    if (options.warp > 0) {
        const int coarse = std::min(options.octaves, 3);
        noise.warp_u_ = noise.make_octaves(coarse, aspect, state);
        noise.warp_v_ = noise.make_octaves(coarse, aspect, state);
    }
    double heights = 0;
    for (const Octave& octave : noise.octaves_) heights += octave.height;
    noise.scale_ = 1 / heights;
    return noise;
}

/// A level cut through noise of three dimensions, half way between lattice planes: a picture of
/// two-dimensional noise shows its lattice, where it is 0. Tiles of simplex noise lie on a torus in
/// four dimensions, because its triangles have no period along the picture's edges.
double Noise::at(const Octave& octave, double u, double v) const {
    const double x = u * octave.cells[0], y = v * octave.cells[1];
    const Eigen::Array4d& e = octave.elsewhere;
    if (options_.kind == NoiseOptions::Kind::simplex && options_.tile) {
        const auto circle = [](double cells, double turns) -> Eigen::Array2d {
            const double radius = cells / (2 * std::numbers::pi);
            const double angle = 2 * std::numbers::pi * turns;
            return {radius * std::cos(angle), radius * std::sin(angle)};
        };
        const Eigen::Array2d a = circle(octave.cells[0], u), b = circle(octave.cells[1], v);
        return kTorus *
               glm::simplex(glm::dvec4(e[0] + a[0], e[1] + a[1], e[2] + b[0], e[3] + b[1]));
    }
    // In double GLM's 1/7 is below 1/7: every seventh gradient is another, and noise reaches 4.
    if (options_.kind == NoiseOptions::Kind::simplex)
        return kSimplex * double(glm::simplex(glm::vec3(e[0] + x, e[1] + y, e[2] + 0.5)));
    if (options_.tile)
        return kPerlin * glm::perlin(glm::dvec3(x, y, e[2] + 0.5),
                                     glm::dvec3(octave.cells[0], octave.cells[1], kPeriod));
    return kPerlin * glm::perlin(glm::dvec3(e[0] + x, e[1] + y, e[2] + 0.5));
}

double Noise::sum(const Octaves& octaves, double u, double v) const {
    double sum = 0;
    for (const Octave& octave : octaves)
        sum += octave.height * std::clamp(at(octave, u, v), -1.0, 1.0);
    return sum;
}

double Noise::operator()(double u, double v) const {
    if (options_.warp > 0) {
        const Eigen::Array2d shift = options_.warp / octaves_.front().cells *
                                     Eigen::Array2d(sum(warp_u_, u, v), sum(warp_v_, u, v));
        u += shift[0];
        v += shift[1];
    }
    return scale_ * sum(octaves_, u, v);
}

void keep_highest(Grid<float>& map, double coverage) {
    const auto count = static_cast<std::size_t>(map.size());
    const auto dropped = static_cast<std::size_t>((1 - coverage) * static_cast<double>(count));
    if (dropped >= count) {
        map = 0.0f;
        return;
    }
    std::vector<float> sorted(map.data(), map.data() + count);
    const auto at = sorted.begin() + static_cast<std::ptrdiff_t>(dropped);
    std::nth_element(sorted.begin(), at, sorted.end());
    const float low = *at, high = *std::max_element(at, sorted.end());
    if (high > low)
        map = ((map - low) / (high - low)).max(0.0f);
    else
        map = 1.0f;
}

}  // namespace wavefog
