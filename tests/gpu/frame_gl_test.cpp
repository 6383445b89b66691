#include <cmath>
#include <limits>

#include "gl_support.h"
#include "wavefog/gpu/timer.h"

using namespace wavefog;
using namespace wavefog::test;

TEST_CASE("a frame target holds RGBA16F and 32-bit float depth") {
    const Gl& gl = osmesa().gl();
    const FrameTarget target = make_frame_target(gl, 33, 17);
    REQUIRE(target.framebuffer);
    GLint format = 0;
    gl.BindTexture(GL_TEXTURE_2D, target.colour.name());
    gl.GetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_INTERNAL_FORMAT, &format);
    CHECK(format == GL_RGBA16F);
    gl.BindTexture(GL_TEXTURE_2D, target.depth.name());
    gl.GetTexLevelParameteriv(GL_TEXTURE_2D, 0, GL_TEXTURE_INTERNAL_FORMAT, &format);
    CHECK(format == GL_DEPTH_COMPONENT32F);
}

TEST_CASE("textures read back with row 0 at the top") {
    const Gl& gl = osmesa().gl();
    // OpenGL's rows run upwards: the first row uploaded is the lowest.
    const float texels[] = {1, 2, 3, 4, 5, 6};
    const Texture one = make_texture_2d(gl, GL_R32F, 2, 3, GL_RED, GL_FLOAT, texels);
    const Image image = read_texture(gl, one.name(), 2, 3, 1);
    CHECK(image.channels == 1);
    CHECK(image.at(0, 0, 0) == 5);
    CHECK(image.at(1, 0, 0) == 6);
    CHECK(image.at(0, 2, 0) == 1);

    const Image rgba = read_texture(gl, one.name(), 2, 3, 4);
    CHECK(rgba.channels == 4);
    CHECK(rgba.at(1, 2, 0) == 2);
    CHECK(rgba.at(1, 2, 3) == 1);
}

TEST_CASE("an empty scene is sky: colour everywhere, depth at its clear value") {
    Scene scene;
    scene.width = 40;
    scene.height = 30;
    scene.camera.target = scene.camera.eye + Eigen::Vector3d(0, 0.2, -1);
    for (const auto depth : {Camera::Depth::standard, Camera::Depth::reversed}) {
        scene.camera.depth = depth;
        const Picture picture = draw(osmesa().gl(), scene);
        const float clear = depth == Camera::Depth::standard ? 1.0f : 0.0f;
        for (const float value : picture.depth.pixels) REQUIRE(value == clear);
        // Paler at the horizon, deeper blue above.
        CHECK(picture.colour.at(5, 28, 0) > picture.colour.at(5, 1, 0));
        CHECK(picture.colour.at(5, 1, 2) > picture.colour.at(5, 1, 0));
    }
}

TEST_CASE("reversed infinite depth keeps distances to 1e-6 from a metre to 100 km") {
    const TempDir scratch;
    const auto flat = scratch / "flat.exr";
    REQUIRE(write_image(flat, Image{2, 2, 1, {0, 0, 0, 0}}).has_value());
    for (const double altitude : {1.0, 40.0, 2000.0, 100000.0}) {
        CAPTURE(altitude);
        Scene scene;
        scene.width = scene.height = 16;
        scene.terrain = Terrain{flat, {-3e5, -3e5, 3e5, 3e5}, 0, 0};
        scene.camera.depth = Camera::Depth::reversed;
        scene.camera.far_plane = std::numeric_limits<double>::infinity();
        scene.camera.eye = {12, altitude, -7};
        scene.camera.target = {12, 0, -7};
        scene.camera.up = {0, 0, -1};
        const Picture picture = draw(osmesa().gl(), scene);
        double worst = 0;
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x)
                worst = std::max(
                    worst,
                    std::abs(
                        world_point(scene.camera, 16, 16, x, y, picture.depth.at(x, y, 0)).y()));
        CHECK(worst <= 1e-6 * altitude);
    }
}

TEST_CASE("frame times are positive and percentiles interpolate") {
    const Gl& gl = osmesa().gl();
    const FrameTarget target = make_frame_target(gl, 64, 64);
    FrameTimer timer(gl);
    const FrameTime time = timer.time([&] {
        gl.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.name());
        gl.Clear(GL_COLOR_BUFFER_BIT);
    });
    CHECK(time.wall_ms > 0);
    CHECK(time.gpu_ms >= 0);
    CHECK(gl.GetError() == GL_NO_ERROR);

    Samples samples;
    CHECK(std::isnan(samples.median()));
    for (const double value : {5.0, 1.0, 3.0, 2.0, 4.0}) samples.add(value);
    CHECK(samples.size() == 5);
    CHECK(samples.median() == 3);
    CHECK(samples.percentile(0) == 1);
    CHECK(samples.percentile(100) == 5);
    CHECK(samples.percentile(5) == doctest::Approx(1.2));
}
