#include "axis_reader.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "wavefog/fogmap/noise.h"

namespace wavefog::detail {
namespace {

/// Values of functions given by a formula, and one more.
constexpr int kCells = 512;

/// f(0 ... 1) across the table.
template <class Function>
std::vector<double> tabulated(const Function& f) {
    std::vector<double> values;
    for (int i = 0; i <= kCells; ++i) values.push_back(f(static_cast<double>(i) / kCells));
    return values;
}

/// A period of Perlin noise, from 0 to 1.
std::vector<double> noise_values(const JsonValue& value) {
    value.only({"seed", "features", "octaves", "gain"});
    NoiseOptions options{.features = value.key("features").integer(1, 128), .tile = true};
    options.octaves = 3;
    if (const auto seed = value.find("seed"))
        options.seed =
            static_cast<std::uint64_t>(seed->integer(0, std::numeric_limits<int>::max()));
    if (const auto octaves = value.find("octaves")) options.octaves = octaves->integer(1, 16);
    if (const auto gain = value.find("gain")) options.gain = gain->number(0, 1);
    const auto noise = Noise::create(options, 1);
    if (!noise) value.fail(noise.error().message);
    auto values = tabulated([&](double u) { return (*noise)(u, 0.5); });
    values.back() = values.front();
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const double bottom = *low, range = std::max(*high - bottom, 1e-300);
    for (double& v : values) v = (v - bottom) / range;
    return values;
}

}  // namespace

AxisTable read_axis(const JsonValue& value) {
    AxisTable axis;
    const auto noise = value.find("noise"), cosine = value.find("cosine"),
               exponential = value.find("exponential");
    if (int(noise.has_value()) + int(cosine.has_value()) + int(exponential.has_value()) +
            int(value.find("values").has_value()) !=
        1)
        value.fail("needs one of \"values\", \"noise\", \"cosine\" and \"exponential\"");
    axis.begin = value.key("begin").number();
    if (exponential) {
        value.only({"exponential", "begin"});
        const double reach = 16;  // scales; e^-16 is less than any picture shows
        axis.end = axis.begin + reach * exponential->above(0);
        axis.values = tabulated([&](double u) { return std::exp(-reach * u); });
        axis.values.back() = 0;
        return axis;
    }
    axis.end = value.key("end").number();
    if (noise) {
        value.only({"noise", "begin", "end"});
        axis.values = noise_values(*noise);
        axis.repeat = true;
    } else if (cosine) {
        value.only({"cosine", "begin", "end"});
        const double share = cosine->number(-1, 1);
        axis.values = tabulated([&](double u) {
            return (1 + share * std::cos(2 * std::numbers::pi * u)) / (1 + std::abs(share));
        });
        axis.values.back() = axis.values.front();
        axis.repeat = true;
    } else {
        value.only({"values", "begin", "end", "outside"});
        for (const JsonValue& v : value.key("values").items()) axis.values.push_back(v.number());
        if (axis.values.empty()) value.key("values").fail("is empty; give at least two");
        if (const auto outside = value.find("outside"))
            axis.repeat = outside->choice({"hold", "repeat"}) == 1;
    }
    return axis;
}

}  // namespace wavefog::detail
