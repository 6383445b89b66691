// What tests of the gpu library share: a context, pixels back to world points.
#pragma once

#include <doctest/doctest.h>

#include <Eigen/Dense>
#include <memory>

#include "support/temp_dir.h"
#include "wavefog/gpu/context.h"
#include "wavefog/gpu/frame.h"

namespace wavefog::test {

/// The OSMesa context that the whole test program uses. It must exist: there is no silent skip.
inline Context& osmesa() {
    static std::unique_ptr<Context> context = [] {
        auto created = create_context("osmesa");
        REQUIRE_MESSAGE(created.has_value(), (created ? "" : created.error().message));
        return std::move(*created);
    }();
    const auto current = context->make_current();
    REQUIRE(current.has_value());
    return *context;
}

/// The world point of a pixel's centre at a depth; x and y count from the top left.
inline Eigen::Vector3d world_point(const Camera& camera, int width, int height, int x, int y,
                                   double depth) {
    CameraMatrices m = camera_matrices(camera, width, height);
    m.view.topRightCorner<3, 1>().setZero();
    const Eigen::Vector4d clip(2 * (x + 0.5) / width - 1, 1 - 2 * (y + 0.5) / height, depth, 1);
    const Eigen::Vector4d eye = (m.projection * m.view).inverse() * clip;
    return camera.eye + eye.head<3>() / eye.w();
}

/// Draws a scene and reads colour and depth back.
struct Picture {
    Image colour, depth;
};
inline Picture draw(const Gl& gl, const Scene& scene) {
    const FrameTarget target = make_frame_target(gl, scene.width, scene.height);
    REQUIRE(target.framebuffer);
    const auto renderer = SceneRenderer::create(gl, scene);
    REQUIRE_MESSAGE(renderer.has_value(), (renderer ? "" : renderer.error().message));
    renderer->draw(target, scene.camera);
    Picture picture{read_texture(gl, target.colour.name(), scene.width, scene.height, 4),
                    read_texture(gl, target.depth.name(), scene.width, scene.height, 1, true)};
    CHECK(gl.GetError() == GL_NO_ERROR);
    return picture;
}

}  // namespace wavefog::test
