#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "support/random.h"
#include "wavefog/gpu/frame.h"

using namespace wavefog;
using Eigen::Vector3d;
using Eigen::Vector4d;

namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Depth of a point `distance` metres straight ahead.
double depth_ahead(const Camera& camera, double distance) {
    const CameraMatrices m = camera_matrices(camera, 640, 480);
    const Vector3d ahead = camera.eye + distance * (camera.target - camera.eye).normalized();
    const Vector4d clip = m.projection * m.view * ahead.homogeneous();
    return clip.z() / clip.w();
}

}  // namespace

TEST_CASE("depth runs from the near to the far plane in every convention") {
    for (const auto projection :
         {Camera::Projection::perspective, Camera::Projection::orthographic})
        for (const auto depth : {Camera::Depth::standard, Camera::Depth::reversed})
            for (const double far : {500.0, infinity}) {
                if (projection == Camera::Projection::orthographic && far == infinity) continue;
                CAPTURE(int(projection));
                CAPTURE(int(depth));
                CAPTURE(far);
                Camera camera;
                camera.projection = projection;
                camera.depth = depth;
                camera.eye = {3, 4, 5};
                camera.target = {-20, 1, 9};
                camera.near_plane = 0.5;
                camera.far_plane = far;
                const bool reversed = depth == Camera::Depth::reversed;
                const double sky = camera_matrices(camera, 640, 480).sky_depth;
                CHECK(sky == (reversed ? 0 : 1));
                CHECK(depth_ahead(camera, 0.5) == doctest::Approx(reversed ? 1 : 0).epsilon(1e-12));
                if (far == infinity)
                    CHECK(depth_ahead(camera, 1e12) == doctest::Approx(sky).epsilon(1e-11));
                else
                    CHECK(depth_ahead(camera, far) == doctest::Approx(sky).epsilon(1e-12));

                const double at_20 = depth_ahead(camera, 20);
                double expected = 0;
                if (projection == Camera::Projection::orthographic)
                    expected = (20 - 0.5) / (500 - 0.5);
                else if (far == infinity)
                    expected = 1 - 0.5 / 20;
                else
                    expected = 500 * (20 - 0.5) / (20 * (500 - 0.5));
                CHECK(at_20 == doctest::Approx(reversed ? 1 - expected : expected).epsilon(1e-12));
            }
}

TEST_CASE("a pixel's ray through its depth meets the point that was projected") {
    test::Random random(21);
    for (int trial = 0; trial < 400; ++trial) {
        Camera camera;
        camera.projection =
            trial % 3 == 0 ? Camera::Projection::orthographic : Camera::Projection::perspective;
        camera.depth = trial % 2 ? Camera::Depth::reversed : Camera::Depth::standard;
        camera.eye = {random.uniform(-50, 50), random.uniform(-50, 50), random.uniform(-50, 50)};
        camera.target = camera.eye + Vector3d(random.normal(), random.normal(), random.normal());
        camera.lens_shift = {random.uniform(-0.6, 0.6), random.uniform(-0.6, 0.6)};
        camera.fov_y_deg = random.uniform(20, 110);
        camera.far_plane = trial % 3 == 1 ? infinity : 900;
        const CameraMatrices m = camera_matrices(camera, 320, 200);
        const Vector4d view(random.uniform(-30, 30), random.uniform(-20, 20),
                            -random.uniform(0.2, 800), 1);
        const Vector3d world = (m.view.inverse() * view).head<3>();
        const Vector4d clip = m.projection * view;
        const Vector4d back = (m.projection * m.view).inverse() * (clip / clip.w());
        const double error = (back.head<3>() / back.w() - world).norm();
        CHECK(error < 1e-6 * (1 + view.norm()));
    }
}

TEST_CASE("the view is a rotation, up is up, and lens shift moves the image plane") {
    Camera camera;
    camera.eye = {1, 2, 3};
    camera.target = {1, 2, -10};
    camera.fov_y_deg = 90;
    CameraMatrices m = camera_matrices(camera, 200, 100);
    CHECK((m.view.topLeftCorner<3, 3>() * m.view.topLeftCorner<3, 3>().transpose() -
           Eigen::Matrix3d::Identity())
              .norm() < 1e-14);
    // At 10 m with 90 degrees the picture's top is 10 m above the axis, its right edge 20 m away.
    Vector4d clip = m.projection * m.view * Vector4d(1 + 20, 2 + 10, 3 - 10, 1);
    CHECK(clip.x() / clip.w() == doctest::Approx(1));
    CHECK(clip.y() / clip.w() == doctest::Approx(1));

    camera.lens_shift = {0.5, -0.25};
    m = camera_matrices(camera, 200, 100);
    clip = m.projection * m.view * Vector4d(1, 2, 3 - 10, 1);
    CHECK(clip.x() / clip.w() == doctest::Approx(-0.5));
    CHECK(clip.y() / clip.w() == doctest::Approx(0.25));

    camera.target = camera.eye + Vector3d(0, -5, 0);
    m = camera_matrices(camera, 200, 100);
    CHECK(m.view.allFinite());
    CHECK(m.view.determinant() == doctest::Approx(1));
}
