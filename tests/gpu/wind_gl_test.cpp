// Wind in the shaders: precise after 1e6 s, and frames that do not depend on those before.
#include <doctest/doctest.h>

#include <cmath>

#include "fogmap/fog_support.h"
#include "fogmap/model_support.h"
#include "gpu/fog_picture.h"

using namespace wavefog;
using namespace wavefog::test;
using Eigen::Vector3d;

namespace {

// As for fogs at rest (models_test.cpp, fog_pass_gl_test.cpp): 1e6 s cost nothing.
constexpr double kMaxError = 2e-6;
constexpr double kLong = 1e6;

Vector3d far_away(const Wind& wind) {
    const Eigen::Vector2d offset = wind.offset(kLong);
    return {offset.x(), 0, offset.y()};
}

double difference(double a, double b) {
    return std::abs(std::exp(-a) - std::exp(-b));
}

}  // namespace

TEST_CASE("wind: the shader as C++ equals the reference after 1e6 s") {
    Random random(307);
    for (const Boundary boundary : {Boundary::zero, Boundary::repeat})
        for (const int degree : {0, 1, 2}) {
            Fog fog =
                random_fog(32, 24, {.degree = degree, .levels = 2, .boundary = boundary}, random);
            fog.wind = {7.3, -2.1};
            const Reference truth(fog, kLong);
            const auto shader = ShaderOnCpu::create(fog, {}, kLong);
            REQUIRE(shader.has_value());
            // The map has gone; what repeats is here and there.
            const Vector3d at = boundary == Boundary::zero ? far_away(fog.wind) : Vector3d(0, 0, 0);
            double worst = 0;
            for (int i = 0; i < 300; ++i) {
                const Vector3d o = at + random_point(random), p = at + random_point(random);
                const double tau = truth.optical_depth(o, p);
                worst = std::max(worst, difference(shader->optical_depth(o, p), tau));
            }
            CAPTURE(degree);
            CHECK_LE(worst, kMaxError);
        }
}

TEST_CASE("wind: formulas equal their twins in double after 1e6 s") {
    Random random(311);
    for (const FogModel& model : random_models(random)) {
        const std::vector<FogModel> there = models_at({model}, {Wind(7.3, -2.1)}, kLong);
        const auto shader = ModelsOnCpu::create(there);
        REQUIRE(shader.has_value());
        const Vector3d at = far_away(Wind(7.3, -2.1));
        for (const auto& [o, p] : model_segments(random, 300)) {
            CAPTURE(kind_name(model));
            // Where the model has gone, against the model at home.
            const double home = optical_depth(model, o, p);
            CHECK_LE(difference(shader->optical_depth(o + at, p + at), home), kMaxError);
        }
    }
}

TEST_CASE("wind: frame 599 is the same bit for bit, drawn alone or after 599 others") {
    const Gl& gl = osmesa().gl();
    Random random(313);
    const Camera camera = camera_cases().front().camera;
    FogPicture picture = make_picture(gl, camera);
    Fog fog = random_fog(32, 24, {.degree = 1, .levels = 2, .boundary = Boundary::repeat}, random);
    fog.wind.keys = {{0, 1, 0}, {5, -2, 3}, {20, 0.5, 0.5}};
    const auto textures = FogTextures::create(gl, fog);
    REQUIRE(textures.has_value());
    const auto models = random_models(random);
    const std::vector<ModelMotion> winds(models.size(), fog.wind);
    for (const MethodKind kind : {MethodKind::exact, MethodKind::radial}) {
        const auto draw = [&](FogPass& pass, int frame) {
            const double seconds = frame / 24.0;
            REQUIRE(pass.set_models(models_at(models, winds, seconds)).has_value());
            pass.draw_optical_depth(picture.frame, camera, picture.target.name(), seconds);
            return read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
        };
        auto alone = FogPass::create(gl, {&*textures}, {.kind = kind}, {1, 1, 1}, models);
        auto stepping = FogPass::create(gl, {&*textures}, {.kind = kind}, {1, 1, 1}, models);
        REQUIRE(alone.has_value());
        REQUIRE(stepping.has_value());
        for (int frame = 0; frame < 599; frame += kind == MethodKind::exact ? 1 : 37)
            draw(*stepping, frame);
        const Image last = draw(*stepping, 599);
        CHECK(last.pixels == draw(*alone, 599).pixels);
        int sky = 0;
        if (kind == MethodKind::exact)
            CHECK_LE(largest_error(picture, camera, last, {Reference(fog, 599 / 24.0)}, 1, sky,
                                   models_at(models, winds, 599 / 24.0)),
                     kMaxError);
    }
}

TEST_CASE("wind: formulas can be replaced only where there are some") {
    const Gl& gl = osmesa().gl();
    auto pass = FogPass::create(gl, {}, {}, {1, 1, 1});
    REQUIRE(pass.has_value());
    CHECK(pass->set_models({Halfspace{}}).error().kind == ErrorKind::usage);
}
