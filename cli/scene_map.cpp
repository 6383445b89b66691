#include "scene_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "parallel.h"
#include "wavefog/fogmap/reference.h"

namespace wavefog::cli {
namespace {

using Eigen::Vector3d;

/// Particles by the squares of the ground that they dim vertical rays of.
class ParticleColumns {
  public:
    /// Depths are those of one `channel`, or before channels.
    ParticleColumns(const std::vector<Particle>& particles, std::optional<int> channel)
        : channel_(channel) {
        if (particles.empty()) return;
        double area = 0;
        for (const Particle& p : particles) {
            const Vector3d reach = Vector3d::Constant(p.radius);
            low_ = low_.cwiseMin(p.position - reach);
            high_ = high_.cwiseMax(p.position + reach);
            area += p.radius * p.radius;
        }
        // Squares as wide as particles are: lists stay short, and few particles lie in many.
        square_ = std::sqrt(area / double(particles.size()));
        square_ = std::max(square_, std::max(high_.x() - low_.x(), high_.z() - low_.z()) / 2048);
        across_ = index(high_.x(), low_.x()) + 1;
        down_ = index(high_.z(), low_.z()) + 1;
        lists_.resize(std::size_t(across_) * std::size_t(down_));
        for (const Particle& p : particles)
            for (int j = index(p.position.z() - p.radius, low_.z());
                 j <= index(p.position.z() + p.radius, low_.z()); ++j)
                for (int i = index(p.position.x() - p.radius, low_.x());
                     i <= index(p.position.x() + p.radius, low_.x()); ++i)
                    lists_[std::size_t(j * across_ + i)].push_back(p);
    }

    double optical_depth(const Vector3d& low, const Vector3d& high) const {
        const int i = index(low.x(), low_.x()), j = index(low.z(), low_.z());
        if (lists_.empty() || i < 0 || j < 0 || i >= across_ || j >= down_) return 0;
        const std::vector<Particle>& near = lists_[std::size_t(j * across_ + i)];
        return channel_ ? channel_depths(near, low, high)[*channel_]
                        : wavefog::optical_depth(near, low, high);
    }
    const Vector3d& low() const { return low_; }
    const Vector3d& high() const { return high_; }

  private:
    int index(double place, double from) const {
        return static_cast<int>(std::clamp(std::floor((place - from) / square_), -1.0, 1e6));
    }

    std::optional<int> channel_;
    Vector3d low_ = Vector3d::Constant(std::numeric_limits<double>::infinity());
    Vector3d high_ = -low_;
    double square_ = 1;
    int across_ = 0, down_ = 0;
    std::vector<std::vector<Particle>> lists_;
};

/// The sum of all fogs at a place of the map, 1/m.
class SceneColumn {
  public:
    SceneColumn(const FogsAt& fogs, const ParticleColumns& particles,
                const std::array<double, 2>& heights, const SceneMapOptions& options)
        : particles_(&particles), low_(heights[0]), high_(heights[1]) {
        const auto share = [&](const Channels& channels) {
            return options.channel ? channels[std::size_t(*options.channel)] : 1;
        };
        for (const Fog& fog : fogs.fogs)
            maps_.push_back({Reference(fog, fogs.seconds), share(fog.channels)});
        for (FogModel model : fogs.models) {
            // A map holds extinction; the fraction that OpenGL has for it is of a whole ray.
            if (auto* plane = std::get_if<Halfspace>(&model))
                plane->fraction = Halfspace::Fraction::exp;
            models_.push_back({model, share(model.channels)});
        }
    }

    double operator()(double x, double z) const {
        const Vector3d low(x, low_, z), high(x, high_, z);
        double sum = 0;
        if (low_ == high_) {
            for (const auto& [map, share] : maps_)
                sum += share * std::max(map.extinction(low), 0.0);
            for (const auto& [model, share] : models_)
                sum += share * std::max(extinction(model, low), 0.0);
            return sum;
        }
        for (const auto& [map, share] : maps_) sum += share * map.optical_depth(low, high);
        for (const auto& [model, share] : models_)
            sum += share * std::max(optical_depth(model, low, high), 0.0);
        return (sum + particles_->optical_depth(low, high)) / (high_ - low_);
    }

  private:
    const ParticleColumns* particles_;
    std::vector<std::pair<Reference, double>> maps_;
    std::vector<std::pair<FogModel, double>> models_;
    double low_, high_;
};

/// The least rectangle of square pixels around all particles.
Rect around(const ParticleColumns& particles, const Size& size) {
    const Vector3d middle = (particles.low() + particles.high()) / 2;
    const Vector3d sides = particles.high() - particles.low();
    const double pixel = std::max(sides.x() / size.width, sides.z() / size.height);
    const double x = pixel * size.width / 2, z = pixel * size.height / 2;
    return {middle.x() - x, middle.z() - z, middle.x() + x, middle.z() + z};
}

/// --rect, or where the scene's own terrain, map or particles lie.
Result<Rect> rect_of(const FogsAt& fogs, const ParticleColumns& particles,
                     const SceneMapOptions& options) {
    if (options.rect) return *options.rect;
    if (fogs.terrain) return fogs.terrain->rect;
    if (!fogs.fogs.empty()) return fogs.fogs.front().rect;
    if (!fogs.particles.empty()) return around(particles, options.size);
    return usage_error(
        "--rect x0,z0,x1,z1: say which part of the world the map covers; the scene "
        "has no terrain that would");
}

/// Between which heights the map is a mean; the same one twice for the density there.
Result<std::array<double, 2>> heights_of(const FogsAt& fogs, const ParticleColumns& particles,
                                         const SceneMapOptions& options) {
    if (options.mean) return *options.mean;
    if (options.height && !fogs.particles.empty())
        return usage_error(
            "--height: particles dim rays and have no density at a point; use --mean Y0,Y1");
    if (options.height) return std::array{*options.height, *options.height};
    if (fogs.fogs.empty() && fogs.models.empty())
        return std::array{particles.low().y(), particles.high().y()};
    return usage_error(
        "--height Y or --mean Y0,Y1: give one of them, since a scene's fog changes with height");
}

void warn_of_small_particles(const FogsAt& fogs, const Rect& rect, const Size& size) {
    const double pixel =
        std::max((rect.x1 - rect.x0) / size.width, (rect.z1 - rect.z0) / size.height);
    const auto small = std::count_if(fogs.particles.begin(), fogs.particles.end(),
                                     [&](const Particle& p) { return p.radius < pixel; });
    if (small > 0)
        warn(
            fmt::format("{} of {} particles are smaller than two pixels of {:.3g} m, and part of "
                        "their fog falls between them; use a larger --size",
                        small, fogs.particles.size(), pixel));
}

/// On all cores.
Grid<float> draw(const SceneColumn& column, const Rect& rect, const SceneMapOptions& options) {
    const Size size = options.size;
    const double width = rect.x1 - rect.x0, depth = rect.z1 - rect.z0;
    // A tile's first quarter fades from what lies behind its other end into its own.
    const auto own_share = [](double place) {
        const double t = std::min(4 * place, 1.0);
        return t * t * (3 - 2 * t);
    };
    const auto value = [&](int i, int j) {
        const double u = (i + 0.5) / size.width, v = (j + 0.5) / size.height;
        const double x = rect.x0 + u * width, z = rect.z0 + v * depth;
        if (!options.tile) return column(x, z);
        const double a = own_share(u), b = own_share(v);
        double sum = a * b * column(x, z);
        if (a < 1) sum += (1 - a) * b * column(x + width, z);
        if (b < 1) sum += a * (1 - b) * column(x, z + depth);
        if (a < 1 && b < 1) sum += (1 - a) * (1 - b) * column(x + width, z + depth);
        return sum;
    };
    Grid<float> map(size.height, size.width);
    parallel_chunks("generating", static_cast<std::size_t>(size.height), 1,
                    [&](std::size_t begin, std::size_t end) {
                        for (auto j = static_cast<int>(begin); j < static_cast<int>(end); ++j)
                            for (int i = 0; i < size.width; ++i)
                                map(j, i) = static_cast<float>(value(i, j));
                    });
    return map;
}

}  // namespace

Result<Grid<float>> scene_map(const FogsAt& fogs, const SceneMapOptions& options, Facts& facts) {
    const ParticleColumns particles(fogs.particles, options.channel);
    const auto heights = heights_of(fogs, particles, options);
    if (!heights) return tl::unexpected(heights.error());
    const Result<Rect> rect = rect_of(fogs, particles, options);
    if (!rect) return tl::unexpected(rect.error());
    if (fogs.coloured() && !options.channel)
        return usage_error(
            "--channel R, G or B: the fogs have \"channels\", and a map holds one; make one for "
            "each colour");
    warn_of_small_particles(fogs, *rect, options.size);

    Grid<float> map = draw(SceneColumn(fogs, particles, *heights, options), *rect, options);
    const double extinction = options.extinction.value_or(double(map.maxCoeff()));
    if (extinction > 0) map = (map.cast<double>() / extinction).cast<float>();
    facts["rect"] = {rect->x0, rect->z0, rect->x1, rect->z1};
    facts["extinction"] = extinction;
    const auto [low, high] = *heights;
    if (low < high) {
        Profile slab{.kind = Profile::Kind::slab, .bottom = low, .top = high};
        facts["profile"] = profile_text(slab);
    }
    if (!fogs.particles.empty()) facts["particles"] = fogs.particles.size();
    return map;
}

}  // namespace wavefog::cli
