// Fog at the vertices of a scene (FogSampling::vertices), on OSMesa against fog in every pixel.
#include <doctest/doctest.h>

#include <cmath>

#include "fogmap/fog_support.h"
#include "fogmap/model_support.h"
#include "gl_support.h"
#include "wavefog/gpu/fog_pass.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

constexpr int kSide = 96;

/// Hills of `pixels` pixels a side over 48 m x 48 m with a large tilted square standing in them.
Scene hills(const TempDir& scratch, int pixels) {
    Image image{pixels, pixels, 1, {}};
    for (int y = 0; y < pixels; ++y)
        for (int x = 0; x < pixels; ++x)
            image.pixels.push_back(float(std::sin(7.0 * x / pixels) + std::cos(5.0 * y / pixels)));
    const auto file = scratch / "hills.exr";
    REQUIRE(write_image(file, image).has_value());
    scratch.write("square.obj", "v -3 -1 0\nv 3 -1 0\nv 3 4 0\nv -3 4 0\nf 1 2 3 4\n");
    Scene scene;
    scene.width = scene.height = kSide;
    scene.terrain = Terrain{file, {-24, -24, 24, 24}, 0, 5};
    scene.meshes.push_back({scratch / "square.obj", {1, 2, 2}, 1.5, 30, true});
    scene.camera.eye = {2, 9, 23};
    scene.camera.target = {0, 2, 0};
    scene.camera.far_plane = 200;
    return scene;
}

struct Stage {
    SceneRenderer renderer;
    FrameTarget frame;
    Texture tau;
    Framebuffer target;
    Image depth;
};

Stage stage_of(const Gl& gl, const Scene& scene) {
    auto renderer = SceneRenderer::create(gl, scene);
    REQUIRE_MESSAGE(renderer.has_value(), (renderer ? "" : renderer.error().message));
    Stage stage{std::move(*renderer),
                make_frame_target(gl, kSide, kSide),
                make_texture_2d(gl, GL_RGBA32F, kSide, kSide, GL_RGBA, GL_FLOAT, nullptr),
                {},
                {}};
    stage.renderer.draw(stage.frame, scene.camera);
    stage.target = std::move(*make_framebuffer(gl, stage.tau.name()));
    stage.depth = read_texture(gl, stage.frame.depth.name(), kSide, kSide, 1, true);
    return stage;
}

Image optical_depth(const Gl& gl, const Stage& stage, const Camera& camera,
                    const std::vector<const FogTextures*>& maps, const std::string& method,
                    const std::vector<FogModel>& models) {
    auto pass =
        FogPass::create(gl, maps, *parse_method(method), {1, 1, 1}, models, {}, &stage.renderer);
    REQUIRE_MESSAGE(pass.has_value(), (pass ? "" : pass.error().message));
    pass->draw_optical_depth(stage.frame, camera, stage.target.name());
    CHECK(gl.GetError() == GL_NO_ERROR);
    return read_texture(gl, stage.tau.name(), kSide, kSide, 4);
}

struct Errors {
    double surface = 0, sky = 0, mean = 0;
    int sky_pixels = 0;
};

Errors errors(const Image& at_vertices, const Image& in_pixels, const Stage& stage,
              const Camera& camera, int channel = 0) {
    const float background = float(camera_matrices(camera, kSide, kSide).sky_depth);
    Errors found;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
            const double d = std::abs(std::exp(-double(at_vertices.at(x, y, channel))) -
                                      std::exp(-double(in_pixels.at(x, y, channel))));
            REQUIRE(std::isfinite(d));
            const bool sky = stage.depth.at(x, y, 0) == background;
            double& largest = sky ? found.sky : found.surface;
            largest = std::max(largest, d);
            found.sky_pixels += sky;
            found.mean += d / (kSide * kSide);
        }
    return found;
}

}  // namespace

TEST_CASE("vertices: as in every pixel where triangles are small, the sky's pixels exactly") {
    const Gl& gl = osmesa().gl();
    const TempDir scratch;
    Random random(701);
    Fog map = random_fog(16, 12, {.degree = 2, .levels = 1}, random);
    const auto textures = FogTextures::create(gl, map);
    REQUIRE(textures.has_value());
    Scene scene = hills(scratch, 64);
    for (const bool orthographic : {false, true})
        for (const auto depth : {Camera::Depth::standard, Camera::Depth::reversed}) {
            scene.camera.depth = depth;
            scene.camera.projection =
                orthographic ? Camera::Projection::orthographic : Camera::Projection::perspective;
            scene.camera.ortho_height = 30;
            CAPTURE(orthographic);
            const Stage stage = stage_of(gl, scene);
            for (const char* method : {"exact", "march:16", "homogeneous", "paper-scaling"}) {
                CAPTURE(std::string(method));
                const std::vector<FogModel> models = {random_cosines(random)};
                const Image pixels =
                    optical_depth(gl, stage, scene.camera, {&*textures}, method, models);
                const Image vertices = optical_depth(gl, stage, scene.camera, {&*textures},
                                                     std::string(method) + "@vertices", models);
                const Errors e = errors(vertices, pixels, stage, scene.camera);
                MESSAGE(std::string(method), ": surfaces ", e.surface, ", mean ", e.mean, ", sky ",
                        e.sky, " in ", e.sky_pixels);
                // Terrain's edges are 0.3 m long, the square's 9 m: the fog between its corners
                // bends by its curvature, tau'' L^2 / 8.
                CHECK_LE(e.surface, 0.1);
                CHECK_LE(e.mean, 3e-3);
                CHECK(e.sky == 0);
                CHECK(e.sky_pixels > (orthographic ? -1 : 100));
            }
        }
}

TEST_CASE("vertices: fogs add up, for each colour") {
    const Gl& gl = osmesa().gl();
    const TempDir scratch;
    Random random(709);
    const Scene scene = hills(scratch, 32);
    const Stage stage = stage_of(gl, scene);
    Fog reddish = random_fog(16, 12, {.degree = 1, .levels = 1}, random);
    reddish.channels = {0.2, 1, 2};
    const auto tinted = FogTextures::create(gl, reddish);
    const auto grey = FogTextures::create(gl, random_fog(12, 16, {.degree = 2}, random));
    REQUIRE(tinted.has_value());
    REQUIRE(grey.has_value());
    FogModel waves = random_cosines(random);
    const auto draw = [&](const std::vector<const FogTextures*>& maps,
                          const std::vector<FogModel>& models) {
        return optical_depth(gl, stage, scene.camera, maps, "exact@vertices", models);
    };
    const Image a = draw({&*tinted}, {}), b = draw({&*grey}, {}), c = draw({}, {waves});
    const Image all = draw({&*tinted, &*grey}, {waves});
    double worst = 0;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
            for (int k = 0; k < 3; ++k)
                worst = std::max(worst,
                                 std::abs(std::exp(-double(all.at(x, y, k))) -
                                          std::exp(-double(a.at(x, y, k)) - double(b.at(x, y, 0)) -
                                                   double(c.at(x, y, 0)))));
    // What is interpolated is linear in the optical depth: float32 alone differs.
    CHECK_LE(worst, 2e-6);
}

TEST_CASE("vertices: triangles larger than the picture, with corners far outside it") {
    const Gl& gl = osmesa().gl();
    const TempDir scratch;
    Scene scene = hills(scratch, 2);
    scene.meshes.clear();
    scene.terrain->rect = {-300, -300, 300, 300};
    scene.terrain->height_max = scene.terrain->height_min;
    scene.camera.eye = {0, 4, 0};
    scene.camera.target = {10, 0, 3};
    const Stage stage = stage_of(gl, scene);
    const std::vector<FogModel> fog = {Halfspace{{0, 1, 0}, {0, 1000, 0}, 0.01, 0}};
    const Image pixels = optical_depth(gl, stage, scene.camera, {}, "exact", fog);
    const Image vertices = optical_depth(gl, stage, scene.camera, {}, "exact@vertices", fog);
    // A corner that was left out as unseen would have no fog.
    const Errors e = errors(vertices, pixels, stage, scene.camera);
    MESSAGE("surfaces ", e.surface, ", mean ", e.mean);
    CHECK_LE(e.surface, 0.3);
}
