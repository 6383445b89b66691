#include "camera_reader.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <vector>

namespace wavefog::detail {

Camera read_camera(const JsonValue& value, std::initializer_list<std::string_view> more) {
    std::vector<std::string_view> keys(more);
    keys.insert(keys.end(), {"eye", "target", "up", "fov_y_deg", "near", "far", "projection",
                             "ortho_height", "depth", "lens_shift"});
    value.only(keys);
    Camera camera;
    camera.eye = value.key("eye").vector3();
    camera.target = value.key("target").vector3();
    if (const auto up = value.find("up")) camera.up = up->vector3();
    if (const auto projection = value.find("projection"))
        camera.projection = projection->choice({"perspective", "orthographic"}) == 0
                                ? Camera::Projection::perspective
                                : Camera::Projection::orthographic;
    if (const auto depth = value.find("depth"))
        camera.depth = depth->choice({"standard", "reversed"}) == 0 ? Camera::Depth::standard
                                                                    : Camera::Depth::reversed;
    if (const auto fov = value.find("fov_y_deg")) {
        camera.fov_y_deg = fov->above(0);
        if (camera.fov_y_deg >= 180)
            fov->fail(fmt::format("is {}; it must be below 180", camera.fov_y_deg));
    }
    if (const auto height = value.find("ortho_height")) camera.ortho_height = height->above(0);
    if (const auto shift = value.find("lens_shift")) {
        const auto v = shift->numbers(2);
        camera.lens_shift = {v[0], v[1]};
    }

    const bool perspective = camera.projection == Camera::Projection::perspective;
    if (const auto near_key = value.find("near"))
        camera.near_plane = perspective ? near_key->above(0) : near_key->number();
    if (const auto far_key = value.find("far")) {
        if (far_key->is_text()) {
            far_key->choice({"infinite"});
            if (!perspective)
                far_key->fail("is \"infinite\"; an orthographic camera needs a number");
            camera.far_plane = std::numeric_limits<double>::infinity();
        } else {
            camera.far_plane = far_key->number();
        }
    }
    if (!(camera.near_plane < camera.far_plane))
        value.fail(fmt::format("near is {}, far is {}; near must be smaller than far",
                               camera.near_plane, camera.far_plane));

    const Eigen::Vector3d view = camera.target - camera.eye;
    if (!(view.norm() > 0)) value.key("target").fail("is the same point as eye; move one of them");
    if (!(camera.up.norm() > 0)) value.key("up").fail("is [0, 0, 0]; give a direction");
    // 1e-6 is the sine of the smallest angle that still gives a float32 view matrix a usable side
    // vector.
    if (!(view.normalized().cross(camera.up.normalized()).norm() > 1e-6))
        value.fail(
            "up is parallel to the view from eye to target; choose another up, such as [0, 0, -1]");
    return camera;
}

}  // namespace wavefog::detail
