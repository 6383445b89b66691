// Fogs that red, green and blue see differently (paper 001, eq. 9), on OSMesa against the
// reference.
#include <doctest/doctest.h>

#include "fogmap/fog_support.h"
#include "fogmap/model_support.h"
#include "gpu/fog_picture.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

// As in models_test.cpp; of three fogs.
constexpr double kMaxError = 3 * 2e-6;

struct Errors {
    double transmittance = 0, colour = 0;
};

Errors draw(const Gl& gl, const Camera& camera, FogPass& pass, const std::vector<Reference>& maps,
            const std::vector<FogModel>& models, const Eigen::Vector3d& fog_colour,
            const std::vector<Particle>& particles = {}) {
    FogPicture picture = make_picture(gl, camera);
    pass.draw_optical_depth(picture.frame, camera, picture.target.name());
    const Image tau = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
    pass.draw_colour(picture.frame, camera, picture.target.name());
    const Image colour = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
    const PixelRays rays(camera, kWidth, kHeight);
    Errors errors;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const float depth =
                picture.depth[static_cast<std::size_t>((kHeight - 1 - y) * kWidth + x)];
            const Eigen::Array3d truth =
                rays.channel_depths(maps, rays.at(x, y, double(depth)), 1, models, particles);
            for (int c = 0; c < 3; ++c) {
                const double t = std::exp(-truth[c]);
                errors.transmittance = std::max(errors.transmittance,
                                                std::abs(std::exp(-double(tau.at(x, y, c))) - t));
                errors.colour = std::max(
                    errors.colour,
                    std::abs(double(colour.at(x, y, c)) - (t * 0.25 + (1 - t) * fog_colour[c])));
            }
        }
    return errors;
}

}  // namespace

TEST_CASE("channels: maps and formulas, alone and together, with every way to draw a map") {
    const Gl& gl = osmesa().gl();
    Random random(401);
    const Eigen::Vector3d fog_colour(0.9, 0.5, 0.2);
    Fog reddish = random_fog(32, 24, {.degree = 1, .levels = 2}, random);
    Fog bluish = random_fog(24, 32, {.degree = 2, .levels = 1}, random);
    reddish.channels = {0.2, 1, 2};
    bluish.channels = {1, 0.5, 0};
    const auto one = FogTextures::create(gl, reddish), two = FogTextures::create(gl, bluish);
    REQUIRE(one.has_value());
    REQUIRE(two.has_value());
    FogModel layer = Ramp{{{0, 0.03}, {6, 0}}}, waves = random_cosines(random),
             table = random_separable(random, {0, 0, 0}, true);
    layer.channels = {1, 0, 0};
    waves.channels = {1, 0, 0};
    table.channels = {0, 1, 0.25};

    const std::vector<const FogTextures*> map_sets[] = {{}, {&*one}, {&*one, &*two}};
    const std::vector<Reference> reference_sets[] = {
        {}, {Reference(reddish)}, {Reference(reddish), Reference(bluish)}};
    const std::vector<FogModel> model_sets[] = {{}, {layer}, {layer, table, waves}};
    for (std::size_t m = 0; m < 3; ++m)
        for (const auto& models : model_sets) {
            if (m == 0 && models.empty()) continue;
            auto pass = FogPass::create(gl, map_sets[m], {}, fog_colour, models);
            REQUIRE_MESSAGE(pass.has_value(), (pass ? "" : pass.error().message));
            CHECK(pass->coloured());
            for (const auto& [name, camera] : camera_cases()) {
                const Errors e = draw(gl, camera, *pass, reference_sets[m], models, fog_colour);
                CAPTURE(std::string(name));
                CHECK_LE(e.transmittance, kMaxError);
                CHECK_LE(e.colour, kMaxError);
            }
        }
    // A table of directions is as coarse for each channel as for all.
    const Camera camera = camera_cases().front().camera;
    auto radial =
        FogPass::create(gl, map_sets[2], *parse_method("radial"), fog_colour, model_sets[2]);
    REQUIRE_MESSAGE(radial.has_value(), (radial ? "" : radial.error().message));
    CHECK_LE(draw(gl, camera, *radial, reference_sets[2], model_sets[2], fog_colour).transmittance,
             5e-3);
}

TEST_CASE("channels: particles of several, few and many, with formulas and a map") {
    const Gl& gl = osmesa().gl();
    Random random(405);
    const Eigen::Vector3d fog_colour(0.9, 0.5, 0.2);
    Fog reddish = random_fog(32, 24, {.degree = 1, .levels = 2}, random);
    reddish.channels = {0.2, 1, 2};
    const auto map = FogTextures::create(gl, reddish);
    REQUIRE(map.has_value());
    FogModel layer = Ramp{{{0, 0.03}, {6, 0}}}, other = ExponentialLayer{0.01, 1, 4};
    layer.channels = {1, 0.5, 0.04};
    other.channels = {0, 0, 1};
    // Blue sees so little of the first that the others' early end would show.
    const std::vector<Channels> sets = {{1, 0.5, 0.04}, {0, 1, 0.25}, kAllChannels};
    for (const std::size_t kinds : {std::size_t(1), std::size_t(3)})
        for (const int count : {0, 30, 400}) {
            CAPTURE(kinds);
            CAPTURE(count);
            std::vector<Particle> particles;
            for (int i = 0; i < count; ++i) {
                const double x = random.uniform(-30, 30), y = random.uniform(-3, 12);
                particles.push_back({{x, y, random.uniform(-30, 30)},
                                     random.uniform(3, 9),
                                     (kinds == 1 ? 0.7 : 0.2) * random.uniform(),
                                     sets[std::size_t(i) % kinds]});
            }
            const std::vector<Channels> to_come(sets.begin(), sets.begin() + int(kinds));
            for (const auto& models : {std::vector<FogModel>{}, {layer, other}}) {
                auto pass = FogPass::create(gl, {&*map}, {}, fog_colour, models, to_come);
                REQUIRE_MESSAGE(pass.has_value(), (pass ? "" : pass.error().message));
                CHECK(pass->coloured());
                REQUIRE(pass->set_particles(particles).has_value());
                for (const auto& [name, camera] : camera_cases()) {
                    const Errors e = draw(gl, camera, *pass, {Reference(reddish)}, models,
                                          fog_colour, particles);
                    CAPTURE(std::string(name));
                    CHECK_LE(e.transmittance, kMaxError);
                    CHECK_LE(e.colour, kMaxError);
                }
                REQUIRE(pass->set_models(models).has_value());
                std::vector<Particle> strange = {{{0, 0, 0}, 1, 0.5, {0.5, 0.5, 0.5}}};
                const auto refused = pass->set_particles(strange);
                REQUIRE_FALSE(refused.has_value());
                CHECK(refused.error().kind == ErrorKind::usage);
            }
        }
}

TEST_CASE("channels: froxels err for each colour as they do for a fog seen by all alike") {
    const Gl& gl = osmesa().gl();
    Random random(403);
    const Eigen::Vector3d fog_colour(0.9, 0.5, 0.2);
    Fog reddish = random_fog(32, 24, {.degree = 1, .levels = 2}, random);
    Fog bluish = random_fog(24, 32, {.degree = 2, .levels = 1}, random);
    reddish.channels = {1, 0.5, 0};
    bluish.channels = {0, 0.5, 1};
    FogModel layer = Ramp{{{0, 0.03}, {6, 0}}};
    layer.channels = {1, 0, 0.5};
    const Method method = *parse_method("froxel:64x48x128");
    const Camera camera = camera_cases().front().camera;
    const FogPicture picture = make_picture(gl, camera);
    const auto pass_of = [&](const std::vector<const FogTextures*>& maps,
                             const std::vector<FogModel>& models) {
        auto pass = FogPass::create(gl, maps, method, fog_colour, models);
        REQUIRE_MESSAGE(pass.has_value(), (pass ? "" : pass.error().message));
        return *std::move(pass);
    };
    const auto depths_of = [&](FogPass& pass) {
        pass.draw_optical_depth(picture.frame, camera, picture.target.name());
        return read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
    };
    const auto one = FogTextures::create(gl, reddish), two = FogTextures::create(gl, bluish);
    FogPass all = pass_of({&*one, &*two}, {layer});
    const Image tau = depths_of(all);
    // Each channel alone: the same fogs, as thick as it sees them.
    for (std::size_t c = 0; c < 3; ++c) {
        Fog a = reddish, b = bluish;
        a.extinction *= reddish.channels[c];
        b.extinction *= bluish.channels[c];
        a.channels = b.channels = kAllChannels;
        const auto grey_one = FogTextures::create(gl, a), grey_two = FogTextures::create(gl, b);
        std::vector<FogModel> models;
        if (layer.channels[c] > 0) models = {Ramp{{{0, 0.03 * layer.channels[c]}, {6, 0}}}};
        FogPass alone = pass_of({&*grey_one, &*grey_two}, models);
        CHECK_FALSE(alone.coloured());
        const Image grey = depths_of(alone);
        double worst = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                worst = std::max(worst, std::abs(std::exp(-double(tau.at(x, y, int(c)))) -
                                                 std::exp(-double(grey.at(x, y, 0)))));
        // Volumes hold T as half floats.
        CHECK_LE(worst, 0x1p-11);
    }
    // The picture is what those depths make of it, its light told by half floats of T.
    CHECK_LE(
        draw(gl, camera, all, {Reference(reddish), Reference(bluish)}, {layer}, fog_colour).colour,
        0.03);
}

TEST_CASE("channels: formulas can be moved while their channels stay") {
    const Gl& gl = osmesa().gl();
    FogModel a = Ramp{{{0, 0.03}, {6, 0}}}, b = ExponentialLayer{0.02, 1, 4};
    a.channels = {1, 0, 0};
    b.channels = {0, 1, 1};
    auto pass = FogPass::create(gl, {}, {}, {1, 1, 1}, {a, b});
    REQUIRE(pass.has_value());
    std::get<ExponentialLayer>(b).base = 3;
    REQUIRE(pass->set_models({b, a}).has_value());
    const Camera camera = camera_cases().front().camera;
    CHECK_LE(draw(gl, camera, *pass, {}, {a, b}, {1, 1, 1}).transmittance, kMaxError);
    b.channels = a.channels;
    CHECK_FALSE(pass->set_models({a, b}).has_value());
}
