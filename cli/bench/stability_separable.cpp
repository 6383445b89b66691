// What F(x) F(y) F(z) of paper 001, section 3.2.3, is worth: a product of three integrals is not
// the integral of the product.
#include <algorithm>
#include <cmath>

#include "bench/stability.h"
#include "wavefog/fogmap/models.h"
#include "wavefog/fogmap/noise.h"

namespace wavefog::cli {
namespace {

constexpr int kPeriod = 64;  // features in a table
constexpr int kValues = 1024;

/// Perlin noise from 0 to 1 with features of 1 m.
AxisTable noise_axis(std::uint64_t seed) {
    const Noise noise =
        *Noise::create({.seed = seed, .features = kPeriod, .octaves = 3, .tile = true}, 1);
    AxisTable axis{{}, 0, kPeriod, true};
    for (int i = 0; i <= kValues; ++i)
        axis.values.push_back(noise(double(i % kValues) / kValues, 0.5));
    const auto [low, high] = std::minmax_element(axis.values.begin(), axis.values.end());
    const double bottom = *low, range = *high - *low;
    for (double& v : axis.values) v = (v - bottom) / range;
    return axis;
}

/// Waves of 1 m from 0 to 1.
AxisTable wave_axis() {
    AxisTable axis{{}, 0, 1, true};
    for (int i = 0; i <= 64; ++i)
        axis.values.push_back(0.5 + 0.5 * std::cos(2 * 3.14159265358979 * (i % 64) / 64));
    return axis;
}

/// exp(-y) in scales of 4 features, 1 below 0.
AxisTable height_axis() {
    AxisTable axis{{}, 0, 64, false};
    for (int i = 0; i <= 512; ++i) axis.values.push_back(i < 512 ? std::exp(-i / 32.0) : 0);
    return axis;
}

struct Errors {
    double largest = 0, median = 0;
};

/// |ΔT| over rays of this length whose optical depth is about 1, at any place; those of a layer
/// rise or fall by at most a tenth.
Errors errors_of(const std::array<AxisTable, 3>& axes, double length, bool level) {
    Random random(17);
    std::vector<double> differences;
    for (int i = 0; i < 2000; ++i) {
        const Eigen::Vector3d o(random.uniform(0, kPeriod), random.uniform(0, level ? 4 : kPeriod),
                                random.uniform(0, kPeriod));
        const double turn = random.uniform(0, 6.283185307), rise = random.uniform(-1, 1);
        const double up = level ? 0.1 * rise : rise, across = std::sqrt(1 - up * up);
        const Eigen::Vector3d p =
            o + length * Eigen::Vector3d(across * std::cos(turn), up, across * std::sin(turn));
        Separable fog{1, axes, Separable::Integral::exact};
        const double whole = optical_depth(FogModel(fog), o, p);
        if (!(whole > 0)) continue;
        fog.extinction = 1 / whole;
        fog.integral = Separable::Integral::published;
        differences.push_back(
            std::abs(std::exp(-optical_depth(FogModel(fog), o, p)) - std::exp(-1.0)));
    }
    std::sort(differences.begin(), differences.end());
    return {differences.back(), differences[differences.size() / 2]};
}

}  // namespace

Figure study_separable() {
    Figure figure;
    figure.id = "stability-separable";
    figure.title = "F(x)F(y)F(z) is no integral along a ray";
    figure.subtitle =
        "Paper 001, section 3.2.3, against the line integral of the product; 2000 rays of optical "
        "depth 1";
    figure.x.label = "length of the ray, features of the noise";
    figure.y.label = "|ΔT|: largest (solid), median (dashed)";
    figure.levels.push_back({kVisibleError, "least visible\nerror, 1/510"});
    const AxisTable none;
    const struct {
        const char *name, *key;
        std::array<AxisTable, 3> axes;
        bool level;
    } fogs[] = {
        {"three noises (its figure 11)",
         "exact",
         {noise_axis(1), noise_axis(2), noise_axis(3)},
         false},
        {"two noises, exponential height (10)",
         "paper",
         {noise_axis(1), height_axis(), noise_axis(3)},
         true},
        {"cosines in x and z", "march", {wave_axis(), none, wave_axis()}, false},
    };
    for (const auto& fog : fogs) {
        Curve largest{fog.name, fog.key, Curve::Style::line, {}};
        Curve median{"", fog.key, Curve::Style::dashed, {}};
        for (double length = 1.0 / 16; length <= 64; length *= 2) {
            const Errors errors = errors_of(fog.axes, length, fog.level);
            largest.points.emplace_back(length, errors.largest);
            median.points.emplace_back(length, errors.median);
        }
        figure.curves.push_back(std::move(largest));
        figure.curves.push_back(std::move(median));
    }
    return figure;
}

}  // namespace wavefog::cli
