#include "ray_errors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numbers>
#include <span>
#include <vector>

#include "line_sums.h"
#include "pixel_errors.h"

namespace wavefog::wfog {

namespace {

/// What to try, one after another: prices of a unit of optical depth, as a multiple of the promised
/// error (up to 1, depth hides nothing; above e, it would have to hide all), and of all of the
/// length, as a share of what that leaves. Which is best differs: low prices of length where errors
/// even out, high ones for steep rays and where errors are alike, high ones of depth in dense fog.
/// The first is within a third of the best.
struct Prices {
    double of_depth, of_length;
};
constexpr Prices kPrices[] = {{1.1, 0.3}, {1, 0.55}, {1.2, 0.1}, {1, 0.8}, {2, 0.3}};
constexpr double kOtherPricesGain = 1.3;
constexpr int kMostTries = 10;  // two or three do, but for files that just keep their promise

/// The fog that rays meet: h where they are lowest, and its integral upwards from there as a
/// multiple of that, metres.
struct Layer {
    double densest = 1, thickness = std::numeric_limits<double>::infinity();
};

Layer layer_above(const Profile& profile, double ground) {
    const double below_base = std::max(profile.base - ground, 0.0);
    switch (profile.kind) {
        case Profile::Kind::slab:
            return {1, std::max(profile.top - std::max(profile.bottom, ground), 0.0)};
        case Profile::Kind::exponential:
            return {profile(ground), below_base + profile.scale};
        case Profile::Kind::linear:
            return {profile(ground),
                    below_base + std::max(profile.top - std::max(profile.base, ground), 0.0) / 2};
        case Profile::Kind::uniform:
            break;
    }
    return {};
}

/// |dtau| <= off + price * tau, 0 < price < 1.
struct Line {
    double off, price;
};

/// Rays whose slopes lie between two. Level, they are up to `longest` metres long, on which h adds
/// up to at most `mean`; along themselves all is up to `stretch` times as much.
struct Slopes {
    double longest, mean, stretch;
    double worst;  ///< bound on |dT|
    std::size_t tries = 0;
    std::vector<Line> lines = {};
};

std::vector<Slopes> all_slopes(const Fog& fog, const Layer& layer, const PixelErrors& pixels,
                               double path) {
    constexpr int count = 400;
    const bool cut = fog.profile.kind == Profile::Kind::slab;  // else fog thins
    std::vector<Slopes> all;
    for (int s = 0; s < count; ++s) {
        // The longer reach of the one and the longer stretch of the other.
        const double slope = std::numbers::pi / 2 * s / count;
        const double steeper = std::numbers::pi / 2 * (s + 1) / count;
        const double reach = s == 0 ? path : std::min(path, layer.thickness / std::sin(slope));
        const double across = std::cos(slope);
        // A steep ray crosses few pixels, so that none of their errors may even out.
        all.push_back({.longest = (cut ? reach : path) * across,
                       .mean = reach * across,
                       .stretch = 1 / std::max(std::cos(steeper), 1e-12),
                       .worst = pixels.worst_change(fog.extinction * layer.densest * reach)});
    }
    return all;
}

/// The largest exp(-tau) (exp(|dtau|) - 1) below all the lines.
double worst_at_any_depth(std::span<const Line> lines) {
    double worst = 0;
    const auto look_at = [&](double depth) {
        depth = std::max(depth, 0.0);
        double change = std::numeric_limits<double>::infinity();
        for (const Line& line : lines) change = std::min(change, line.off + line.price * depth);
        worst = std::max(worst, std::exp(-depth) * std::expm1(change));
    };
    look_at(0);
    for (const Line& a : lines) {
        look_at(-(a.off + std::log1p(-a.price)) / a.price);  // where it is the largest
        for (const Line& b : lines)
            if (b.price > a.price) look_at((a.off - b.off) / (b.price - a.price));
    }
    return worst;
}

/// The largest `off` of a line for which worst_at_any_depth is at most `worst`.
double off_at(double worst, double price) {
    const double depth = std::log(price / (1 - price) / worst);  // where it is the largest
    return depth > 0 ? -std::log1p(-price) - price * depth : std::log1p(worst);
}

}  // namespace

double worst_ray_error(const Fog& fog, const Grid<float>& map, const Grid<float>& error,
                       const WfogOptions& options, int parts) {
    const double path = options.path;
    const PixelErrors pixels(map, error);
    const Layer layer = layer_above(fog.profile, options.ground);
    const double extinction = fog.extinction * layer.densest;
    // Straight up, a ray stays over one pixel: no other can be worse.
    if (!std::isfinite(layer.thickness)) return pixels.worst_change(extinction * path);
    if (extinction * layer.thickness == 0) return 0;
    std::vector<Slopes> all = all_slopes(fog, layer, pixels, path);
    const Decomposition<float>& d = fog.decomposition;
    int tries = 0;
    for (Slopes* worst = &all.front();;) {
        if (worst->worst <= options.error)
            worst = &*std::ranges::max_element(all, {}, &Slopes::worst);
        if (worst->worst <= options.error || worst->tries == std::size(kPrices) ||
            (worst->tries > 0 && worst->worst > options.error * kOtherPricesGain) ||
            ++tries > kMostTries)
            return worst->worst;
        const Prices tried = kPrices[worst->tries++];
        const double of_depth = std::min(options.error * tried.of_depth, 0.9);
        const double price = off_at(options.error, of_depth) * tried.of_length /
                             (extinction * worst->stretch * worst->mean);
        // Of all rays that are not proved yet: their neighbours need no tries of their own.
        const double longest = std::ranges::find_if(all, [&](const Slopes& slopes) {
                                   return slopes.worst > options.error;
                               })->longest;
        const Grid<float> prices = float(price) + float(of_depth) * map;
        const Grid<float> more = error - prices, less = -error - prices;
        const auto field_of = [&](const Grid<float>& pixels) {
            return LineField{.pixels = pixels,
                             .outside = -float(price),
                             .repeats = d.boundary == Boundary::repeat,
                             .degree = d.degree(),
                             .cell_x = fog.cell_x(),
                             .cell_z = fog.cell_z()};
        };
        const LineField fields[] = {field_of(more), field_of(less)};
        const double most = most_along_lines(fields, longest, parts, options.threads, options.stop);
        if (options.stop.stop_requested()) return std::numeric_limits<double>::infinity();
        for (Slopes& slopes : all) {
            if (slopes.longest > longest) continue;
            const double off = slopes.stretch * extinction * (most + price * slopes.mean);
            slopes.lines.push_back({off, of_depth});
            slopes.worst = std::min(slopes.worst, worst_at_any_depth(slopes.lines));
        }
    }
}

}  // namespace wavefog::wfog
