// Pictures of the fog pass on OSMesa against the double-precision reference, pixel by pixel, from
// the same depth values.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "fogmap/fog_support.h"
#include "glsl_in_cpp.h"
#include "gpu/fog_picture.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

// As in fog_shader_test.cpp: float32 positions in a map of about 64 cells.
constexpr double kMaxError = 2e-6;

}  // namespace

TEST_CASE("fog pass: every basis, profile and camera equals the reference, mu 1 and below") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(41);
    for (const auto& [name, camera] : camera_cases()) {
        FogPicture picture = make_picture(gl, camera);
        for (int degree = 0; degree <= 2; ++degree) {
            FogOptions options;
            options.degree = degree;
            options.levels = 3;
            Fog fog = random_fog(64, 48, options, random);
            for (const auto& profile : all_profiles()) {
                fog.profile = profile;
                const auto textures = FogTextures::create(gl, fog);
                REQUIRE(textures.has_value());
                const std::vector<Reference> reference = {Reference(fog)};
                for (const double mu : {1.0, 0.6, 0.0}) {
                    auto pass = FogPass::create(gl, {&*textures}, {.mu = mu}, {1, 1, 1});
                    REQUIRE_MESSAGE(pass.has_value(), (pass ? "" : pass.error().message));
                    pass->draw_optical_depth(picture.frame, camera, picture.target.name());
                    const Image tau = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
                    int sky = 0;
                    CAPTURE(std::string(name));
                    CAPTURE(degree);
                    CAPTURE(static_cast<int>(profile.kind));
                    CAPTURE(mu);
                    CHECK_LE(largest_error(picture, camera, tau, reference, mu, sky), kMaxError);
                }
            }
        }
    }
}

TEST_CASE("fog pass: paper and paper-scaling equal the reference in pictures") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(59);
    for (const auto& [name, camera] : camera_cases()) {
        FogPicture picture = make_picture(gl, camera);
        for (int degree = 0; degree <= 2; ++degree) {
            FogOptions options;
            options.degree = degree;
            options.levels = 2;
            Fog fog = random_fog(48, 32, options, random);
            fog.profile = all_profiles()[1];
            const auto textures = FogTextures::create(gl, fog);
            const std::vector<Reference> reference = {Reference(fog)};
            for (const MethodKind kind : {MethodKind::paper, MethodKind::paper_scaling}) {
                auto pass = FogPass::create(gl, {&*textures}, {.kind = kind}, {1, 1, 1});
                REQUIRE_MESSAGE(pass.has_value(), (pass ? "" : pass.error().message));
                pass->draw_optical_depth(picture.frame, camera, picture.target.name());
                const Image tau = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
                int sky = 0;
                CAPTURE(std::string(name));
                CAPTURE(degree);
                CAPTURE(static_cast<int>(kind));
                // Degree 2 reads tables of 32 samples an edge (paper_test.cpp): 0.2 / 31^2.
                CHECK_LE(largest_error(picture, camera, tau, reference, 1, sky),
                         degree < 2 ? 5e-6 : 2.1e-4);
            }
        }
    }
}

TEST_CASE("fog pass: several fogs add up, repeat and a world offset of 1e6 m") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(43);
    Camera camera = camera_cases().front().camera;
    const Eigen::Vector3d offset(1e6, 0, -1e6);
    camera.eye += offset;
    camera.target += offset;
    FogPicture picture = make_picture(gl, camera);
    std::vector<Fog> fogs;
    for (const Boundary boundary : {Boundary::zero, Boundary::repeat, Boundary::zero}) {
        FogOptions options;
        options.degree = static_cast<int>(fogs.size());
        options.levels = 2;
        options.boundary = boundary;
        Fog fog = random_fog(32, 24, options, random);
        fog.profile = all_profiles()[1 + fogs.size()];
        fog.extinction = 0.02;
        fog.rect = {fog.rect.x0 + 1e6, fog.rect.z0 - 1e6, fog.rect.x1 + 1e6, fog.rect.z1 - 1e6};
        fogs.push_back(std::move(fog));
    }
    std::vector<FogTextures> textures;
    std::vector<const FogTextures*> pointers;
    std::vector<Reference> references;
    for (const auto& fog : fogs) {
        textures.push_back(std::move(*FogTextures::create(gl, fog)));
        references.emplace_back(fog);
    }
    for (const auto& t : textures) pointers.push_back(&t);
    auto pass = FogPass::create(gl, pointers, {}, {0.5, 0.6, 0.7});
    REQUIRE(pass.has_value());
    pass->draw_optical_depth(picture.frame, camera, picture.target.name());
    const Image tau = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
    int sky = 0;
    CHECK_LE(largest_error(picture, camera, tau, references, 1, sky), kMaxError);
    CHECK(sky > 0);
    CHECK(sky < kWidth * kHeight);

    // The blend, paper 004 eq. 4: T L_scene + (1 - T) L_fog.
    pass->draw_colour(picture.frame, camera, picture.target.name());
    const Image colour = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
    const double fog_colour[3] = {0.5, 0.6, 0.7};
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const double t = std::exp(-static_cast<double>(tau.at(x, y, 0)));
            for (int c = 0; c < 3; ++c)
                REQUIRE(std::abs(colour.at(x, y, c) - (t * 0.25 + (1 - t) * fog_colour[c])) < 1e-6);
        }
}

TEST_CASE("fog pass: no fog leaves the picture alone, wind moves the map") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    const Camera camera = camera_cases().front().camera;
    FogPicture picture = make_picture(gl, camera);
    auto none = FogPass::create(gl, {}, {}, {1, 1, 1});
    REQUIRE(none.has_value());
    none->draw_colour(picture.frame, camera, picture.target.name());
    const Image same = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
    CHECK(std::all_of(same.pixels.begin(), same.pixels.end(), [](float v) { return v == 0.25f; }));

    Random random(47);
    Fog fog = random_fog(32, 24, {.degree = 1, .levels = 2}, random);
    fog.wind = {2, -1};
    const auto moving = FogTextures::create(gl, fog);
    auto pass = FogPass::create(gl, {&*moving}, {}, {1, 1, 1});
    pass->draw_optical_depth(picture.frame, camera, picture.target.name(), 3);
    const Image later = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
    Fog moved = fog;
    moved.rect = {fog.rect.x0 + 6, fog.rect.z0 - 3, fog.rect.x1 + 6, fog.rect.z1 - 3};
    int sky = 0;
    CHECK_LE(largest_error(picture, camera, later, {Reference(moved)}, 1, sky), kMaxError);
}

TEST_CASE("fog pass: reference is not a GPU method, degree 3 is not drawn") {
    Context& context = osmesa();
    const auto pass = FogPass::create(context.gl(), {}, {.kind = MethodKind::reference}, {1, 1, 1});
    REQUIRE(!pass.has_value());
    CHECK(pass.error().kind == ErrorKind::usage);
    CHECK(pass.error().message.find("reference") != std::string::npos);

    Random random(53);
    const Fog cubic = random_fog(16, 16, {.degree = 3, .levels = 1}, random);
    const auto textures = FogTextures::create(context.gl(), cubic);
    REQUIRE(!textures.has_value());
    CHECK(textures.error().message.find("degree 3") != std::string::npos);
}

TEST_CASE("fog pass: the driver lays the uniform blocks out as the C++ structs") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    const auto program =
        build_program(gl, "post_fullscreen.vert", "fog_pass.frag",
                      {"FOG_METHOD 4", "FOG_DEGREE 1", "FOG_PROFILE 0", "FOG_OUTPUT_TAU"});
    REQUIRE_MESSAGE(program.has_value(), (program ? "" : program.error().message));
    const auto size_of = [&](const char* name) {
        const GLuint index = gl.GetUniformBlockIndex(program->name(), name);
        REQUIRE(index != GL_INVALID_INDEX);
        GLint bytes = 0;
        gl.GetActiveUniformBlockiv(program->name(), index, GL_UNIFORM_BLOCK_DATA_SIZE, &bytes);
        return static_cast<std::size_t>(bytes);
    };
    // Members are vec4, ivec4 or arrays of them, so equal sizes mean equal std140 offsets.
    CHECK(size_of("FogBlock") == sizeof(shader::FogBlock));
    CHECK(size_of("ViewBlock") == sizeof(shader::ViewBlock));
    CHECK(size_of("PaperBlock") == sizeof(shader::PaperBlock));
}
