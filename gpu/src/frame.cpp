#include "wavefog/gpu/frame.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace wavefog {

FrameTarget make_frame_target(const Gl& gl, int width, int height) {
    FrameTarget target;
    target.width = width;
    target.height = height;
    target.colour = make_texture_2d(gl, GL_RGBA16F, width, height, GL_RGBA, GL_HALF_FLOAT, nullptr);
    target.depth = make_texture_2d(gl, GL_DEPTH_COMPONENT32F, width, height, GL_DEPTH_COMPONENT,
                                   GL_FLOAT, nullptr);
    if (auto framebuffer = make_framebuffer(gl, target.colour.name(), target.depth.name()))
        target.framebuffer = std::move(*framebuffer);
    return target;
}

CameraMatrices camera_matrices(const Camera& camera, int width, int height) {
    using Eigen::Vector3d;
    CameraMatrices matrices;
    const bool reversed = camera.depth == Camera::Depth::reversed;
    matrices.sky_depth = reversed ? 0 : 1;

    const Vector3d forward = (camera.target - camera.eye).normalized();
    // An `up` along the line of sight leaves the roll open: any perpendicular will do.
    Vector3d right = forward.cross(camera.up.normalized());
    if (right.norm() < 1e-9) right = forward.unitOrthogonal();
    right.normalize();
    const Vector3d up = right.cross(forward);
    matrices.view.setIdentity();
    matrices.view.row(0).head<3>() = right;
    matrices.view.row(1).head<3>() = up;
    matrices.view.row(2).head<3>() = -forward;
    matrices.view.topRightCorner<3, 1>() = -(matrices.view.topLeftCorner<3, 3>() * camera.eye);

    Eigen::Matrix4d& p = matrices.projection;
    p.setZero();
    const double aspect = double(width) / height * camera.pixel_aspect;
    const double n = camera.near_plane, f = camera.far_plane;
    if (camera.projection == Camera::Projection::perspective) {
        const double half_height = std::tan(camera.fov_y_deg * std::numbers::pi / 360);
        p(0, 0) = 1 / (half_height * aspect);
        p(1, 1) = 1 / half_height;
        p(0, 2) = camera.lens_shift.x();
        p(1, 2) = camera.lens_shift.y();
        // z_clip = A z_view + B with A, B in terms of n / f, which is 0 for an infinite far plane.
        const double ratio = std::isinf(f) ? 0 : n / f;
        p(2, 2) = (reversed ? ratio : -1) / (1 - ratio);
        p(2, 3) = (reversed ? n : -n) / (1 - ratio);
        p(3, 2) = -1;
    } else {
        const double half_height = camera.ortho_height / 2;
        p(0, 0) = 1 / (half_height * aspect);
        p(1, 1) = 1 / half_height;
        p(0, 3) = -camera.lens_shift.x();
        p(1, 3) = -camera.lens_shift.y();
        p(2, 2) = (reversed ? 1 : -1) / (f - n);
        p(2, 3) = (reversed ? f : -n) / (f - n);
        p(3, 3) = 1;
    }
    return matrices;
}

Image read_texture(const Gl& gl, GLuint texture, int width, int height, int channels, bool depth) {
    Image image;
    image.width = width;
    image.height = height;
    image.channels = depth ? 1 : channels;
    const std::size_t row = std::size_t(width) * std::size_t(image.channels);
    std::vector<float> rows(row * std::size_t(height));
    const GLenum format = depth ? GL_DEPTH_COMPONENT : image.channels == 1 ? GL_RED : GL_RGBA;
    gl.BindTexture(GL_TEXTURE_2D, texture);
    gl.PixelStorei(GL_PACK_ALIGNMENT, 1);
    gl.GetTexImage(GL_TEXTURE_2D, 0, format, GL_FLOAT, rows.data());
    // OpenGL's first row is the lowest one.
    image.pixels.resize(rows.size());
    for (std::size_t y = 0; y < std::size_t(height); ++y)
        std::copy_n(rows.begin() + std::ptrdiff_t(y * row), row,
                    image.pixels.begin() + std::ptrdiff_t((std::size_t(height) - 1 - y) * row));
    return image;
}

}  // namespace wavefog
