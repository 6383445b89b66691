// Small frames for the fog pass, from cameras of every kind, and their error against the reference.
#pragma once

#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "gpu/gl_support.h"
#include "wavefog/fogmap/reference.h"
#include "wavefog/gpu/fog_pass.h"
#include "wavefog/gpu/pixel_rays.h"

namespace wavefog::test {

inline constexpr int kWidth = 64, kHeight = 48;

struct CameraCase {
    const char* name;
    Camera camera;
};

// random_fog's map covers 48 m x 36 m around the origin; the ground below is at about y = 0.
inline std::vector<CameraCase> camera_cases() {
    Camera inside;
    inside.eye = {3.3, 2.1, 15.2};
    inside.target = {0.4, 1.2, -4.7};
    inside.far_plane = 400;
    std::vector<CameraCase> cases = {{"inside", inside}};
    auto add = [&](const char* name, auto change) {
        Camera camera = inside;
        change(camera);
        cases.push_back({name, camera});
    };
    add("outside", [](Camera& c) { c.eye = {-38.3, 4.2, 44.7}; });
    add("above, looking down", [](Camera& c) {
        c.eye = {2.3, 31.1, 4.4};
        c.target = {2.3, 0, 4.3};
    });
    add("below the base, looking up", [](Camera& c) {
        c.eye = {1.3, -4.4, 9.2};
        c.target = {2.1, 9.3, 1.7};
    });
    add("rolled and pitched", [](Camera& c) { c.up = {0.5, 1, 0.2}; });
    add("reversed depth", [](Camera& c) { c.depth = Camera::Depth::reversed; });
    add("infinite far plane",
        [](Camera& c) { c.far_plane = std::numeric_limits<double>::infinity(); });
    add("reversed, infinite", [](Camera& c) {
        c.depth = Camera::Depth::reversed;
        c.far_plane = std::numeric_limits<double>::infinity();
    });
    add("off-axis", [](Camera& c) { c.lens_shift = {0.6, -0.3}; });
    add("orthographic", [](Camera& c) {
        c.projection = Camera::Projection::orthographic;
        c.eye = {-20.3, 25.2, 31.7};
        c.ortho_height = 40;
    });
    add("orthographic, reversed", [](Camera& c) {
        c.projection = Camera::Projection::orthographic;
        c.depth = Camera::Depth::reversed;
        c.eye = {-20.3, 25.2, 31.7};
        c.ortho_height = 40;
    });
    return cases;
}

// Depth of a wavy ground, marched in double and rounded to float as a depth buffer would.
inline std::vector<float> ground_depth(const Camera& camera, const CameraMatrices& matrices) {
    const PixelRays rays(camera, kWidth, kHeight);
    std::vector<float> depth(kWidth * kHeight);
    const Eigen::Matrix4d clip = matrices.projection * matrices.view;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const PixelRay ray = rays.at(x, y, matrices.sky_depth);
            const Eigen::Vector3d along = (ray.end - ray.origin).normalized();
            double found = matrices.sky_depth;
            for (double s = 1; s < 150; s += 0.25) {
                const Eigen::Vector3d p = ray.origin + s * along;
                if (p.y() < std::sin(p.x() * 0.3) * std::cos(p.z() * 0.25) && p.y() > -3) {
                    const Eigen::Vector4d c = clip * p.homogeneous();
                    found = c.z() / c.w();
                    break;
                }
            }
            // GL's rows count from the bottom.
            depth[static_cast<std::size_t>((kHeight - 1 - y) * kWidth + x)] =
                static_cast<float>(found);
        }
    return depth;
}

struct FogPicture {
    FrameTarget frame;
    Texture tau;
    Framebuffer target;
    std::vector<float> depth;
};

/// Depth values with OpenGL's rows, the lowest first; the ground's if there are none.
inline FogPicture make_picture(const Gl& gl, const Camera& camera, std::vector<float> depth = {}) {
    FogPicture p;
    p.depth = std::move(depth);
    if (p.depth.empty()) p.depth = ground_depth(camera, camera_matrices(camera, kWidth, kHeight));
    p.frame.width = kWidth;
    p.frame.height = kHeight;
    p.frame.depth = make_texture_2d(gl, GL_R32F, kWidth, kHeight, GL_RED, GL_FLOAT, p.depth.data());
    const std::vector<float> grey(4 * kWidth * kHeight, 0.25f);
    p.frame.colour =
        make_texture_2d(gl, GL_RGBA32F, kWidth, kHeight, GL_RGBA, GL_FLOAT, grey.data());
    p.tau = make_texture_2d(gl, GL_RGBA32F, kWidth, kHeight, GL_RGBA, GL_FLOAT, nullptr);
    p.target = std::move(*make_framebuffer(gl, p.tau.name()));
    return p;
}

/// The largest |dT| over the pixels; `sky` counts those without a surface.
inline double largest_error(const FogPicture& picture, const Camera& camera, const Image& tau,
                            const std::vector<Reference>& references, double mu, int& sky,
                            const std::vector<FogModel>& models = {},
                            const std::vector<Particle>& particles = {}) {
    const PixelRays rays(camera, kWidth, kHeight);
    double largest = 0;
    sky = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const float depth =
                picture.depth[static_cast<std::size_t>((kHeight - 1 - y) * kWidth + x)];
            const PixelRay ray = rays.at(x, y, depth);
            sky += ray.sky;
            const double truth = rays.optical_depth(references, ray, mu, models, particles);
            const double value = tau.at(x, y, 0);
            REQUIRE(std::isfinite(value));
            largest = std::max(largest, std::abs(std::exp(-value) - std::exp(-truth)));
        }
    return largest;
}

}  // namespace wavefog::test
