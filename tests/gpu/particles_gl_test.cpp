// Particles drawn on OSMesa through tiles, against all of them one by one in double.
#include <doctest/doctest.h>

#include <cmath>

#include "fogmap/fog_support.h"
#include "gpu/fog_picture.h"
#include "particle_tiles.h"
#include "wavefog/gpu/obstacles.h"

using namespace wavefog;
using namespace wavefog::test;
using Eigen::Vector3d;

namespace {

// Beside rays and at their ends places are exact; without perspective float32 rounds 100 m to
// 100 * 2^-24 m, twice: with radii from 3 m 4e-6 of a radius, times opacities of 0.2.
constexpr double kMaxError = 2e-6;

std::vector<Particle> random_particles(Random& random, int count, double opacity) {
    std::vector<Particle> particles;
    for (int i = 0; i < count; ++i) {
        const double x = random.uniform(-30, 30), y = random.uniform(-3, 12);
        particles.push_back(
            {{x, y, random.uniform(-30, 30)}, random.uniform(3, 9), opacity * random.uniform()});
    }
    return particles;
}

double error_of(const Gl& gl, const Camera& camera, const std::vector<Particle>& particles,
                FogPass& pass) {
    FogPicture picture = make_picture(gl, camera);
    REQUIRE(pass.set_particles(particles).has_value());
    pass.draw_optical_depth(picture.frame, camera, picture.target.name());
    const Image tau = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
    int sky = 0;
    return largest_error(picture, camera, tau, {}, 1, sky, {}, particles);
}

}  // namespace

TEST_CASE("particles: every camera sees them as the twin in double does") {
    const Gl& gl = osmesa().gl();
    Random random(431);
    auto pass = FogPass::create(gl, {}, {}, {1, 1, 1}, {}, {kAllChannels});
    REQUIRE_MESSAGE(pass.has_value(), (pass ? "" : pass.error().message));
    for (const auto& [name, camera] : camera_cases()) {
        CAPTURE(std::string(name));
        for (const int count : {0, 1, 20, 300}) {
            CAPTURE(count);
            CHECK_LE(error_of(gl, camera, random_particles(random, count, 0.2), *pass), kMaxError);
        }
    }
}

TEST_CASE("particles: small and dense ones where surfaces end the rays") {
    const Gl& gl = osmesa().gl();
    Random random(433);
    auto pass = FogPass::create(gl, {}, {}, {1, 1, 1}, {}, {kAllChannels});
    for (const auto& [name, camera] : camera_cases()) {
        // Without perspective, places and ends are single floats.
        if (camera.projection == Camera::Projection::orthographic) continue;
        CAPTURE(std::string(name));
        const FogPicture picture = make_picture(gl, camera);
        const PixelRays rays(camera, kWidth, kHeight);
        for (const double radius : {0.1, 0.3, 1.0}) {
            std::vector<Particle> particles;
            for (int i = 0; i < 200; ++i) {
                const int x = random.integer(0, kWidth - 1), y = random.integer(0, kHeight - 1);
                const float depth =
                    picture.depth[static_cast<std::size_t>((kHeight - 1 - y) * kWidth + x)];
                const PixelRay ray = rays.at(x, y, double(depth));
                if (ray.sky) continue;
                const Vector3d off(random.uniform(-1, 1), random.uniform(-1, 1),
                                   random.uniform(-1, 1));
                particles.push_back({ray.end + 0.6 * radius * off, radius, 0.99});
            }
            CHECK(particles.size() > 20);
            CAPTURE(radius);
            CHECK_LE(error_of(gl, camera, particles, *pass), kMaxError);
        }
    }
}

TEST_CASE("particles: round the eye, behind it and far from the origin") {
    const Gl& gl = osmesa().gl();
    Camera camera = camera_cases().front().camera;
    auto pass = FogPass::create(gl, {}, {}, {1, 1, 1}, {}, {kAllChannels});
    const Vector3d back = (camera.eye - camera.target).normalized();
    std::vector<Particle> particles;
    for (const double along : {-4.0, -0.5, 0.0, 0.5, 3.0, 8.0})
        for (const double radius : {1.0, 2.0, 5.0, 50.0})
            particles.push_back({camera.eye + along * back + Vector3d(0.3, -0.2, 0), radius, 0.1});
    // Small ones close to the eye: their ends are rounded to a millionth of a metre.
    CHECK_LE(error_of(gl, camera, particles, *pass), kMaxError);
    const Vector3d far(1e6, 0, -2e6);
    camera.eye += far;
    camera.target += far;
    for (Particle& particle : particles) particle.position += far;
    CHECK_LE(error_of(gl, camera, particles, *pass), kMaxError);
}

TEST_CASE("particles: they add to maps and formulas, and need a pass made for them") {
    const Gl& gl = osmesa().gl();
    Random random(433);
    const Camera camera = camera_cases().front().camera;
    const Fog map = random_fog(32, 24, {.degree = 1, .levels = 2}, random);
    const auto textures = FogTextures::create(gl, map);
    const std::vector<FogModel> models = {ExponentialLayer{0.01, 1, 4}};
    const auto particles = random_particles(random, 40, 0.2);
    auto pass = FogPass::create(gl, {&*textures}, {}, {1, 1, 1}, models, {kAllChannels});
    REQUIRE(pass.has_value());
    REQUIRE(pass->set_particles(particles).has_value());
    FogPicture picture = make_picture(gl, camera);
    pass->draw_optical_depth(picture.frame, camera, picture.target.name());
    const Image tau = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
    int sky = 0;
    CHECK_LE(largest_error(picture, camera, tau, {Reference(map)}, 1, sky, models, particles),
             kMaxError);
    auto without = FogPass::create(gl, {&*textures}, {}, {1, 1, 1}, models);
    CHECK(without->set_particles(particles).error().kind == ErrorKind::usage);
}

TEST_CASE("particles: tiles list few particles, and larger tiles keep lists short") {
    Random random(439);
    Camera camera = camera_cases().front().camera;
    const auto matrices = camera_matrices(camera, 800, 600);
    std::vector<Particle> particles;
    for (int i = 0; i < 20000; ++i) {
        const double x = random.uniform(-60, 60), y = random.uniform(0, 10);
        particles.push_back({{x, y, random.uniform(-100, -20)}, 0.5, 0.2});
    }
    const auto tiles = make_particle_tiles(particles, camera, matrices, 800, 600);
    CHECK(tiles.side == 16);
    CHECK(tiles.first.size() == std::size_t(50 * 38 + 1));
    // A particle of 1 m at 60 m is 11 pixels wide: it touches up to 4 tiles, most fewer.
    CHECK(tiles.entries.size() < 4 * particles.size());
    for (Particle& particle : particles) particle.radius = 500;
    const auto coarse = make_particle_tiles(particles, camera, matrices, 800, 600);
    CHECK(coarse.side > 16);
    CHECK(coarse.entries.size() <= std::size_t(1) << 22);
}

TEST_CASE("obstacles: the terrain and a mesh stop what meets them, on the side it comes from") {
    Scene scene;
    const std::string data = WAVEFOG_DATA_DIR;
    scene.terrain = Terrain{data + "/dem_jacksboro_403x344.png", {-400, -341, 400, 341}, 0, 26};
    scene.meshes = {{data + "/meshes/hut.obj", {124, -0.1, 82}, 1, 52, true}};
    const auto obstacle = scene_obstacles(scene.terrain, scene.meshes);
    REQUIRE_MESSAGE(obstacle.has_value(), (obstacle ? "" : obstacle.error().message));
    const auto ground = (*obstacle)({60, 60, 60}, {60, -10, 60});
    REQUIRE(ground.has_value());
    CHECK(ground->normal.y() > 0.7);
    CHECK(!(*obstacle)({60, 60, 60}, {61, 59, 60}).has_value());
    // Down onto the hut's roof, from the side into its wall.
    const auto roof = (*obstacle)({124, 20, 82}, {124, 5, 82});
    REQUIRE(roof.has_value());
    CHECK(roof->point.y() > 7);  // the ground below lies at 3.6 m
    CHECK(roof->normal.y() > 0.3);
    const double floor = roof->point.y() - 4.9;
    const auto wall = (*obstacle)({134, floor + 1.5, 82}, {124, floor + 1.5, 82});
    REQUIRE(wall.has_value());
    CHECK(wall->normal.x() > 0.3);
    CHECK(wall->point.x() > 125);
    CHECK(!scene_obstacles({}, {}).value());
}
