#include "fit/views.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

namespace wavefog::cli {
namespace {

// Pixels of one camera's picture that the truth is taken of: 3840x2160, at microseconds each.
constexpr double kWholePixels = 3840.0 * 2160.0;

Camera turned(Camera camera, double yaw_degrees, double lift, double forward) {
    const Eigen::AngleAxisd turn(yaw_degrees * std::numbers::pi / 180, camera.up.normalized());
    const Eigen::Vector3d view = camera.target - camera.eye;
    camera.eye += forward * view + lift * camera.up.normalized();
    camera.target = camera.eye + turn * view;
    return camera;
}

/// Without the truth.
Result<std::vector<View>> draw_views(const Gl& gl, const Scene& scene,
                                     const std::vector<NamedCamera>& cameras, const Size& size) {
    const Result<SceneRenderer> renderer = SceneRenderer::create(gl, scene);
    if (!renderer) return tl::unexpected(renderer.error());
    std::vector<View> views;
    for (const auto& [name, camera] : cameras) {
        View view;
        view.name = name;
        view.camera = camera;
        view.frame = make_frame_target(gl, size.width, size.height);
        if (!view.frame.framebuffer)
            return usage_error("this OpenGL cannot draw so large a picture; use a smaller --size");
        renderer->draw(view.frame, camera);
        view.depth = read_texture(gl, view.frame.depth.name(), size.width, size.height, 1, true);
        views.push_back(std::move(view));
    }
    return views;
}

/// Pixels apart in both directions, of pictures that have too many.
int whole_stride(const Size& size) {
    const double pixels = double(size.width) * double(size.height);
    return std::max(1, int(std::ceil(std::sqrt(pixels / kWholePixels))));
}

}  // namespace

std::vector<NamedCamera> cameras_of(const Scene& scene) {
    std::vector<NamedCamera> cameras = {{"main", scene.camera}};
    cameras.insert(cameras.end(), scene.cameras.begin(), scene.cameras.end());
    return cameras;
}

std::vector<NamedCamera> tuning_cameras(const Scene& scene) {
    std::vector<NamedCamera> all;
    for (const auto& [name, camera] : cameras_of(scene)) {
        all.push_back({name, camera});
        all.push_back({name + ", 15 degrees left", turned(camera, 15, 0, 0)});
        all.push_back({name + ", 15 degrees right", turned(camera, -15, 0, 0)});
    }
    return all;
}

std::vector<NamedCamera> held_out_cameras(const Scene& scene) {
    std::vector<NamedCamera> all;
    for (const auto& [name, camera] : cameras_of(scene)) {
        const double far = (camera.target - camera.eye).norm();
        all.push_back({name + ", 8 degrees left", turned(camera, 8, 0, 0)});
        all.push_back({name + ", a little forward", turned(camera, 3, 0, 0.03)});
        all.push_back({name + ", a little back and higher", turned(camera, -5, 0.02 * far, -0.03)});
    }
    return all;
}

Result<std::vector<View>> make_views(const Gl& gl, const Scene& scene, const std::vector<Fog>& fogs,
                                     const std::vector<NamedCamera>& cameras, const Size& size) {
    Result<std::vector<View>> views = draw_views(gl, scene, cameras, size);
    if (!views) return views;
    for (View& view : *views) {
        view.truth = compute_truth({}, scene.models, view.camera, view.depth);
        for (const Fog& fog : fogs) {
            view.parts.push_back(compute_truth({fog}, {}, view.camera, view.depth));
            for (std::size_t i = 0; i < view.truth.tau.size(); ++i)
                view.truth.tau[i] += view.parts.back().tau[i];
        }
    }
    return views;
}

Result<std::vector<View>> make_whole_views(const Gl& gl, const Scene& scene,
                                           const std::vector<Fog>& fogs, const Size& size) {
    Result<std::vector<View>> views = draw_views(gl, scene, cameras_of(scene), size);
    if (!views) return views;
    const int stride = whole_stride(size);
    for (View& view : *views) {
        view.name = whole_words(size) + " of " + view.name;
        view.truth = compute_truth(fogs, scene.models, view.camera, view.depth, stride);
    }
    return views;
}

std::string whole_words(const Size& size) {
    const int stride = whole_stride(size);
    if (stride == 1) return "every pixel";
    return fmt::format("one pixel in every {0}x{0}", stride);
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
                          const Method& method, const Scene& scene,
                          const std::vector<FogModel>& models) {
    std::vector<const FogTextures*> pointers;
    for (const FogTextures& made : textures) pointers.push_back(&made);
    return FogPass::create(gl, pointers, method, scene.fog_colour, models);
}

Result<Worst> largest_error(const Gl& gl, FogPass& pass, const std::vector<View>& views,
                            double limit) {
    Worst worst;
    for (const View& view : views) {
        const int width = view.frame.width, height = view.frame.height;
        const Texture target =
            make_texture_2d(gl, GL_R32F, width, height, GL_RED, GL_FLOAT, nullptr);
        const Result<Framebuffer> framebuffer = make_framebuffer(gl, target.name());
        if (!framebuffer) return tl::unexpected(framebuffer.error());
        pass.draw_optical_depth(view.frame, view.camera, framebuffer->name());
        const Image tau = read_texture(gl, target.name(), width, height, 1);
        const Image drawn = every_nth(tau, view.truth.stride);
        for (std::size_t i = 0; i < drawn.pixels.size(); ++i) {
            const double error =
                std::abs(std::exp(-double(drawn.pixels[i])) - std::exp(-view.truth.tau[i]));
            if (error > worst.error) worst = {error, view.name};
        }
        if (worst.error > limit) break;
    }
    return worst;
}

Result<Worst> largest_error(const Gl& gl, const Scene& scene, const std::vector<Fog>& fogs,
                            const std::vector<FogModel>& models, const Method& method,
                            const std::vector<View>& views, double limit) {
    const Result<std::vector<FogTextures>> textures = make_textures(gl, fogs);
    if (!textures) return tl::unexpected(textures.error());
    Result<FogPass> pass = make_pass(gl, *textures, method, scene, models);
    if (!pass) return tl::unexpected(pass.error());
    return largest_error(gl, *pass, views, limit);
}

}  // namespace wavefog::cli
