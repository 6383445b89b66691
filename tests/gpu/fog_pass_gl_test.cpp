// Pictures of the fog pass on OSMesa against the double-precision reference, pixel by pixel, from
// the same depth values.
#include <doctest/doctest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "fogmap/fog_support.h"
#include "gpu/gl_support.h"
#include "wavefog/fogmap/reference.h"
#include "wavefog/gpu/fog_pass.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

constexpr int kWidth = 64, kHeight = 48;
// As in fog_shader_test.cpp: float32 positions in a map of about 64 cells.
constexpr double kMaxError = 2e-6;

struct CameraCase {
    const char* name;
    Camera camera;
};

// random_fog's map covers 48 m x 36 m around the origin; the ground below is at about y = 0.
std::vector<CameraCase> camera_cases() {
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
std::vector<float> ground_depth(const Camera& camera, const CameraMatrices& matrices) {
    std::vector<float> depth(kWidth * kHeight);
    const Eigen::Matrix4d clip = matrices.projection * matrices.view;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const PixelRay ray =
                pixel_ray(matrices, camera, kWidth, kHeight, x, y, matrices.sky_depth);
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

FogPicture make_picture(const Gl& gl, const Camera& camera) {
    FogPicture p;
    p.depth = ground_depth(camera, camera_matrices(camera, kWidth, kHeight));
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
double largest_error(const FogPicture& picture, const Camera& camera, const Image& tau,
                     const std::vector<Reference>& references, double mu, int& sky) {
    const auto matrices = camera_matrices(camera, kWidth, kHeight);
    const double limit = std::isfinite(camera.far_plane) ? camera.far_plane : 1e6;
    double largest = 0;
    sky = 0;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const float depth =
                picture.depth[static_cast<std::size_t>((kHeight - 1 - y) * kWidth + x)];
            const PixelRay ray = pixel_ray(matrices, camera, kWidth, kHeight, x, y, depth);
            sky += ray.sky;
            double truth = 0;
            for (const auto& reference : references) {
                Eigen::Vector3d end = ray.end;
                if (ray.sky) {
                    const Eigen::Vector3d along = ray.end - ray.origin;
                    end = ray.origin + reference.far_end(ray.origin, along, limit) * along;
                }
                truth += reference.optical_depth(ray.origin, end, mu);
            }
            const double value = tau.at(x, y, 0);
            REQUIRE(std::isfinite(value));
            largest = std::max(largest, std::abs(std::exp(-value) - std::exp(-truth)));
        }
    return largest;
}

}  // namespace

TEST_CASE("fog pass: every basis, profile and camera equals the reference, mu 1 and below") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(41);
    for (const auto& [name, camera] : camera_cases()) {
        FogPicture picture = make_picture(gl, camera);
        for (int degree = 0; degree <= 2; ++degree) {
            FogOptions options;
            options.degree = degree;
            options.levels = 3;
            Fog fog = random_fog(64, 48, options, random);
            for (const auto& profile : all_profiles()) {
                fog.profile = profile;
                const auto textures = FogTextures::create(gl, fog);
                REQUIRE(textures.has_value());
                const std::vector<Reference> reference = {Reference(fog)};
                for (const double mu : {1.0, 0.6, 0.0}) {
                    auto pass = FogPass::create(gl, {&*textures}, {.mu = mu}, {1, 1, 1});
                    REQUIRE_MESSAGE(pass.has_value(), (pass ? "" : pass.error().message));
                    pass->draw_optical_depth(picture.frame, camera, picture.target.name());
                    const Image tau = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
                    int sky = 0;
                    CAPTURE(std::string(name));
                    CAPTURE(degree);
                    CAPTURE(static_cast<int>(profile.kind));
                    CAPTURE(mu);
                    CHECK_LE(largest_error(picture, camera, tau, reference, mu, sky), kMaxError);
                }
            }
        }
    }
}

TEST_CASE("fog pass: paper and paper-scaling equal the reference in pictures") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(59);
    for (const auto& [name, camera] : camera_cases()) {
        FogPicture picture = make_picture(gl, camera);
        for (int degree = 0; degree <= 2; ++degree) {
            FogOptions options;
            options.degree = degree;
            options.levels = 2;
            Fog fog = random_fog(48, 32, options, random);
            fog.profile = all_profiles()[1];
            const auto textures = FogTextures::create(gl, fog);
            const std::vector<Reference> reference = {Reference(fog)};
            for (const MethodKind kind : {MethodKind::paper, MethodKind::paper_scaling}) {
                auto pass = FogPass::create(gl, {&*textures}, {.kind = kind}, {1, 1, 1});
                REQUIRE_MESSAGE(pass.has_value(), (pass ? "" : pass.error().message));
                pass->draw_optical_depth(picture.frame, camera, picture.target.name());
                const Image tau = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
                int sky = 0;
                CAPTURE(std::string(name));
                CAPTURE(degree);
                CAPTURE(static_cast<int>(kind));
                // Degree 2 reads tables of 32 samples an edge (paper_test.cpp): 0.2 / 31^2.
                CHECK_LE(largest_error(picture, camera, tau, reference, 1, sky),
                         degree < 2 ? 5e-6 : 2.1e-4);
            }
        }
    }
}

TEST_CASE("fog pass: several fogs add up, repeat and a world offset of 1e6 m") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(43);
    Camera camera = camera_cases().front().camera;
    const Eigen::Vector3d offset(1e6, 0, -1e6);
    camera.eye += offset;
    camera.target += offset;
    FogPicture picture = make_picture(gl, camera);
    std::vector<Fog> fogs;
    for (const Boundary boundary : {Boundary::zero, Boundary::repeat, Boundary::zero}) {
        FogOptions options;
        options.degree = static_cast<int>(fogs.size());
        options.levels = 2;
        options.boundary = boundary;
        Fog fog = random_fog(32, 24, options, random);
        fog.profile = all_profiles()[1 + fogs.size()];
        fog.extinction = 0.02;
        fog.rect = {fog.rect.x0 + 1e6, fog.rect.z0 - 1e6, fog.rect.x1 + 1e6, fog.rect.z1 - 1e6};
        fogs.push_back(std::move(fog));
    }
    std::vector<FogTextures> textures;
    std::vector<const FogTextures*> pointers;
    std::vector<Reference> references;
    for (const auto& fog : fogs) {
        textures.push_back(std::move(*FogTextures::create(gl, fog)));
        references.emplace_back(fog);
    }
    for (const auto& t : textures) pointers.push_back(&t);
    auto pass = FogPass::create(gl, pointers, {}, {0.5, 0.6, 0.7});
    REQUIRE(pass.has_value());
    pass->draw_optical_depth(picture.frame, camera, picture.target.name());
    const Image tau = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
    int sky = 0;
    CHECK_LE(largest_error(picture, camera, tau, references, 1, sky), kMaxError);
    CHECK(sky > 0);
    CHECK(sky < kWidth * kHeight);

    // The blend, paper 004 eq. 4: T L_scene + (1 - T) L_fog.
    pass->draw_colour(picture.frame, camera, picture.target.name());
    const Image colour = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
    const double fog_colour[3] = {0.5, 0.6, 0.7};
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const double t = std::exp(-static_cast<double>(tau.at(x, y, 0)));
            for (int c = 0; c < 3; ++c)
                REQUIRE(std::abs(colour.at(x, y, c) - (t * 0.25 + (1 - t) * fog_colour[c])) < 1e-6);
        }
}

TEST_CASE("fog pass: no fog leaves the picture alone, wind moves the map") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    const Camera camera = camera_cases().front().camera;
    FogPicture picture = make_picture(gl, camera);
    auto none = FogPass::create(gl, {}, {}, {1, 1, 1});
    REQUIRE(none.has_value());
    none->draw_colour(picture.frame, camera, picture.target.name());
    const Image same = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
    CHECK(std::all_of(same.pixels.begin(), same.pixels.end(), [](float v) { return v == 0.25f; }));

    Random random(47);
    Fog fog = random_fog(32, 24, {.degree = 1, .levels = 2}, random);
    fog.wind = {2, -1};
    const auto moving = FogTextures::create(gl, fog);
    auto pass = FogPass::create(gl, {&*moving}, {}, {1, 1, 1});
    pass->draw_optical_depth(picture.frame, camera, picture.target.name(), 3);
    const Image later = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
    Fog moved = fog;
    moved.rect = {fog.rect.x0 + 6, fog.rect.z0 - 3, fog.rect.x1 + 6, fog.rect.z1 - 3};
    int sky = 0;
    CHECK_LE(largest_error(picture, camera, later, {Reference(moved)}, 1, sky), kMaxError);
}

TEST_CASE("fog pass: reference is not a GPU method, degree 3 is not drawn") {
    Context& context = osmesa();
    const auto pass = FogPass::create(context.gl(), {}, {.kind = MethodKind::reference}, {1, 1, 1});
    REQUIRE(!pass.has_value());
    CHECK(pass.error().kind == ErrorKind::usage);
    CHECK(pass.error().message.find("reference") != std::string::npos);

    Random random(53);
    const Fog cubic = random_fog(16, 16, {.degree = 3, .levels = 1}, random);
    const auto textures = FogTextures::create(context.gl(), cubic);
    REQUIRE(!textures.has_value());
    CHECK(textures.error().message.find("degree 3") != std::string::npos);
}
