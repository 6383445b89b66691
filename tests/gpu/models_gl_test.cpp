// Pictures of fogs given by formulas on OSMesa against their twin in double, pixel by pixel.
#include <doctest/doctest.h>

#include "fogmap/fog_support.h"
#include "fogmap/model_support.h"
#include "glsl_in_cpp.h"
#include "gpu/fog_picture.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

// As in models_test.cpp.
constexpr double kMaxError = 2e-6;
struct Drawn {
    Image tau;
    double error = 0;
};

Drawn draw(const Gl& gl, FogPicture& picture, const Camera& camera, FogPass& pass,
           const std::vector<Reference>& maps, const std::vector<FogModel>& models) {
    pass.draw_optical_depth(picture.frame, camera, picture.target.name());
    Drawn drawn{read_texture(gl, picture.tau.name(), kWidth, kHeight, 4), 0};
    int sky = 0;
    drawn.error = largest_error(picture, camera, drawn.tau, maps, 1, sky, models);
    return drawn;
}

}  // namespace

TEST_CASE("models: pictures of every model by every camera equal the twin in double") {
    const Gl& gl = osmesa().gl();
    Random random(127);
    const auto models = all_models(random);
    std::vector<FogPass> passes;
    for (const FogModel& model : models) {
        auto pass = FogPass::create(gl, {}, {}, {1, 1, 1}, {model});
        REQUIRE_MESSAGE(pass.has_value(), (pass ? "" : pass.error().message));
        passes.push_back(std::move(*pass));
    }
    std::vector<double> worst(models.size());
    for (const auto& [name, camera] : camera_cases()) {
        FogPicture picture = make_picture(gl, camera);
        for (std::size_t i = 0; i < models.size(); ++i) {
            CAPTURE(std::string(name));
            CAPTURE(kind_name(models[i]));
            const double error = draw(gl, picture, camera, passes[i], {}, {models[i]}).error;
            worst[i] = std::max(worst[i], error);
            CHECK_LE(error, kMaxError);
        }
    }
    for (std::size_t i = 0; i < models.size(); ++i)
        MESSAGE(kind_name(models[i]), ": largest |dT| in pictures ", worst[i]);
}

TEST_CASE("models: a pass takes models of kinds that it was not made with") {
    const Gl& gl = osmesa().gl();
    Random random(129);
    const Camera camera = camera_cases().front().camera;
    FogPicture picture = make_picture(gl, camera);
    const auto models = random_models(random), fractions = random_fractions(random);
    auto pass = FogPass::create(gl, {}, {}, {1, 1, 1}, {models.front()});
    REQUIRE_MESSAGE(pass.has_value(), (pass ? "" : pass.error().message));
    for (const auto& now :
         {std::vector<FogModel>{fractions.front()}, std::vector<FogModel>{models[5], models[7]},
          models, std::vector<FogModel>{models[9]}}) {
        REQUIRE(pass->set_models(now).has_value());
        CAPTURE(now.size());
        CAPTURE(kind_name(now.front()));
        CHECK_LE(draw(gl, picture, camera, *pass, {}, now).error, kMaxError);
    }
}

TEST_CASE("models: maps and models add up with every method, and colour is blended once") {
    const Gl& gl = osmesa().gl();
    Random random(131);
    const Camera camera = camera_cases().front().camera;
    FogPicture picture = make_picture(gl, camera);
    const Fog map = random_fog(32, 24, {.degree = 1, .levels = 2}, random);
    const auto textures = FogTextures::create(gl, map);
    REQUIRE(textures.has_value());
    const std::vector<FogModel> models = {Halfspace{{0, 1, 0}, {0, 1, 0}, 0.02, 0},
                                          random_cosines(random)};
    for (const auto& maps : {std::vector<const FogTextures*>{&*textures},
                             std::vector<const FogTextures*>{&*textures, &*textures}}) {
        auto both = FogPass::create(gl, maps, {}, {0.5, 0.6, 0.7}, models);
        REQUIRE_MESSAGE(both.has_value(), (both ? "" : both.error().message));
        const std::vector<Reference> references(maps.size(), Reference(map));
        const Drawn drawn = draw(gl, picture, camera, *both, references, models);
        CHECK_LE(drawn.error, kMaxError);
        both->draw_colour(picture.frame, camera, picture.target.name());
        const Image colour = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
        const double fog_colour[3] = {0.5, 0.6, 0.7};
        double worst = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                for (int c = 0; c < 3; ++c) {
                    const double t = std::exp(-double(drawn.tau.at(x, y, 0)));
                    worst = std::max(worst, std::abs(double(colour.at(x, y, c)) -
                                                     (t * 0.25 + (1 - t) * fog_colour[c])));
                }
        CHECK_LE(worst, 1e-6);
    }
    // A method that samples changes the map's part alone; it is the same with and without models.
    const auto only = FogPass::create(gl, {}, {}, {1, 1, 1}, models);
    for (const char* name : {"march:16", "homogeneous", "froxel:16x12x16"}) {
        const Method method = *parse_method(name);
        auto alone = FogPass::create(gl, {&*textures}, method, {1, 1, 1});
        auto both = FogPass::create(gl, {&*textures}, method, {1, 1, 1}, models);
        REQUIRE(both.has_value());
        const Image a = draw(gl, picture, camera, *alone, {}, {}).tau;
        const Image b = draw(gl, picture, camera, *both, {}, {}).tau;
        const PixelRays rays(camera, kWidth, kHeight);
        double worst = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x) {
                const std::size_t row = static_cast<std::size_t>(kHeight - 1 - y) * kWidth;
                const PixelRay ray =
                    rays.at(x, y, picture.depth[row + static_cast<std::size_t>(x)]);
                const double added = rays.optical_depth({}, ray, 1, models);
                worst = std::max(worst, std::abs(std::exp(-double(b.at(x, y, 0))) -
                                                 std::exp(-double(a.at(x, y, 0)) - added)));
            }
        CAPTURE(std::string(name));
        CHECK_LE(worst, kMaxError);
    }
}

TEST_CASE("models: an invalid one is refused; the driver lays the block out as the C++ struct") {
    const Gl& gl = osmesa().gl();
    const auto pass = FogPass::create(gl, {}, {}, {1, 1, 1}, {ExponentialLayer{1, 0, -1}});
    REQUIRE_FALSE(pass.has_value());
    CHECK(pass.error().message.find("scale is -1") != std::string::npos);

    const auto program =
        build_program(gl, "post_fullscreen.vert", "fog_pass.frag",
                      {"FOG_METHOD 6", "FOG_DEGREE 0", "FOG_PROFILE 0", "FOG_OUTPUT_TAU"});
    REQUIRE_MESSAGE(program.has_value(), (program ? "" : program.error().message));
    const GLuint index = gl.GetUniformBlockIndex(program->name(), "ModelBlock");
    REQUIRE(index != GL_INVALID_INDEX);
    GLint bytes = 0;
    gl.GetActiveUniformBlockiv(program->name(), index, GL_UNIFORM_BLOCK_DATA_SIZE, &bytes);
    CHECK(static_cast<std::size_t>(bytes) == sizeof(shader::ModelBlock));
    CHECK(bytes <= 16384);  // the least that OpenGL promises
}
