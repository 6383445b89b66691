// Method radial with several views: what shares a table, what keeps its own, and the pictures.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "fogmap/fog_support.h"
#include "gpu/fog_picture.h"
#include "radial_block.h"
#include "wavefog/gpu/pixel_rays.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

// The least difference that 8 bits show.
constexpr double kVisible = 1.0 / 510;

/// Smooth at the scale of these small pictures' pixels.
Fog smooth_fog(Random& random) {
    Fog fog = fog_of(make_map<float>(MapKind::smooth, 16, 12, random), {.degree = 1, .levels = 1});
    fog.rect = {-20, -12, 28, 24};
    fog.extinction = 0.05;
    return fog;
}

FogPass radial_pass(const Gl& gl, const FogTextures& textures) {
    auto pass = FogPass::create(gl, {&textures}, {.kind = MethodKind::radial}, {1, 1, 1});
    REQUIRE_MESSAGE(pass.has_value(), (pass ? "" : pass.error().message));
    return std::move(*pass);
}

Image draw(const Gl& gl, FogPass& pass, const FogPicture& picture, const Camera& camera) {
    pass.draw_optical_depth(picture.frame, camera, picture.target.name());
    return read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
}

double largest_difference(const Image& a, const Image& b) {
    double largest = 0;
    for (std::size_t i = 0; i < a.pixels.size(); i += 4)
        largest = std::max(largest, std::abs(std::exp(-static_cast<double>(a.pixels[i])) -
                                             std::exp(-static_cast<double>(b.pixels[i]))));
    return largest;
}

std::vector<Camera> cube_faces(const Eigen::Vector3d& eye) {
    std::vector<Camera> faces;
    for (int axis = 0; axis < 3; ++axis)
        for (const double sign : {1.0, -1.0}) {
            Camera face;
            face.eye = eye;
            face.target = eye + sign * Eigen::Vector3d::Unit(axis);
            face.up = axis == 1 ? Eigen::Vector3d(0, 0, 1) : Eigen::Vector3d(0, 1, 0);
            face.fov_y_deg = 90;
            face.far_plane = 400;
            faces.push_back(face);
        }
    return faces;
}

std::vector<FogView> views_of(const std::vector<Camera>& cameras) {
    std::vector<FogView> views;
    for (const Camera& camera : cameras) views.push_back({camera, kWidth, kHeight});
    return views;
}

/// Draws every camera with a pass of its own.
std::vector<Image> one_by_one(const Gl& gl, const FogTextures& textures,
                              const std::vector<FogPicture>& pictures,
                              const std::vector<Camera>& cameras) {
    std::vector<Image> images;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
        FogPass pass = radial_pass(gl, textures);
        images.push_back(draw(gl, pass, pictures[i], cameras[i]));
    }
    return images;
}

}  // namespace

TEST_CASE("radial views: six faces of a cube share a table that is filled once") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(127);
    Fog fog = smooth_fog(random);
    for (const Eigen::Vector3d& eye : {Eigen::Vector3d(3.3, 2.1, 5.2), Eigen::Vector3d(41, 3, 9)}) {
        const auto faces = cube_faces(eye);
        std::vector<FogPicture> pictures;
        for (const Camera& face : faces) pictures.push_back(make_picture(gl, face));
        for (const auto& profile : all_profiles()) {
            fog.profile = profile;
            const auto textures = FogTextures::create(gl, fog);
            const auto alone = one_by_one(gl, *textures, pictures, faces);
            FogPass pass = radial_pass(gl, *textures);
            REQUIRE(pass.set_views(views_of(faces)).has_value());
            for (int frame = 0; frame < 2; ++frame)
                for (std::size_t i = 0; i < faces.size(); ++i) {
                    const Image tau = draw(gl, pass, pictures[i], faces[i]);
                    CAPTURE(static_cast<int>(profile.kind));
                    CAPTURE(i);
                    CHECK_LE(largest_difference(tau, alone[i]), kVisible);
                    int sky = 0;
                    CHECK_LE(largest_error(pictures[i], faces[i], tau, {Reference(fog)}, 1, sky),
                             kVisible);
                }
            CHECK(pass.table_fills() == 1);
            FogPass exact = std::move(*FogPass::create(gl, {&*textures}, {}, {1, 1, 1}));
            CHECK(pass.bytes() - exact.bytes() <= 16 << 20);
        }
    }
}

TEST_CASE("radial views: tiles and a split screen share, and any other camera is right too") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(131);
    const Fog fog = smooth_fog(random);
    const auto textures = FogTextures::create(gl, fog);
    Camera whole;
    whole.eye = {3.3, 2.1, 15.2};
    whole.target = {0.4, 2.1, -4.7};
    whole.fov_y_deg = 40;
    whole.far_plane = 400;
    std::vector<Camera> tiles(3, whole), split(3, whole);
    for (int i = 0; i < 3; ++i) tiles[static_cast<std::size_t>(i)].lens_shift = {2.0 * i - 2, 0};
    split[1].target = {28, 1.2, 9};
    split[2].target = {9, 4.2, 40};
    for (const auto& cameras : {tiles, split}) {
        std::vector<FogPicture> pictures;
        for (const Camera& camera : cameras) pictures.push_back(make_picture(gl, camera));
        const auto alone = one_by_one(gl, *textures, pictures, cameras);
        FogPass pass = radial_pass(gl, *textures);
        REQUIRE(pass.set_views(views_of(cameras)).has_value());
        for (std::size_t i = 0; i < cameras.size(); ++i)
            CHECK_LE(largest_difference(draw(gl, pass, pictures[i], cameras[i]), alone[i]),
                     kVisible);
        CHECK(pass.table_fills() == 1);

        Camera other = whole;
        other.target = {-30, 1, 5};
        const FogPicture picture = make_picture(gl, other);
        FogPass own = radial_pass(gl, *textures);
        CHECK(draw(gl, pass, picture, other).pixels.size() == 4u * kWidth * kHeight);
        CHECK_LE(largest_difference(draw(gl, pass, picture, other), draw(gl, own, picture, other)),
                 kVisible);
        CHECK(pass.table_fills() == 2);
        CHECK_LE(largest_difference(draw(gl, pass, pictures[0], cameras[0]), alone[0]), kVisible);
        CHECK(pass.table_fills() == 3);
    }
}

TEST_CASE("radial views: a stereo pair rests, and a moved eye refills its own table alone") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(137);
    Fog fog = smooth_fog(random);
    for (const auto& profile : all_profiles()) {
        fog.profile = profile;
        const auto textures = FogTextures::create(gl, fog);
        std::vector<Camera> eyes = {camera_cases().front().camera, camera_cases().front().camera};
        eyes[1].eye.x() += 0.065;
        eyes[1].target.x() += 0.065;
        std::vector<FogPicture> pictures;
        for (const Camera& eye : eyes) pictures.push_back(make_picture(gl, eye));
        const auto alone = one_by_one(gl, *textures, pictures, eyes);
        FogPass pass = radial_pass(gl, *textures);
        const std::size_t one_table = pass.bytes();
        REQUIRE(pass.set_views(views_of(eyes)).has_value());
        CHECK(pass.bytes() > one_table);
        for (int frame = 0; frame < 3; ++frame)
            for (std::size_t i = 0; i < 2; ++i)
                CHECK(draw(gl, pass, pictures[i], eyes[i]).pixels == alone[i].pixels);
        CHECK(pass.table_fills() == 2);

        eyes[0].eye.z() += 0.25;
        REQUIRE(pass.set_views(views_of(eyes)).has_value());
        for (std::size_t i = 0; i < 2; ++i) draw(gl, pass, pictures[i], eyes[i]);
        CHECK(pass.table_fills() == 3);
        CHECK(draw(gl, pass, pictures[1], eyes[1]).pixels == alone[1].pixels);

        pass.forget();
        draw(gl, pass, pictures[0], eyes[0]);
        CHECK(pass.table_fills() == 4);
        REQUIRE(pass.set_views({}).has_value());
        CHECK(pass.bytes() == one_table);
        CHECK(draw(gl, pass, pictures[1], eyes[1]).pixels == alone[1].pixels);
    }
}

TEST_CASE("radial views: the union of azimuths is what the views see, not the widest gap") {
    const double pi = std::numbers::pi;
    const auto view = [](double towards, double half) {
        RadialView one;
        one.full = false;
        one.axis = {std::cos(towards), std::sin(towards)};
        one.first = -half;
        one.last = half;
        one.pixel = half / 100;
        return one;
    };
    const auto covers = [&](const RadialView& all, double towards) {
        const double middle = std::atan2(all.axis.y(), all.axis.x());
        const double from = std::remainder(towards - middle, 2 * pi);
        return all.full || (from >= all.first - 1e-9 && from <= all.last + 1e-9);
    };
    Random random(139);
    for (int round = 0; round < 300; ++round) {
        std::vector<RadialView> views;
        std::vector<double> seen;
        const int count = random.integer(1, 5);
        for (int i = 0; i < count; ++i) {
            const double towards = random.uniform(-pi, pi), half = random.uniform(0.05, 1.2);
            views.push_back(view(towards, half));
            for (const double part : {-1.0, 0.0, 1.0}) seen.push_back(towards + part * half);
        }
        const RadialView all = radial_union(views);
        for (const double towards : seen) CHECK(covers(all, towards));
        // Nothing narrower: every end is an end of a view.
        if (!all.full)
            for (const double end : {all.first, all.last}) {
                const double towards = std::atan2(all.axis.y(), all.axis.x()) + end;
                CHECK(std::any_of(seen.begin(), seen.end(), [&](double one) {
                    return std::abs(std::remainder(one - towards, 2 * pi)) < 1e-9;
                }));
            }
    }
    const RadialView pair = radial_union({view(0.2, 0.5), view(0.2 - pi / 2, 0.3)});
    CHECK(pair.last - pair.first == doctest::Approx(pi / 2 + 0.8));
    CHECK(pair.pixel == 0.3 / 100);
    CHECK(radial_union({view(0, 1), view(2 * pi / 3, 1.1), view(-2 * pi / 3, 1.1)}).full);

    // Tiles of a level picture: columns stay pixel columns.
    std::vector<RadialView> tiles;
    for (const double shift : {-2.0, 0.0, 2.0}) {
        Camera tile;
        tile.eye = {0, 1, 0};
        tile.target = {3, 1, 4};
        tile.fov_y_deg = 40;
        tile.lens_shift = {shift, 0};
        tiles.push_back(radial_view(camera_matrices(tile, kWidth, kHeight), tile, kWidth, kHeight));
    }
    CHECK(radial_union(tiles).level_pixels == 3 * kWidth);
    CHECK(radial_union({tiles[1]}) == tiles[1]);
    CHECK(radial_union(tiles).axis == tiles[1].axis);
    RadialView above;
    CHECK(radial_union({view(0, 1), above}).full);
}
