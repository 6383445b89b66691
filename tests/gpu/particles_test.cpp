// The shader's particles, compiled as C++, against their twin in double.
#include <doctest/doctest.h>

#include <cmath>

#include "fogmap/model_support.h"
#include "wavefog/gpu/fog_pass.h"

using namespace wavefog;
using namespace wavefog::test;
using Eigen::Vector3d;

namespace {

// A few roundings of each opacity; where particles end rays, of a distance too (below).
constexpr double kMaxError = 2e-6;

std::vector<Particle> random_particles(Random& random, int count, double least_radius,
                                       double opacity, const Vector3d& offset = {0, 0, 0}) {
    std::vector<Particle> particles;
    for (int i = 0; i < count; ++i) {
        const Vector3d at = offset + random_vector(random, 40);
        particles.push_back(
            {at, random.uniform(least_radius, 3 * least_radius), opacity * random.uniform()});
    }
    return particles;
}

double error(const ParticlesOnCpu& shader, const std::vector<Particle>& particles,
             const Segment3& s) {
    const double tau = shader.optical_depth(s.first, s.second);
    REQUIRE(std::isfinite(tau));
    REQUIRE(tau >= 0);
    return std::abs(std::exp(-tau) - std::exp(-optical_depth(particles, s.first, s.second)));
}

}  // namespace

TEST_CASE("particles: the shader equals its twin on random, level, short and zero-length rays") {
    Random random(601);
    for (const Vector3d& offset : {Vector3d(0, 0, 0), Vector3d(1e6, 0, -2e6)})
        for (const int count : {1, 20, 300, 3000}) {
            const auto particles = random_particles(random, count, 3, 0.2, offset);
            const ParticlesOnCpu shader(particles);
            double worst = 0, thickest = 0;
            for (const Segment3& s : model_segments(random, 400, offset)) {
                worst = std::max(worst, error(shader, particles, s));
                thickest = std::max(thickest, optical_depth(particles, s.first, s.second));
            }
            MESSAGE(count, " particles: largest |dT| ", worst, ", tau up to ", thickest);
            CHECK_LE(worst, kMaxError);
            CHECK(thickest > 0);
        }
    CHECK(ParticlesOnCpu({}).optical_depth({0, 0, 0}, {1, 2, 3}) == 0);
}

TEST_CASE("particles: small and dense ones, beside rays and at their ends") {
    Random random(607);
    for (const double radius : {0.1, 0.3, 1.0})
        for (const double opacity : {0.2, 0.99}) {
            double passing = 0, ending = 0;
            for (int i = 0; i < 400; ++i) {
                const Vector3d at = random_vector(random, 40);
                const std::vector<Particle> one = {{at, radius, opacity}};
                // A ray that passes at about a radius, and goes on or ends beside it.
                const Vector3d o = random_vector(random, 40);
                const Vector3d by = at + radius * random.uniform() * random_direction(random);
                const Vector3d p = i % 3 == 0 ? by : Vector3d(o + 1.7 * (by - o));
                const double e = error(ParticlesOnCpu(one), one, {o, p});
                (i % 3 == 0 ? ending : passing) = std::max(i % 3 == 0 ? ending : passing, e);
                CAPTURE(radius);
                CAPTURE(opacity);
                CHECK_LE(e, kMaxError);
            }
            MESSAGE("radius ", radius, ", opacity ", opacity, ": largest |dT| of rays that pass ",
                    passing, ", that end beside it ", ending);
        }
}

TEST_CASE("particles: through centres, beside ends, and where nothing is left to see") {
    const std::vector<Particle> line = {
        {{0, 0, 0}, 3, 0.999}, {{5, 1, 0}, 4, 0.9}, {{-5, 0, 2}, 3, 0.5}};
    const ParticlesOnCpu shader(line);
    for (const double x : {-30.0, -5.0, -3.0, 0.0, 3.0, 20.0})
        for (const double y : {0.0, 1.0, 3.0, 5.0})
            for (const double end : {-8.0, 0.0, 2.999999, 9.0})
                CHECK_LE(error(shader, line, {{x, y, 0}, {end, y, 0}}), kMaxError);
    // A clarity of 0.1^40: the list ends early, but not for a colour that sees a share of it.
    std::vector<Particle> wall(40, {{0, 0, 0}, 3, 0.9});
    CHECK(ParticlesOnCpu(wall).optical_depth({-9, 0, 0}, {9, 0, 0}) > 14);
    CHECK(ParticlesOnCpu(wall).optical_depth({-9, 0, 0}, {9, 0, 0}) < 18);
    for (const double share : {0.3, 0.05, 0.01}) {
        for (Particle& particle : wall) particle.channels = {1, share, 0};
        const double tau = share * ParticlesOnCpu(wall).optical_depth({-9, 0, 0}, {9, 0, 0});
        CHECK_LE(std::abs(std::exp(-tau) - std::pow(0.1, 40 * share)), kMaxError);
    }
}
