// Method radial: pictures against the double-precision reference, and when the table is built anew.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "fogmap/fog_support.h"
#include "glsl_in_cpp.h"
#include "gpu/fog_picture.h"
#include "wavefog/gpu/pixel_rays.h"
#include "wavefog/gpu/radial_bound.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

// The least difference that 8 bits show.
constexpr double kVisible = 1.0 / 510;

// A table that is fine for a map of 48 cells, and not limited by the small picture's pixels.
constexpr Method kFine = {.kind = MethodKind::radial, .radial = {1536, 512}};

// camera_cases(), and where a table around the eye has its corners.
std::vector<CameraCase> radial_cases() {
    auto cases = camera_cases();
    const auto add = [&](const char* name, const Eigen::Vector3d& eye,
                         const Eigen::Vector3d& target) {
        Camera camera = cases.front().camera;
        camera.eye = eye;
        camera.target = target;
        cases.push_back({name, camera});
    };
    add("level: columns are pixel columns", {3.3, 2.1, 15.2}, {0.4, 2.1, -4.7});
    add("on the map's edge", {-20, 2.1, 3.3}, {0, 1.2, 2.2});
    add("on the map's corner, looking along an edge", {28, 2.1, 24}, {28, 1.7, -10});
    add("far outside", {-400.3, 60.2, 300.7}, {4, 0, 6});
    add("outside, looking along an edge", {-40, 12, 24.5}, {40, 0, 24.5});
    add("nadir", {3.3, 12.1, 5.2}, {3.3, 0, 5.2});
    add("zenith", {3.3, -4.1, 5.2}, {3.3, 9, 5.2});
    add("nadir at the picture's edge", {3.3, 9.1, 5.2}, {3.3, -4, -1.2});
    return cases;
}

struct Errors {
    double largest = 0, p99 = 0, tau = 0;
};

// Of |dT|; `tau` is the largest optical depth drawn.
Errors errors_of(const FogPicture& picture, const Camera& camera, const Image& drawn,
                 const std::vector<Reference>& references, double mu = 1) {
    const PixelRays rays(camera, kWidth, kHeight);
    std::vector<double> errors;
    Errors result;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) {
            const float depth =
                picture.depth[static_cast<std::size_t>((kHeight - 1 - y) * kWidth + x)];
            const double truth = rays.optical_depth(references, rays.at(x, y, depth), mu);
            const double tau = drawn.at(x, y, 0);
            REQUIRE(std::isfinite(tau));
            result.tau = std::max(result.tau, tau);
            errors.push_back(std::abs(std::exp(-tau) - std::exp(-truth)));
        }
    std::sort(errors.begin(), errors.end());
    result.largest = errors.back();
    result.p99 = errors[errors.size() * 99 / 100];
    return result;
}

Image draw(const Gl& gl, FogPass& pass, const FogPicture& picture, const Camera& camera,
           double seconds = 0) {
    pass.draw_optical_depth(picture.frame, camera, picture.target.name(), seconds);
    return read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
}

FogPass make_pass(const Gl& gl, std::vector<const FogTextures*> fogs, const Method& method) {
    auto pass = FogPass::create(gl, std::move(fogs), method, {1, 1, 1});
    REQUIRE_MESSAGE(pass.has_value(), (pass ? "" : pass.error().message));
    return std::move(*pass);
}

}  // namespace

TEST_CASE("radial: every basis, profile and camera within 1/510 of the reference") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(61);
    const auto cases = radial_cases();
    std::vector<FogPicture> pictures;
    for (const auto& one : cases) pictures.push_back(make_picture(gl, one.camera));
    for (int degree = 0; degree <= 2; ++degree) {
        FogOptions options;
        options.degree = degree;
        options.levels = 2;
        Fog fog = random_fog(48, 36, options, random);
        for (const auto& profile : all_profiles()) {
            fog.profile = profile;
            const auto textures = FogTextures::create(gl, fog);
            REQUIRE(textures.has_value());
            const std::vector<Reference> reference = {Reference(fog)};
            FogPass pass = make_pass(gl, {&*textures}, kFine);
            for (std::size_t i = 0; i < cases.size(); ++i) {
                const Image tau = draw(gl, pass, pictures[i], cases[i].camera);
                const Errors errors = errors_of(pictures[i], cases[i].camera, tau, reference);
                CAPTURE(std::string(cases[i].name));
                CAPTURE(degree);
                CAPTURE(static_cast<int>(profile.kind));
                // A Haar map's integral has a kink wherever a column passes a cell's corner and
                // jumps where it runs along an edge, by up to what a cell holds: 0.05/m * 0.75 * 1
                // m.
                CHECK_LE(errors.largest, degree == 0 ? 0.0375 : kVisible);
                CHECK_LE(errors.p99, degree == 0 ? 0.006 : kVisible);
            }
        }
    }
}

TEST_CASE("radial: no picture errs more than its certified bound") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(65);
    const auto cases = radial_cases();
    std::vector<FogPicture> pictures;
    for (const auto& one : cases) pictures.push_back(make_picture(gl, one.camera));
    int bounds = 0;
    double closest = 0;
    for (int degree = 0; degree <= 2; ++degree) {
        Fog fog = random_fog(48, 36, {.degree = degree, .levels = 2}, random);
        for (const auto& profile : all_profiles()) {
            fog.profile = profile;
            const auto textures = FogTextures::create(gl, fog);
            REQUIRE(textures.has_value());
            const std::vector<Reference> reference = {Reference(fog)};
            const DetailBound dropped(fog);
            const RadialBound bounded(fog, dropped);
            for (const bool step : {false, true}) {
                const Method method{.kind = MethodKind::radial, .radial_step = step};
                FogPass pass = make_pass(gl, {&*textures}, method);
                for (std::size_t i = 0; i < cases.size(); ++i) {
                    const Camera& camera = cases[i].camera;
                    if (camera.projection == Camera::Projection::orthographic) continue;
                    // No ray is longer or climbs more.
                    const RayLimits limits{.length = 1500, .rise = 1500};
                    const double bound =
                        bounded.transmittance(method, camera, kWidth, kHeight, limits);
                    const Errors errors = errors_of(pictures[i], camera,
                                                    draw(gl, pass, pictures[i], camera), reference);
                    CAPTURE(std::string(cases[i].name));
                    CAPTURE(degree);
                    CAPTURE(method.name());
                    CAPTURE(static_cast<int>(profile.kind));
                    CHECK_LE(errors.largest, bound);
                    closest = std::max(closest, errors.largest / bound);
                    ++bounds;
                }
            }
        }
    }
    MESSAGE(bounds << " pictures, the largest error " << closest << " of its bound");
    CHECK(bounds > 100);
}

TEST_CASE("radial: a level camera's columns with the exact last step are exact") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(63);
    Camera camera = camera_cases().front().camera;
    camera.eye = {3.3, 2.1, 15.2};
    camera.target = {0.4, 2.1, -4.7};
    const FogPicture picture = make_picture(gl, camera);
    for (int degree = 0; degree <= 2; ++degree) {
        Fog fog = random_fog(48, 36, {.degree = degree, .levels = 2}, random);
        for (const auto& profile : all_profiles()) {
            fog.profile = profile;
            const auto textures = FogTextures::create(gl, fog);
            REQUIRE(textures.has_value());
            const std::vector<Reference> reference = {Reference(fog)};
            FogPass pass =
                make_pass(gl, {&*textures},
                          {.kind = MethodKind::radial, .radial = {2048, 24}, .radial_step = true});
            const Errors errors =
                errors_of(picture, camera, draw(gl, pass, picture, camera), reference);
            CAPTURE(degree);
            CAPTURE(static_cast<int>(profile.kind));
            // float32 in three-fold integrals; the exponential profile is a spline.
            CHECK_LE(errors.largest, profile.kind == Profile::Kind::exponential ? kVisible : 2e-5);
        }
    }
}

TEST_CASE("radial: sizes that are chosen keep 1/510, and 16 MiB") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(67);
    // Smooth at the scale of the small picture's pixels, 1.9 cm a metre.
    Fog fog = fog_of(make_map<float>(MapKind::smooth, 16, 12, random), {.degree = 1, .levels = 1});
    fog.rect = {-20, -12, 28, 24};
    fog.extinction = 0.05;
    for (const auto& profile : all_profiles()) {
        fog.profile = profile;
        const auto textures = FogTextures::create(gl, fog);
        const std::vector<Reference> reference = {Reference(fog)};
        FogPass pass = make_pass(gl, {&*textures}, {.kind = MethodKind::radial});
        FogPass exact = make_pass(gl, {&*textures}, {});
        CHECK(pass.bytes() > exact.bytes());
        CHECK(pass.bytes() - exact.bytes() <= 16 << 20);
        for (const auto& [name, camera] : radial_cases()) {
            const FogPicture picture = make_picture(gl, camera);
            CAPTURE(std::string(name));
            CAPTURE(static_cast<int>(profile.kind));
            CHECK_LE(errors_of(picture, camera, draw(gl, pass, picture, camera), reference).largest,
                     kVisible);
        }
    }
}

TEST_CASE("radial: no fog in view, fog behind the camera, repeated fog and several fogs") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(71);
    Fog fog = random_fog(48, 36, {.degree = 1, .levels = 2}, random);
    const auto textures = FogTextures::create(gl, fog);
    FogPass pass = make_pass(gl, {&*textures}, kFine);
    Camera camera = camera_cases().front().camera;
    camera.eye = {3.3, 2.1, 60};
    camera.target = {3.3, 1.8, 90};
    const FogPicture away = make_picture(gl, camera);
    const Image none = draw(gl, pass, away, camera);
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x) REQUIRE(none.at(x, y, 0) == 0.0f);

    // Turned round with the same eye, the fog is there.
    camera.target = {3.3, 1.8, 20};
    const FogPicture towards = make_picture(gl, camera);
    CHECK(errors_of(towards, camera, draw(gl, pass, towards, camera), {Reference(fog)}).tau > 0.5);

    const Camera inside = camera_cases().front().camera;
    const FogPicture picture = make_picture(gl, inside);
    std::vector<Fog> fogs;
    for (const Boundary boundary : {Boundary::repeat, Boundary::zero}) {
        fogs.push_back(
            random_fog(24, 18, {.degree = 1, .levels = 1, .boundary = boundary}, random));
        fogs.back().profile = all_profiles()[1 + fogs.size()];
        fogs.back().extinction = 0.02;
    }
    std::vector<FogTextures> both;
    std::vector<Reference> references;
    for (const auto& one : fogs) {
        both.push_back(std::move(*FogTextures::create(gl, one)));
        references.emplace_back(one);
    }
    FogPass sum = make_pass(gl, {&both[0], &both[1]}, kFine);
    // Each of the two may be off.
    CHECK_LE(errors_of(picture, inside, draw(gl, sum, picture, inside), references).largest,
             2 * kVisible);
}

TEST_CASE("radial: a kept table draws the same bits, and follows eye, view and wind") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(73);
    Fog fog = random_fog(48, 36, {.degree = 1, .levels = 2}, random);
    fog.profile = all_profiles()[2];
    fog.wind = {0.5, -0.25};
    const auto textures = FogTextures::create(gl, fog);
    FogPass pass = make_pass(gl, {&*textures}, kFine), other = make_pass(gl, {&*textures}, kFine);
    const Camera camera = camera_cases().front().camera;
    const FogPicture picture = make_picture(gl, camera);
    const auto bits = [&](FogPass& with, const Camera& seen_by, double seconds = 0) {
        return draw(gl, with, picture, seen_by, seconds).pixels;
    };
    const auto first = bits(pass, camera);
    CHECK(bits(pass, camera) == first);
    pass.forget();
    CHECK(bits(pass, camera) == first);
    CHECK(bits(other, camera) == first);

    const auto later = bits(pass, camera, 3);
    CHECK(later != first);
    Fog moved = fog;
    moved.rect = {fog.rect.x0 + 1.5, fog.rect.z0 - 0.75, fog.rect.x1 + 1.5, fog.rect.z1 - 0.75};
    CHECK_LE(
        errors_of(picture, camera, draw(gl, pass, picture, camera, 3), {Reference(moved)}).largest,
        kVisible);
    Camera elsewhere = camera;
    elsewhere.eye.x() += 0.5;
    Camera turned = camera;
    turned.target.x() += 5;
    for (const Camera& changed : {elsewhere, turned}) {
        const auto pixels = bits(pass, changed);
        CHECK(pixels != first);
        CHECK(bits(other, changed) == pixels);
        other.forget();
        CHECK(bits(other, changed) == pixels);
    }
    CHECK(bits(pass, camera) == first);
}

TEST_CASE("radial: an orthographic camera gets exact") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(79);
    const Fog fog = random_fog(48, 36, {.degree = 1, .levels = 2}, random);
    const auto textures = FogTextures::create(gl, fog);
    FogPass radial = make_pass(gl, {&*textures}, kFine), exact = make_pass(gl, {&*textures}, {});
    for (const auto& [name, camera] : camera_cases())
        if (camera.projection == Camera::Projection::orthographic) {
            const FogPicture picture = make_picture(gl, camera);
            CHECK(draw(gl, radial, picture, camera).pixels ==
                  draw(gl, exact, picture, camera).pixels);
        }
}

TEST_CASE("radial: rule of mu") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(83);
    // Without negative approximations the clamp has nothing to do, which steps do it differently.
    FogOptions options;
    options.degree = 1;
    options.levels = 2;
    options.form = Form::scaling;
    options.family = "positive";
    Fog fog = random_fog(48, 36, options, random);
    const Camera camera = camera_cases().front().camera;
    const FogPicture picture = make_picture(gl, camera);
    for (const auto& profile : all_profiles()) {
        fog.profile = profile;
        const auto textures = FogTextures::create(gl, fog);
        for (const double mu : {0.0, 0.4, 0.8}) {
            Method method = kFine;
            method.mu = mu;
            FogPass pass = make_pass(gl, {&*textures}, method);
            CAPTURE(static_cast<int>(profile.kind));
            CAPTURE(mu);
            // Up to five look-ups, each as good as one at mu = 1.
            CHECK_LE(
                errors_of(picture, camera, draw(gl, pass, picture, camera), {Reference(fog)}, mu)
                    .largest,
                (mu > 0 ? 5 : 1) * kVisible);
        }
    }
}

TEST_CASE("radial: the driver lays the uniform block out as the C++ struct") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    const auto program =
        build_program(gl, "post_fullscreen.vert", "fog_pass.frag",
                      {"FOG_METHOD 5", "FOG_DEGREE 1", "FOG_PROFILE 0", "FOG_OUTPUT_TAU"});
    REQUIRE_MESSAGE(program.has_value(), (program ? "" : program.error().message));
    const GLuint index = gl.GetUniformBlockIndex(program->name(), "RadialBlock");
    REQUIRE(index != GL_INVALID_INDEX);
    GLint bytes = 0;
    gl.GetActiveUniformBlockiv(program->name(), index, GL_UNIFORM_BLOCK_DATA_SIZE, &bytes);
    CHECK(static_cast<std::size_t>(bytes) == sizeof(shader::RadialBlock));
}
