#include <cmath>
#include <limits>

#include "gl_support.h"
#include "wavefog/gpu/terrain.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

/// Rolling hills, 48 x 40 pixels.
std::filesystem::path write_hills(const TempDir& scratch) {
    Image image{48, 40, 1, std::vector<float>(48 * 40)};
    for (int y = 0; y < 40; ++y)
        for (int x = 0; x < 48; ++x)
            image.at(x, y, 0) = float(std::sin(0.31 * x) + std::cos(0.23 * y + 0.1 * x));
    const auto file = scratch / "hills.exr";
    REQUIRE(write_image(file, image).has_value());
    return file;
}

}  // namespace

TEST_CASE(
    "height maps: least and greatest pixel become the given heights, pixels at their centres") {
    const TempDir scratch;
    const auto file = scratch / "ramp.exr";
    REQUIRE(write_image(file, Image{3, 1, 1, {10, 30, 20}}).has_value());
    const auto field = HeightField::load({file, {100, 0, 130, 10}, -5, 45});
    REQUIRE(field.has_value());
    CHECK(field->height(105, 5) == doctest::Approx(-5));
    CHECK(field->height(115, 5) == doctest::Approx(45));
    CHECK(field->height(125, 9) == doctest::Approx(20));
    CHECK(field->height(-1000, 5) == doctest::Approx(-5));
    CHECK(field->columns() == 3);
}

TEST_CASE("steps of 8-bit height maps become slopes and no pixel moves by more than half a step") {
    const TempDir scratch;
    Image image{64, 8, 1, std::vector<float>(64 * 8)};
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 64; ++x) image.at(x, y, 0) = float(x / 4);
    const auto file = scratch / "steps.tif";
    REQUIRE(write_image(file, image).has_value());
    const auto field = HeightField::load({file, {0, 0, 64, 8}, 0, 15});
    REQUIRE(field.has_value());
    double steepest = 0;
    for (int x = 5; x < 59; ++x) {
        CHECK(std::abs(field->height(x + 0.5, 4) - x / 4) <= 0.5 + 1e-6);
        steepest = std::max(steepest, field->height(x + 0.5, 4) - field->height(x - 0.5, 4));
    }
    CHECK(steepest < 0.4);  // 1 in the picture, 1/4 for a straight slope
}

TEST_CASE("a height map that cannot be read or is not finite is an error that names it") {
    const TempDir scratch;
    Scene scene;
    scene.terrain = Terrain{scratch / "nowhere.png", {0, 0, 1, 1}, 0, 1};
    auto renderer = SceneRenderer::create(osmesa().gl(), scene);
    REQUIRE_FALSE(renderer.has_value());
    CHECK(renderer.error().kind == ErrorKind::data);
    CHECK(renderer.error().message.find("nowhere.png") != std::string::npos);

    const auto file = scratch / "nan.exr";
    const float nan = std::numeric_limits<float>::quiet_NaN();
    REQUIRE(write_image(file, Image{2, 2, 1, {0, 0, nan, 0}}).has_value());
    scene.terrain->heightmap = file;
    renderer = SceneRenderer::create(osmesa().gl(), scene);
    REQUIRE_FALSE(renderer.has_value());
    CHECK(renderer.error().message.find("nan.exr: pixel (0, 1)") != std::string::npos);
}

TEST_CASE(
    "drawn terrain has the heights of the map: all projections, also 1000 km from the origin") {
    const TempDir scratch;
    const auto file = write_hills(scratch);
    for (const double offset : {0.0, 1e6})
        for (const auto projection :
             {Camera::Projection::perspective, Camera::Projection::orthographic})
            for (const auto depth : {Camera::Depth::standard, Camera::Depth::reversed}) {
                CAPTURE(offset);
                CAPTURE(int(projection));
                CAPTURE(int(depth));
                Scene scene;
                scene.width = 60;
                scene.height = 40;
                const Rect rect{offset - 240, -offset - 200, offset + 240, -offset + 200};
                scene.terrain = Terrain{file, rect, 10, 50};
                scene.camera.projection = projection;
                scene.camera.depth = depth;
                scene.camera.ortho_height = 150;
                scene.camera.near_plane = 5;
                scene.camera.far_plane = 1000;
                scene.camera.eye = {offset + 60, 220, -offset + 120};
                scene.camera.target = {offset, 20, -offset};
                scene.camera.lens_shift = {0.1, -0.05};
                const auto field = HeightField::load(*scene.terrain);
                REQUIRE(field.has_value());
                const Picture picture = draw(osmesa().gl(), scene);
                double worst = 0;
                int sky = 0;
                for (int y = 0; y < scene.height; ++y)
                    for (int x = 0; x < scene.width; ++x) {
                        const double d = picture.depth.at(x, y, 0);
                        if (d == (depth == Camera::Depth::standard ? 1 : 0)) {
                            ++sky;
                            continue;
                        }
                        const Eigen::Vector3d p =
                            world_point(scene.camera, scene.width, scene.height, x, y, d);
                        worst = std::max(worst, std::abs(p.y() - field->height(p.x(), p.z())));
                    }
                CHECK(sky < scene.width * scene.height / 20);
                // Triangles of 2.5 m against a bicubic surface that bends by up to 0.02 / m.
                CHECK(worst < 0.03);
            }
}

TEST_CASE("slopes that face the sun are brighter, and a hill throws a shadow") {
    const TempDir scratch;
    Image image{64, 64, 1, std::vector<float>(64 * 64)};
    for (int y = 0; y < 64; ++y)
        for (int x = 0; x < 64; ++x)
            image.at(x, y, 0) =
                float(std::exp(-0.02 * ((x - 32) * (x - 32) + (y - 32) * (y - 32))));
    const auto file = scratch / "hill.exr";
    REQUIRE(write_image(file, image).has_value());
    Scene scene;
    scene.width = scene.height = 64;
    scene.terrain = Terrain{file, {-64, -64, 64, 64}, 0, 30};
    scene.sun.direction = Eigen::Vector3d(1, 0.35, 0).normalized();
    scene.camera.projection = Camera::Projection::orthographic;
    scene.camera.ortho_height = 128;
    scene.camera.eye = {0, 100, 0};
    scene.camera.target = {0, 0, 0};
    scene.camera.up = {0, 0, -1};
    const Picture picture = draw(osmesa().gl(), scene);
    const auto brightness = [&](int x) {
        double sum = 0;
        for (int y = 30; y < 34; ++y) sum += picture.colour.at(x, y, 1);
        return sum / 4;
    };
    CHECK(brightness(37) > 1.5 * brightness(27));  // the sun's side of the hill, the other one
    CHECK(brightness(58) > 1.5 * brightness(20));  // open ground, ground in the hill's shadow
}
