#include "fit/views.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace wavefog::cli {
namespace {

Camera turned(Camera camera, double yaw_degrees, double lift, double forward) {
    const Eigen::AngleAxisd turn(yaw_degrees * std::numbers::pi / 180, camera.up.normalized());
    const Eigen::Vector3d view = camera.target - camera.eye;
    camera.eye += forward * view + lift * camera.up.normalized();
    camera.target = camera.eye + turn * view;
    return camera;
}

}  // namespace

std::vector<std::pair<std::string, Camera>> tuning_cameras(const Camera& camera) {
    return {{"the scene's camera", camera},
            {"15 degrees to the left", turned(camera, 15, 0, 0)},
            {"15 degrees to the right", turned(camera, -15, 0, 0)}};
}

std::vector<std::pair<std::string, Camera>> held_out_cameras(const Camera& camera) {
    const double far = (camera.target - camera.eye).norm();
    return {{"8 degrees to the left", turned(camera, 8, 0, 0)},
            {"a little forward", turned(camera, 3, 0, 0.03)},
            {"a little back and higher", turned(camera, -5, 0.02 * far, -0.03)}};
}

Result<std::vector<View>> make_views(const Gl& gl, const Scene& scene, const std::vector<Fog>& fogs,
                                     const std::vector<std::pair<std::string, Camera>>& cameras,
                                     const Size& size) {
    const Result<SceneRenderer> renderer = SceneRenderer::create(gl, scene);
    if (!renderer) return tl::unexpected(renderer.error());
    std::vector<View> views;
    for (const auto& [name, camera] : cameras) {
        View view{name, camera, make_frame_target(gl, size.width, size.height), {}};
        if (!view.frame.framebuffer)
            return usage_error("this OpenGL cannot draw so large a picture; use a smaller --size");
        renderer->draw(view.frame, camera);
        const Image depth =
            read_texture(gl, view.frame.depth.name(), size.width, size.height, 1, true);
        view.truth = compute_truth(fogs, scene.models, camera, depth);
        views.push_back(std::move(view));
    }
    return views;
}

Result<std::vector<FogTextures>> make_textures(const Gl& gl, const std::vector<Fog>& fogs) {
    std::vector<FogTextures> textures;
    for (const Fog& fog : fogs) {
        Result<FogTextures> made = FogTextures::create(gl, fog);
        if (!made) return tl::unexpected(made.error());
        textures.push_back(*std::move(made));
    }
    return textures;
}

Result<FogPass> make_pass(const Gl& gl, const std::vector<FogTextures>& textures,
                          const Method& method, const Scene& scene) {
    std::vector<const FogTextures*> pointers;
    for (const FogTextures& made : textures) pointers.push_back(&made);
    return FogPass::create(gl, pointers, method, scene.fog_colour, scene.models);
}

Result<double> largest_error(const Gl& gl, FogPass& pass, const std::vector<View>& views) {
    double largest = 0;
    for (const View& view : views) {
        const int width = view.frame.width, height = view.frame.height;
        const Texture target =
            make_texture_2d(gl, GL_R32F, width, height, GL_RED, GL_FLOAT, nullptr);
        const Result<Framebuffer> framebuffer = make_framebuffer(gl, target.name());
        if (!framebuffer) return tl::unexpected(framebuffer.error());
        pass.draw_optical_depth(view.frame, view.camera, framebuffer->name());
        const Image tau = read_texture(gl, target.name(), width, height, 1);
        for (std::size_t i = 0; i < tau.pixels.size(); ++i)
            largest = std::max(
                largest, std::abs(std::exp(-double(tau.pixels[i])) - std::exp(-view.truth.tau[i])));
    }
    return largest;
}

Result<double> largest_error(const Gl& gl, const Scene& scene, const std::vector<Fog>& fogs,
                             const Method& method, const std::vector<View>& views) {
    const Result<std::vector<FogTextures>> textures = make_textures(gl, fogs);
    if (!textures) return tl::unexpected(textures.error());
    Result<FogPass> pass = make_pass(gl, *textures, method, scene);
    if (!pass) return tl::unexpected(pass.error());
    return largest_error(gl, *pass, views);
}

}  // namespace wavefog::cli
