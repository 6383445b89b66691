#include "ray_errors.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "parallel.h"
#include "pixel_errors.h"
#include "ray_segments.h"

namespace wavefog::wfog {

namespace {

constexpr double kBetweenLines = 1.1;
/// Samples of one estimate at most: larger maps get fewer lines.
constexpr double kMostSamples = 1e7;
/// Cells of rectangles so long and thin are no fog.
constexpr double kMostCells = 1e12;

/// The error field at a place in cells, pixel (0, 0) at 0. For degrees above 1 the field is an
/// average of shifted copies of this one, so that no ray through it is worse.
class Field {
  public:
    Field(const Grid<float>& map, int degree, Boundary boundary)
        : map_(map), nearest_(degree == 0), repeats_(boundary == Boundary::repeat) {}

    double at(double x, double z) const {
        if (nearest_)
            return pixel(static_cast<Eigen::Index>(std::floor(x + 0.5)),
                         static_cast<Eigen::Index>(std::floor(z + 0.5)));
        // Truncation rounds down: all places inside are above -kPast.
        const auto i = static_cast<Eigen::Index>(x + kPast) - kPast;
        const auto j = static_cast<Eigen::Index>(z + kPast) - kPast;
        const double a = x - double(i), b = z - double(j);
        return (pixel(i, j) * (1 - a) + pixel(i + 1, j) * a) * (1 - b) +
               (pixel(i, j + 1) * (1 - a) + pixel(i + 1, j + 1) * a) * b;
    }

  private:
    static constexpr Eigen::Index kPast = 1 << 20;

    double pixel(Eigen::Index x, Eigen::Index z) const {
        if (repeats_) {
            x = (x % map_.cols() + map_.cols()) % map_.cols();
            z = (z % map_.rows() + map_.rows()) % map_.rows();
        }
        if (x < 0 || z < 0 || x >= map_.cols() || z >= map_.rows()) return 0;
        return double(map_(z, x));
    }

    const Grid<float>& map_;
    const bool nearest_, repeats_;
};

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

}  // namespace

double worst_ray_error(const Fog& fog, const Grid<float>& map, const Grid<float>& error,
                       const WfogOptions& options, int angles) {
    const double path = options.path;
    const PixelErrors pixels(map, error);
    const Layer layer = layer_above(fog.profile, options.ground);
    const double extinction = fog.extinction * layer.densest;
    // Straight up, a ray stays over one pixel: no other can be worse.
    if (!std::isfinite(layer.thickness)) return pixels.worst_change(extinction * path);
    if (extinction * layer.thickness == 0) return 0;
    const Decomposition<float>& d = fog.decomposition;
    const Field field(error, d.degree(), d.boundary), densities(map, d.degree(), d.boundary);
    // Places and directions are in cells, lengths along lines in metres.
    const double cell_x = fog.cell_x(), cell_z = fog.cell_z();
    const double least = std::min(cell_x, cell_z), most = std::max(cell_x, cell_z);
    const double radius = std::hypot(d.width, d.height) / 2 + 2;
    const double x0 = std::floor(d.width / 2), z0 = std::floor(d.height / 2);
    // Over tiles, a very long ray is several long ones; beside a map there is no fog.
    const bool repeats = d.boundary == Boundary::repeat;
    const double longest = std::min(path, repeats ? 8 * radius * least : 2 * radius * most);
    if (!(longest / least < kMostCells)) return pixels.worst_change(extinction * path);

    const RaySegments none(longest, least, extinction);
    std::vector<RaySegments> by_angle(static_cast<std::size_t>(angles), none);
    for_each_parallel(by_angle.size(), options.threads, options.stop, [&](std::size_t a, Scratch&) {
        const double angle = std::numbers::pi * double(a) / angles;
        const double ux = std::cos(angle), uz = std::sin(angle);
        const double step = std::hypot(ux * cell_x, uz * cell_z);
        const double end = repeats ? radius + longest / step : radius;
        // Rows, columns and diagonals, along which errors may be alike, are all looked at.
        const bool rows = 4 * a % by_angle.size() == 0;
        const double samples = (radius + end) * 2 * radius;
        const double spacing = rows ? 1.0 : std::max(1.0, samples * angles / kMostSamples);
        std::vector<double> sums, depths;
        for (double across = -std::floor(radius / spacing) * spacing;
             across <= radius && !options.stop.stop_requested(); across += spacing) {
            sums.assign(1, 0.0);
            depths.assign(1, 0.0);
            bool inside = false;
            for (double along = -std::floor(radius); along <= end; along += 1) {
                const double x = x0 + along * ux - across * uz, z = z0 + along * uz + across * ux;
                const double value = field.at(x, z);
                inside = inside || value != 0;
                sums.push_back(sums.back() + value * step);
                depths.push_back(depths.back() + std::max(densities.at(x, z), 0.0) * step);
            }
            if (inside) by_angle[a].add_line(sums, depths, step);
        }
    });
    RaySegments segments = none;
    for (const RaySegments& of : by_angle) segments.add(of);
    if (repeats) segments.extend(path);

    // Every slope between two, by the longer reach of the one and the longer stretch of the other.
    constexpr int kSlopes = 400;
    double worst = 0;
    for (int s = 0; s < kSlopes; ++s) {
        const double slope = std::numbers::pi / 2 * s / kSlopes;
        const double steeper = std::numbers::pi / 2 * (s + 1) / kSlopes;
        const double reach = s == 0 ? path : std::min(path, layer.thickness / std::sin(slope));
        // A steep ray crosses few pixels, so that none of their errors may even out.
        const double by_pixels = pixels.worst_change(extinction * reach);
        if (by_pixels <= worst) continue;
        const bool cut = fog.profile.kind == Profile::Kind::slab;  // else fog thins
        const double across = std::cos(slope);
        const double by_segments =
            segments.worst_change((cut ? reach : path) * across, reach * across,
                                  1 / std::max(std::cos(steeper), 1e-12), kBetweenLines);
        worst = std::max(worst, std::min(by_segments, by_pixels));
    }
    return worst;
}

}  // namespace wavefog::wfog
