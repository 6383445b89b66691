// Fog in reduced pictures and at vertices (FogSampling), on OSMesa against fog in every pixel.
#include <doctest/doctest.h>

#include <numeric>

#include "fogmap/fog_support.h"
#include "fogmap/model_support.h"
#include "gpu/fog_picture.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

Method sampled(const std::string& method, const std::string& sampling) {
    return *parse_method(sampling.empty() ? method : method + "@" + sampling);
}

Image optical_depth(const Gl& gl, FogPicture& picture, const Camera& camera, FogPass& pass) {
    pass.draw_optical_depth(picture.frame, camera, picture.target.name());
    return read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
}

FogPass pass_of(const Gl& gl, const std::vector<const FogTextures*>& maps, const Method& method,
                const std::vector<FogModel>& models = {}) {
    auto pass = FogPass::create(gl, maps, method, {0.5, 0.6, 0.7}, models);
    REQUIRE_MESSAGE(pass.has_value(), (pass ? "" : pass.error().message));
    return std::move(*pass);
}

struct Difference {
    double largest = 0, mean = 0;
};

/// |dT| of two pictures of optical depth.
Difference difference(const Image& a, const Image& b, int channel = 0) {
    REQUIRE(a.pixels.size() == b.pixels.size());
    Difference found;
    for (int y = 0; y < a.height; ++y)
        for (int x = 0; x < a.width; ++x) {
            const double d = std::abs(std::exp(-double(a.at(x, y, channel))) -
                                      std::exp(-double(b.at(x, y, channel))));
            REQUIRE(std::isfinite(d));
            found.largest = std::max(found.largest, d);
            found.mean += d / (a.width * a.height);
        }
    return found;
}

/// A wall 8 m before the eye in the left half, one 80 m away in the right, sky above both.
std::vector<float> walls(const Camera& camera) {
    const CameraMatrices m = camera_matrices(camera, kWidth, kHeight);
    const auto buffer = [&](double distance) {
        const Eigen::Vector4d clip = m.projection * Eigen::Vector4d(0, 0, -distance, 1);
        return static_cast<float>(clip.z() / clip.w());
    };
    std::vector<float> depth;
    for (int y = 0; y < kHeight; ++y)
        for (int x = 0; x < kWidth; ++x)
            depth.push_back(y > 31 ? static_cast<float>(m.sky_depth) : buffer(x < 29 ? 8 : 80));
    return depth;
}

}  // namespace

TEST_CASE("sampling: a reduced picture that is not smaller changes nothing") {
    const Gl& gl = osmesa().gl();
    Random random(601);
    const auto textures =
        FogTextures::create(gl, random_fog(32, 24, {.degree = 1, .levels = 2}, random));
    REQUIRE(textures.has_value());
    const std::vector<FogModel> models = {random_cosines(random)};
    for (const auto& [name, camera] : camera_cases()) {
        FogPicture picture = make_picture(gl, camera);
        for (const char* method : {"exact", "radial", "march:8", "homogeneous", "paper"}) {
            CAPTURE(std::string(name));
            CAPTURE(std::string(method));
            FogPass full = pass_of(gl, {&*textures}, sampled(method, ""), models);
            const Image whole = optical_depth(gl, picture, camera, full);
            for (const char* size : {"64x48", "64x48:average", "100x48", "300x200:average"}) {
                FogPass pass = pass_of(gl, {&*textures}, sampled(method, size), models);
                CHECK(optical_depth(gl, picture, camera, pass).pixels == whole.pixels);
            }
        }
    }
}

TEST_CASE("sampling: halos of the average at silhouettes, none where depth is looked at") {
    const Gl& gl = osmesa().gl();
    const std::vector<FogModel> fog = {Halfspace{{0, 1, 0}, {0, 1000, 0}, 0.02, 0}};
    FogPass full = pass_of(gl, {}, {}, fog);
    for (const auto& [name, camera] : camera_cases()) {
        if (camera.projection == Camera::Projection::orthographic) continue;
        CAPTURE(std::string(name));
        FogPicture picture = make_picture(gl, camera, walls(camera));
        const Image truth = optical_depth(gl, picture, camera, full);
        for (const char* size : {"32x24", "16x12", "8x6", "13x7"}) {
            CAPTURE(std::string(size));
            FogPass aware = pass_of(gl, {}, sampled("exact", size), fog);
            FogPass average =
                pass_of(gl, {}, sampled("exact", std::string(size) + ":average"), fog);
            const Difference a = difference(optical_depth(gl, picture, camera, aware), truth);
            const Difference b = difference(optical_depth(gl, picture, camera, average), truth);
            MESSAGE(std::string(name), " ", std::string(size), ": aware ", a.largest, ", average ",
                    b.largest);
            // Each wall fills reduced pixels on its own, so that some neighbour is on it.
            CHECK_LE(a.largest, 0.02);
            CHECK_LE(a.largest, b.largest);
            CHECK_LE(a.mean, b.mean);
            // exp(-0.16) and exp(-1.6) lie 0.65 apart.
            CHECK_GE(b.largest, 0.15);
        }
    }
}

TEST_CASE("sampling: more reduced pixels err less, whatever the camera") {
    const Gl& gl = osmesa().gl();
    Random random(607);
    const auto textures =
        FogTextures::create(gl, random_fog(16, 12, {.degree = 2, .levels = 1}, random));
    REQUIRE(textures.has_value());
    for (const auto& [name, camera] : camera_cases()) {
        FogPicture picture = make_picture(gl, camera);
        for (const char* method : {"exact", "radial"}) {
            CAPTURE(std::string(name));
            CAPTURE(std::string(method));
            FogPass full = pass_of(gl, {&*textures}, sampled(method, ""));
            const Image truth = optical_depth(gl, picture, camera, full);
            for (const char* upsample : {"", ":average"}) {
                double before = 1;
                for (const char* size : {"4x3", "16x12", "48x36"}) {
                    FogPass pass =
                        pass_of(gl, {&*textures}, sampled(method, std::string(size) + upsample));
                    const double mean =
                        difference(optical_depth(gl, picture, camera, pass), truth).mean;
                    MESSAGE(std::string(name), " ", pass.bytes(), " ", std::string(size),
                            std::string(upsample), ": mean ", mean);
                    CHECK_LT(mean, before);
                    before = mean;
                }
                CHECK_LT(before, 0.02);
            }
        }
    }
}

TEST_CASE("sampling: fogs add up, for each colour, and colour is blended once") {
    const Gl& gl = osmesa().gl();
    Random random(613);
    const Camera camera = camera_cases().front().camera;
    FogPicture picture = make_picture(gl, camera);
    Fog reddish = random_fog(32, 24, {.degree = 1, .levels = 2}, random);
    reddish.channels = {0.2, 1, 2};
    const auto tinted = FogTextures::create(gl, reddish);
    const auto grey = FogTextures::create(gl, random_fog(24, 32, {.degree = 2}, random));
    REQUIRE(tinted.has_value());
    REQUIRE(grey.has_value());
    const std::vector<FogModel> models = {random_cosines(random)};
    for (const char* sampling : {"16x12", "20x12:average"}) {
        CAPTURE(std::string(sampling));
        const Method method = sampled("exact", sampling);
        FogPass one = pass_of(gl, {&*tinted}, method), two = pass_of(gl, {&*grey}, method, models);
        FogPass all = pass_of(gl, {&*tinted, &*grey}, method, models);
        CHECK(all.coloured());
        CHECK_FALSE(two.coloured());
        const Image a = optical_depth(gl, picture, camera, one);
        const Image b = optical_depth(gl, picture, camera, two);
        const Image sum = optical_depth(gl, picture, camera, all);
        all.draw_colour(picture.frame, camera, picture.target.name());
        const Image colour = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
        const double fog_colour[3] = {0.5, 0.6, 0.7};
        double worst = 0, blend = 0;
        for (int y = 0; y < kHeight; ++y)
            for (int x = 0; x < kWidth; ++x)
                for (int c = 0; c < 3; ++c) {
                    const double tau = double(sum.at(x, y, c));
                    worst = std::max(
                        worst, std::abs(std::exp(-tau) -
                                        std::exp(-double(a.at(x, y, c)) - double(b.at(x, y, 0)))));
                    const double t = std::exp(-tau);
                    blend = std::max(blend, std::abs(double(colour.at(x, y, c)) -
                                                     (t * 0.25 + (1 - t) * fog_colour[c])));
                }
        // Both upsamplings are linear in the optical depth: float32 alone differs.
        CHECK_LE(worst, 2e-6);
        CHECK_LE(blend, 1e-6);
    }
}

TEST_CASE("sampling: what makes no sense is refused") {
    const Gl& gl = osmesa().gl();
    Random random(617);
    const auto textures = FogTextures::create(gl, random_fog(8, 8, {.degree = 1}, random));
    const auto refused = [&](const Method& method, const std::vector<Channels>& particles,
                             const char* words) {
        const auto pass =
            FogPass::create(gl, {&*textures}, method, {1, 1, 1}, {}, particles, nullptr);
        REQUIRE_FALSE(pass.has_value());
        CHECK(pass.error().kind == ErrorKind::usage);
        CHECK_MESSAGE(pass.error().message.find(words) != std::string::npos, pass.error().message);
    };
    Method froxel = *parse_method("froxel:8x8x8"), radial = *parse_method("radial");
    froxel.sampling.width = froxel.sampling.height = 16;
    radial.sampling.vertices = true;
    refused(froxel, {}, "froxel:8x8x8@16x16");
    refused(radial, {}, "radial@vertices");
    refused(sampled("exact", "vertices"), {kAllChannels}, "particles");
    refused(sampled("exact", "vertices"), {}, "no vertices");
    const auto on_cpu =
        ShaderOnCpu::create(random_fog(8, 8, {.degree = 1}, random), sampled("exact", "16x16"));
    REQUIRE_FALSE(on_cpu.has_value());
    CHECK(on_cpu.error().message.find("exact@16x16") != std::string::npos);
}
