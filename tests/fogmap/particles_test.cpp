// Particles: the clarity of paper 003, and a simulation that does not depend on who runs it.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "support/random.h"
#include "wavefog/fogmap/particles.h"

using namespace wavefog;
using namespace wavefog::test;
using Eigen::Vector3d;

namespace {

ParticleSource smoke() {
    ParticleSource source;
    source.position = {1, 2, 3};
    source.spread = 0.4;
    source.rate = 37;
    source.life = {8, 16};
    source.step = 0.3;
    source.radius = {0.2, 1.4};
    source.opacity = 0.9;
    source.lift = 0.2;
    source.drag = 0.5;
    source.wind.keys = {{0, 2, 0}, {7, -1, 1}};
    source.channels = {1, 0.5, 0.25};
    return source;
}

bool same(const std::vector<Particle>& a, const std::vector<Particle>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const auto& p, const auto& q) {
        return p.position == q.position && p.radius == q.radius && p.opacity == q.opacity &&
               p.channels == q.channels;
    });
}

}  // namespace

TEST_CASE("particles: opacity falls with the distance from the ray, which ends at both sides") {
    const std::vector<Particle> one = {{{0, 0, 0}, 2, 0.5}};
    const auto clarity = [&](const Vector3d& o, const Vector3d& p) {
        return std::exp(-optical_depth(one, o, p));
    };
    CHECK(clarity({-5, 0, 0}, {5, 0, 0}) == doctest::Approx(0.5));
    CHECK(clarity({-5, 1, 0}, {5, 1, 0}) == doctest::Approx(0.75));
    CHECK(clarity({-5, 2, 0}, {5, 2, 0}) == 1);
    CHECK(clarity({-5, 0, 0}, {-1, 0, 0}) == doctest::Approx(0.75));  // the surface in front of it
    CHECK(clarity({-5, 0, 0}, {-3, 0, 0}) == 1);
    CHECK(clarity({1, 0, 0}, {5, 0, 0}) == doctest::Approx(0.75));  // behind the eye
    CHECK(clarity({1, 0, 0}, {1, 0, 0}) == doctest::Approx(0.75));  // of no length
    CHECK(clarity({5, 0, 0}, {9, 0, 0}) == 1);
    // Several: the product.
    const std::vector<Particle> two = {one[0], {{1, 0.5, 0}, 1, 0.8}};
    CHECK(std::exp(-optical_depth(two, {-5, 0, 0}, {5, 0, 0})) == doctest::Approx(0.5 * 0.6));
}

TEST_CASE("particles: the clarity is the paper's product, whatever the ray") {
    Random random(811);
    const auto point = [&] {
        const double x = random.uniform(-9, 9), y = random.uniform(-9, 9);
        return Vector3d(x, y, random.uniform(-9, 9));
    };
    for (int round = 0; round < 300; ++round) {
        std::vector<Particle> particles;
        for (int i = 0; i < 12; ++i)
            particles.push_back({point(), random.uniform(0.2, 9), 0.999 * random.uniform()});
        const Vector3d o = point(), p = round % 10 == 0 ? o : point();
        // The least distance is searched, not solved for: it is convex along the segment.
        double clarity = 1;
        for (const Particle& particle : particles) {
            const auto square = [&](double t) {
                return (particle.position - o - t * (p - o)).squaredNorm();
            };
            double low = 0, high = 1;
            for (int step = 0; step < 120; ++step) {
                const double a = low + (high - low) / 3, b = high - (high - low) / 3;
                (square(a) < square(b) ? high : low) = square(a) < square(b) ? b : a;
            }
            const double distance = std::sqrt(square((low + high) / 2));
            clarity *= 1 - particle.opacity * std::clamp(1 - distance / particle.radius, 0.0, 1.0);
        }
        CHECK_LE(std::abs(std::exp(-optical_depth(particles, o, p)) - clarity), 1e-9);
    }
}

TEST_CASE("particles: a colour's share of them is a power of each clarity") {
    Random random(813);
    std::vector<Particle> particles;
    for (int i = 0; i < 40; ++i) {
        const double x = random.uniform(-2, 2), y = random.uniform(-2, 2);
        particles.push_back({{x, y, random.uniform(-9, 9)}, 5, 0.9 * random.uniform()});
        particles.back().channels = {random.uniform(), random.uniform(0, 3), 0};
    }
    const Vector3d o(0, 0, -12), p(1, 0, 12);
    Eigen::Array3d clarity = Eigen::Array3d::Ones();
    for (const Particle& one : particles)
        for (int c = 0; c < 3; ++c)
            clarity[c] *=
                std::pow(std::exp(-optical_depth({one}, o, p)), one.channels[std::size_t(c)]);
    const Eigen::Array3d depths = channel_depths(particles, o, p);
    CHECK((Eigen::exp(-depths) - clarity).abs().maxCoeff() <= 1e-12);
    CHECK(depths[2] == 0);
    for (Particle& one : particles) one.channels = kAllChannels;
    CHECK((channel_depths(particles, o, p) - optical_depth(particles, o, p)).abs().maxCoeff() == 0);
}

TEST_CASE("particles: a time's particles are the same, whatever was asked before") {
    const std::vector<ParticleSource> sources = {smoke(), smoke()};
    const Obstacle floor = [](const Vector3d&, const Vector3d& to) -> std::optional<Contact> {
        if (to.y() >= 2.2 || to.x() < 1.1) return std::nullopt;
        return Contact{{to.x(), 2.2, to.z()}, {0, 1, 0}};
    };
    ParticleSystem stepping(sources, floor);
    for (const double start : {1e6, 0.0})
        for (int frame = 0; frame <= 600; ++frame) {
            const double seconds = start + frame / 24.0;
            const auto& now = stepping.at(seconds);
            if (frame % 97 != 0 && frame != 600) continue;
            ParticleSystem alone(sources, floor);
            CHECK(same(now, alone.at(seconds)));
            CHECK(now.size() > 200);
        }
    for (const double earlier : {24.9, 24.0, 3.0})
        CHECK(same(stepping.at(earlier), ParticleSystem(sources, floor).at(earlier)));
    // The second source has its own seed in other scenes; here both are the same.
    auto other = smoke();
    other.seed = 2;
    CHECK(!same(ParticleSystem({other}).at(3), ParticleSystem({smoke()}).at(3)));
}

TEST_CASE("particles: number, life, strength and spread are as asked for") {
    ParticleSource source = smoke();
    source.lift = source.drag = 0;
    source.wind = {};
    ParticleSystem system({source});
    const auto& now = system.at(100);
    // Lives are even between 8 and 16 steps of 0.3 s: 12 * 0.3 * 37 = 133, give or take 3 sigma.
    CHECK(std::abs(double(now.size()) - 133) < 35);
    for (const Particle& p : now) {
        CHECK(p.opacity > 0);
        CHECK(p.opacity <= source.opacity);
        const double spent = 1 - p.opacity / source.opacity;
        CHECK(p.radius == doctest::Approx(0.2 + spent * 1.2));
        const Vector3d away = p.position - source.position;
        if (away.norm() > 1e-9) CHECK(away.normalized().y() >= std::cos(source.spread) - 1e-12);
        CHECK_LE(away.norm(), 1.25 * source.speed * 16 * 0.3 * (1 + 1e-12));
    }
    source.area = 3;
    ParticleSystem wide({source});
    double farthest = 0;
    for (const Particle& p : wide.at(100))
        farthest = std::max(farthest, std::hypot(p.position.x() - 1, p.position.z() - 3));
    CHECK(farthest > 2);
}

TEST_CASE("particles: they move without jumps, and in the wind's direction in the end") {
    ParticleSource source = smoke();
    source.life = {64, 64};
    source.wind = {3, -4};
    source.lift = 0;
    source.drag = 3;
    ParticleSystem system({source});
    const std::vector<Particle> before = system.at(20), after = system.at(20.001);
    REQUIRE(after.size() >= before.size() - 1);
    std::vector<Particle> old(before.begin(), before.end());
    std::size_t shift = old.size() > after.size() ? 1 : 0;
    double fastest = 0;
    for (std::size_t i = shift; i < old.size(); ++i)
        fastest = std::max(fastest, (after[i - shift].position - old[i].position).norm() / 0.001);
    CHECK_LE(fastest, 5.5);  // the wind's 5 m/s and what is left of its own
    const Vector3d velocity = (after[1].position - before[1 + shift].position) / 0.001;
    CHECK((velocity - Vector3d(3, 0, -4)).norm() < 0.01);
}

TEST_CASE("particles: a floor is not passed") {
    ParticleSource source = smoke();
    source.direction = {0, -1, 0};
    source.lift = -1;
    const Obstacle floor = [](const Vector3d& from, const Vector3d& to) -> std::optional<Contact> {
        if (to.y() >= 1) return std::nullopt;
        const double t = (from.y() - 1) / (from.y() - to.y());
        return Contact{from + t * (to - from), {0, 1, 0}};
    };
    ParticleSystem system({source}, floor);
    int lying = 0;
    for (const Particle& p : system.at(50)) {
        CHECK_GE(p.position.y(), 1);
        lying += p.position.y() < 1.1;
    }
    CHECK(lying > 20);
}

TEST_CASE("particles: what cannot be is named") {
    const auto error = [](auto change) {
        ParticleSource source = smoke();
        change(source);
        const auto ok = source.validate();
        return ok ? std::string("valid") : ok.error().message;
    };
    CHECK(error([](auto&) {}) == "valid");
    CHECK(error([](auto& s) { s.radius[0] = 0; }) == "radius[0] is 0; it must be above 0 (m)");
    CHECK(error([](auto& s) { s.rate = -1; }).find("rate is -1") == 0);
    CHECK(error([](auto& s) { s.rate = 1e9; }).find("rate is 1000000000: with life[1]") == 0);
    CHECK(error([](auto& s) { s.opacity = 1; }).find("opacity is 1;") == 0);
    CHECK(error([](auto& s) { s.step = std::nan(""); }).find("step is nan") == 0);
    CHECK(error([](auto& s) { s.direction = {0, 0, 0}; }).find("direction is 0") == 0);
    CHECK(error([](auto& s) { s.life = {9, 8}; }).find("life[1] is 8") == 0);
    CHECK(error([](auto& s) { s.drag = 4; }).find("drag is 4") == 0);
}
