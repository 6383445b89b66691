// Depth pictures from elsewhere: every convention comes to the same distances.
#include "wavefog/gpu/depth_picture.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "support/random.h"
#include "wavefog/gpu/pixel_rays.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr int kWidth = 16, kHeight = 12;

CameraFile camera_file(DepthValues::Kind kind, DepthValues::Measured measured, double scale = 1) {
    CameraFile file;
    file.camera.eye = {30, 4, -7};
    file.camera.target = {10, 1, 3};
    file.camera.far_plane = 4000;
    file.camera.lens_shift = {0.2, -0.1};
    file.depth = {kind, measured, scale};
    return file;
}

/// Metres along the axis, 0.02 to 3500, evenly in their logarithm.
Image random_metres(Random& random) {
    Image image{kWidth, kHeight, 1, {}};
    for (int i = 0; i < kWidth * kHeight; ++i)
        image.pixels.push_back(float(0.02 * std::pow(175000, random.uniform(0, 1))));
    return image;
}

/// Largest relative error of distance along the axis.
double axis_error(const DepthPicture& picture, const Image& metres) {
    const PixelRays rays(picture.camera, kWidth, kHeight);
    const Eigen::Vector3d axis = (picture.camera.target - picture.camera.eye).normalized();
    double worst = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const PixelRay ray = rays.at(x, y, double(picture.depth.at(x, y, 0)));
            REQUIRE_FALSE(ray.sky);
            const double found = (ray.end - picture.camera.eye).dot(axis);
            const double wanted = double(metres.at(x, y, 0));
            worst = std::max(worst, std::abs(found - wanted) / wanted);
        }
    return worst;
}

}  // namespace

TEST_CASE("depth pictures: metres and inverse metres, along the axis and from the eye") {
    using Kind = DepthValues::Kind;
    using Measured = DepthValues::Measured;
    Random random(61);
    for (const auto projection :
         {Camera::Projection::perspective, Camera::Projection::orthographic})
        for (const Kind kind : {Kind::metres, Kind::inverse})
            for (const Measured measured : {Measured::axis, Measured::distance})
                for (const double scale : {1.0, 65.535})
                    for (const bool infinite : {false, true}) {
                        const bool perspective = projection == Camera::Projection::perspective;
                        if (infinite && !perspective) continue;
                        CameraFile file = camera_file(kind, measured, scale);
                        file.camera.projection = projection;
                        file.camera.near_plane = perspective ? 0.1 : 0;
                        if (infinite) file.camera.far_plane = INFINITY;
                        const Image metres = random_metres(random);
                        Image values = metres;
                        const PixelRays rays(file.camera, kWidth, kHeight);
                        for (int y = 0; y < kHeight; ++y)
                            for (int x = 0; x < kWidth; ++x) {
                                float& v = values.at(x, y, 0);
                                double m = double(v);
                                if (measured == Measured::distance && perspective) {
                                    const PixelRay ray = rays.at(x, y, 0.25);
                                    m /= (ray.end - ray.origin)
                                             .normalized()
                                             .dot((file.camera.target - file.camera.eye)
                                                      .normalized());
                                }
                                v = float(kind == Kind::inverse ? scale / m : m / scale);
                            }
                        const auto picture = depth_for_fog(values, file);
                        REQUIRE_MESSAGE(picture.has_value(),
                                        (picture ? "" : picture.error().message));
                        CHECK(picture->background == 0);
                        CHECK(picture->unmeasured == 0);
                        // Two roundings to float32; an orthographic buffer rounds the whole range.
                        if (perspective)
                            CHECK_LE(axis_error(*picture, metres), 4 * 0x1p-24);
                        else
                            for (int i = 0; i < kWidth * kHeight; ++i)
                                CHECK(4000 * (1 - double(picture->depth.pixels[std::size_t(i)])) ==
                                      doctest::Approx(double(metres.pixels[std::size_t(i)]))
                                          .epsilon(1e-3));
                    }
}

TEST_CASE("depth pictures: infinite and far is background, NaN and 0 metres are counted") {
    using Kind = DepthValues::Kind;
    const Image values{3, 2, 1, {kInfinity, NAN, 0, 4000, 5000, 7}};
    const auto metres =
        depth_for_fog(values, camera_file(Kind::metres, DepthValues::Measured::axis));
    REQUIRE(metres.has_value());
    CHECK(metres->background == 3);
    CHECK(metres->unmeasured == 2);
    const auto inverse =
        depth_for_fog(values, camera_file(Kind::inverse, DepthValues::Measured::axis));
    REQUIRE(inverse.has_value());
    CHECK(inverse->background == 1);  // 0
    CHECK(inverse->unmeasured == 2);  // infinite 1 / m too, as disparities are where none was found
    for (const bool reversed : {false, true}) {
        CameraFile file = camera_file(Kind::gl, DepthValues::Measured::axis);
        if (reversed) file.camera.depth = Camera::Depth::reversed;
        const Image depths{4, 1, 1, {kInfinity, NAN, reversed ? 0.0f : 1.0f, 0.5f}};
        const auto gl = depth_for_fog(depths, file);
        REQUIRE(gl.has_value());
        CHECK(gl->background == 2);
        CHECK(gl->unmeasured == 1);
        const float sky = reversed ? 0.0f : 1.0f;
        CHECK(gl->depth.pixels == std::vector<float>{sky, sky, sky, 0.5f});
        CHECK(gl->camera.far_plane == 4000);
    }
    // Nothing but sky.
    const auto empty = depth_for_fog(Image{1, 1, 1, {kInfinity}},
                                     camera_file(Kind::metres, DepthValues::Measured::axis));
    REQUIRE(empty.has_value());
    CHECK(empty->depth.pixels[0] == 0);
}

TEST_CASE("depth pictures: a stereo pair's disparities, and what one eye does not see") {
    using Kind = DepthValues::Kind;
    // Metres 2 and 5 with holes between, before and behind, a row without any, one with sky.
    CameraFile file = camera_file(Kind::inverse, DepthValues::Measured::axis, 60);
    file.depth.offset = 10;
    const float near = 60.0f / 2 - 10, far = 60.0f / 5 - 10, hole = kInfinity;
    const Image values{
        5,
        3,
        1,
        {hole, near, hole, far, hole, hole, hole, hole, hole, hole, near, hole, -10, hole, near}};
    const auto metres_of = [&](const DepthPicture& picture, int x, int y) {
        const PixelRays rays(picture.camera, 5, 3);
        const PixelRay ray = rays.at(x, y, double(picture.depth.at(x, y, 0)));
        if (ray.sky) return double(kInfinity);
        return (ray.end - picture.camera.eye)
            .dot((picture.camera.target - picture.camera.eye).normalized());
    };
    for (const bool fill : {false, true}) {
        file.depth.unmeasured =
            fill ? DepthValues::Unmeasured::neighbours : DepthValues::Unmeasured::background;
        const auto picture = depth_for_fog(values, file);
        REQUIRE_MESSAGE(picture.has_value(), (picture ? "" : picture.error().message));
        CHECK(picture->unmeasured == 10);
        CHECK(picture->background == 1);
        const double wanted[] = {2, 2, 5, 5, 5};
        for (int x = 0; x < 5; ++x) {
            const double m = metres_of(*picture, x, 0);
            if (fill || x % 2 == 1) CHECK(m == doctest::Approx(wanted[x]).epsilon(1e-6));
            if (!fill && x % 2 == 0) CHECK(std::isinf(m));
            CHECK(std::isinf(metres_of(*picture, x, 1)));
        }
        CHECK(metres_of(*picture, 0, 2) == doctest::Approx(2).epsilon(1e-6));
        CHECK(std::isinf(metres_of(*picture, 1, 2)));  // the sky is the farther one
        CHECK(std::isinf(metres_of(*picture, 2, 2)));
    }
    const auto low = depth_for_fog(Image{1, 1, 1, {-11}}, file);
    REQUIRE_FALSE(low.has_value());
    CHECK(low.error().message.find("pixel (0, 0) is -11 (and \"depth_offset\" 10)") == 0);
}

TEST_CASE("depth pictures: what cannot be is named with its pixel") {
    using Kind = DepthValues::Kind;
    const auto complaint = [](const Image& values, Kind kind) {
        const auto picture =
            depth_for_fog(values, camera_file(kind, DepthValues::Measured::distance));
        return picture ? std::string() : picture.error().message;
    };
    CHECK(complaint({2, 1, 1, {1, -2}}, Kind::metres).find("pixel (1, 0) is -2") == 0);
    CHECK(complaint({1, 2, 1, {1, -2}}, Kind::inverse).find("pixel (0, 1) is -2") == 0);
    CHECK(complaint({2, 1, 1, {0.5f, 7}}, Kind::gl).find("pixel (1, 0) is 7") == 0);
    CHECK(complaint({1, 1, 3, {1, 2, 1}}, Kind::metres).find("3 channels differ at pixel (0, 0)") ==
          0);
    CHECK(complaint({1, 1, 3, {1, 1, 1}}, Kind::metres).empty());
}
