#include "wavefog/fogmap/particles.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace wavefog {
namespace {

using Eigen::Vector3d;

// Off what it touched, so that the next step begins outside; metres.
constexpr double kClearance = 1e-3;

/// SplitMix64 (Steele, Lea, Flood 2014), counted by the particle's number.
class Draws {
  public:
    Draws(std::uint64_t seed, std::int64_t number)
        : state_(mixed(seed ^ mixed(static_cast<std::uint64_t>(number)))) {}
    /// [0, 1), 53 bits.
    double uniform() { return static_cast<double>(mixed(state_ += kStep) >> 11) * 0x1p-53; }

  private:
    static constexpr std::uint64_t kStep = 0x9e3779b97f4a7c15u;
    static std::uint64_t mixed(std::uint64_t z) {
        z += kStep;
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    std::uint64_t state_;
};

/// -log of one particle's clarity.
double depth_along(const Particle& particle, const Vector3d& o, const Vector3d& path) {
    const Vector3d w = particle.position - o;
    const double square = path.squaredNorm();
    const double t = square > 0 ? std::clamp(w.dot(path) / square, 0.0, 1.0) : 0;
    const double near = std::max(1 - (w - t * path).norm() / particle.radius, 0.0);
    return -std::log1p(-particle.opacity * near);
}

}  // namespace

double optical_depth(const std::vector<Particle>& particles, const Vector3d& o, const Vector3d& p) {
    double sum = 0;
    for (const Particle& particle : particles) sum += depth_along(particle, o, p - o);
    return sum;
}

Eigen::Array3d channel_depths(const std::vector<Particle>& particles, const Vector3d& o,
                              const Vector3d& p) {
    Eigen::Array3d sum = Eigen::Array3d::Zero();
    for (const Particle& particle : particles)
        sum += depth_along(particle, o, p - o) * Eigen::Array3d(particle.channels.data());
    return sum;
}

Result<void> ParticleSource::validate() const {
    const auto need = [](bool ok, const char* key, double value, const char* what) -> Result<void> {
        if (ok) return {};
        return data_error(fmt::format("{} is {}; it must be {}", key, value, what));
    };
    const auto positive = [](double v) { return v > 0 && std::isfinite(v); };
    for (const auto& [ok, key, value, what] :
         {std::tuple{positive(rate), "rate", rate, "above 0 (particles a second)"},
          {positive(step), "step", step, "above 0 (s)"},
          {positive(radius[0]), "radius[0]", radius[0], "above 0 (m)"},
          {positive(radius[1]), "radius[1]", radius[1], "above 0 (m)"},
          {opacity > 0 && opacity < 1, "opacity", opacity, "above 0 and below 1"},
          {area >= 0 && std::isfinite(area), "area", area, "0 or more (m)"},
          {speed >= 0 && std::isfinite(speed), "speed", speed, "0 or more (m/s)"},
          {spread >= 0 && spread <= std::numbers::pi, "spread_deg", spread * 180 / std::numbers::pi,
           "0 to 180"},
          {std::isfinite(lift), "lift", lift, "finite (m/s^2)"},
          {drag >= 0 && drag * step <= 1, "drag", drag, "0 to 1 / step (1/s)"},
          {life[0] >= 1, "life[0]", double(life[0]), "1 or more (steps)"},
          {life[1] >= life[0], "life[1]", double(life[1]), "life[0] or more (steps)"}})
        if (auto checked = need(ok, key, value, what); !checked) return checked;
    if (!position.allFinite()) return data_error("position must be finite (m)");
    if (!(std::abs(direction.norm() - 1) <= 1e-12))
        return data_error("direction is 0 or not finite; give a direction");
    if (most() > kMostParticles)
        return data_error(fmt::format(
            "rate is {}: with life[1] = {} steps of {} s that is {:.0f} particles; {} are the most",
            rate, life[1], step, most(), kMostParticles));
    if (auto ok = wind.validate(); !ok) return data_error("wind" + ok.error().message);
    return wavefog::validate(channels);
}

ParticleSystem::ParticleSystem(std::vector<ParticleSource> sources, Obstacle obstacle)
    : sources_(std::move(sources)), obstacle_(std::move(obstacle)), states_(sources_.size()) {}

ParticleSystem::State ParticleSystem::born(const ParticleSource& source,
                                           std::int64_t number) const {
    Draws draws(source.seed, number);
    State state;
    state.number = number;
    const double turn = 2 * std::numbers::pi * draws.uniform();
    const double from_axis = 1 - draws.uniform() * (1 - std::cos(source.spread));
    const double speed = source.speed * (0.75 + 0.5 * draws.uniform());
    state.life =
        source.life[0] + static_cast<int>(draws.uniform() * (source.life[1] - source.life[0] + 1));
    const Vector3d side = source.direction.unitOrthogonal();
    const Vector3d across = source.direction.cross(side);
    const double sine = std::sqrt(std::max(1 - from_axis * from_axis, 0.0));
    state.velocity = speed * (from_axis * source.direction +
                              sine * (std::cos(turn) * side + std::sin(turn) * across));
    const double bearing = 2 * std::numbers::pi * draws.uniform();
    const double out = source.area * std::sqrt(draws.uniform());
    state.position = source.position + out * Vector3d(std::cos(bearing), 0, std::sin(bearing));
    return state;
}

void ParticleSystem::advance(const ParticleSource& source, State& state, double part) const {
    const double seconds = part * source.step;
    const double now = static_cast<double>(state.number) / source.rate + state.steps * source.step;
    const Eigen::Vector2d wind = source.wind.velocity(now);
    // Constant acceleration: position and velocity go on smoothly from step to step.
    const Vector3d before = state.velocity;
    state.velocity += seconds * (source.drag * (Vector3d(wind.x(), 0, wind.y()) - before) +
                                 Vector3d(0, source.lift, 0));
    const Vector3d to = state.position + seconds * (before + state.velocity) / 2;
    const auto contact = obstacle_ ? obstacle_(state.position, to) : std::nullopt;
    if (!contact) {
        state.position = to;
        return;
    }
    // It stops there and goes on along the surface.
    state.position = contact->point + kClearance * contact->normal;
    state.velocity -= std::min(state.velocity.dot(contact->normal), 0.0) * contact->normal;
}

const std::vector<Particle>& ParticleSystem::at(double seconds) {
    particles_.clear();
    for (std::size_t s = 0; s < sources_.size(); ++s) {
        const ParticleSource& source = sources_[s];
        const double oldest = std::ceil((seconds - source.life[1] * source.step) * source.rate);
        const double newest = std::floor(seconds * source.rate);
        const std::vector<State> before = std::move(states_[s]);
        std::vector<State>& states = states_[s];
        states.clear();
        auto known = before.begin();
        for (auto number = static_cast<std::int64_t>(oldest); double(number) <= newest; ++number) {
            const double age = (seconds - static_cast<double>(number) / source.rate) / source.step;
            const int whole = static_cast<int>(std::max(std::floor(age), 0.0));
            while (known != before.end() && known->number < number) ++known;
            State state = known != before.end() && known->number == number && known->steps <= whole
                              ? *known
                              : born(source, number);
            if (age < 0 || age >= state.life) continue;
            for (; state.steps < whole; ++state.steps) advance(source, state, 1);
            states.push_back(state);
            if (age > whole) advance(source, state, age - whole);
            const double spent = age / state.life;
            particles_.push_back({state.position,
                                  source.radius[0] + spent * (source.radius[1] - source.radius[0]),
                                  source.opacity * (1 - spent), source.channels});
        }
    }
    return particles_;
}

}  // namespace wavefog
