// Fog and smoke of particles (paper 003): sources that let points drift, and the clarity of a ray.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "wavefog/fogmap/channels.h"
#include "wavefog/fogmap/wind.h"
#include "wavefog/wavelet/result.h"

namespace wavefog {

/// A point that dims rays within `radius`: at distance d from the ray, which ends at the surface,
/// its opacity is opacity * max(1 - d / radius, 0).
struct Particle {
    Eigen::Vector3d position{0, 0, 0};
    double radius = 1;   ///< metres, above 0
    double opacity = 0;  ///< at its centre: the source's, times remaining over initial life
    Channels channels = kAllChannels;  ///< a share s makes of a clarity c what c^s lets through
};

/// -log of the clarity, the product of 1 - opacity over all particles, before `channels`: it adds
/// to the optical depths of other fogs. A long segment is not fogged twice by one particle: only
/// the least distance counts, so it is not additive over parts of a ray.
double optical_depth(const std::vector<Particle>& particles, const Eigen::Vector3d& o,
                     const Eigen::Vector3d& p);

/// The same as red, green and blue see it.
Eigen::Array3d channel_depths(const std::vector<Particle>& particles, const Eigen::Vector3d& o,
                              const Eigen::Vector3d& p);

/// Sends out particles one by one, 1 / rate seconds apart, at all times.
struct ParticleSource {
    static constexpr int kMostParticles = 65536;

    Eigen::Vector3d position{0, 0, 0};
    double area = 0;                        ///< radius of the level disc they start on, metres
    Eigen::Vector3d direction{0, 1, 0};     ///< unit length
    double spread = 0;                      ///< half angle of the cone around it, radians, 0 to pi
    double speed = 1;                       ///< m/s at the start, a quarter more or less
    double rate = 10;                       ///< particles a second
    std::array<int, 2> life = {64, 128};    ///< steps, least and most
    double step = 0.1;                      ///< seconds
    std::array<double, 2> radius = {1, 1};  ///< metres, at birth and at the end
    double opacity = 0.2;                   ///< the most, above 0 and below 1
    double lift = 0;                        ///< m/s^2, upwards
    double drag = 0;                        ///< 1/s: how fast it takes the wind's velocity
    Wind wind;
    std::uint64_t seed = 1;
    Channels channels = kAllChannels;

    /// Most particles at a time.
    double most() const { return rate * life[1] * step; }
    /// A data error that names the field, as in the scene file.
    Result<void> validate() const;
};

/// Where a particle's step meets something.
struct Contact {
    Eigen::Vector3d point;
    Eigen::Vector3d normal;  ///< unit length, on the side it came from
};
using Obstacle =
    std::function<std::optional<Contact>(const Eigen::Vector3d& from, const Eigen::Vector3d& to)>;

/// All particles of some sources. Each one's path is a function of seed, number and age, in fixed
/// steps from its birth: a time's particles are the same, bit for bit, whatever times were asked
/// for before; going on from an earlier time only saves steps.
class ParticleSystem {
  public:
    /// Sources must pass validate(). Without an obstacle they meet nothing.
    explicit ParticleSystem(std::vector<ParticleSource> sources, Obstacle obstacle = {});

    const std::vector<Particle>& at(double seconds);

  private:
    struct State {
        std::int64_t number = 0;  ///< of the particle
        int steps = 0, life = 0;
        Eigen::Vector3d position, velocity;
    };
    State born(const ParticleSource& source, std::int64_t number) const;
    /// Goes on for part of a step, (0, 1].
    void advance(const ParticleSource& source, State& state, double part) const;

    std::vector<ParticleSource> sources_;
    Obstacle obstacle_;
    std::vector<std::vector<State>> states_;  ///< of each source, by number
    std::vector<Particle> particles_;
};

}  // namespace wavefog
