// Filling tables of method radial with compute shaders and without.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "fogmap/fog_support.h"
#include "gpu/fog_picture.h"
#include "radial_fill.h"
#include "wavefog/gpu/pixel_rays.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

Gl without_compute(const Gl& gl) {
    Gl less = gl;
    less.DispatchCompute = nullptr;
    less.MemoryBarrier = nullptr;
    less.BindImageTexture = nullptr;
    return less;
}

/// A fog on the GPU as RadialFill wants it.
struct Cells {
    FogFacts facts;
    Texture texture;
};
Cells cells_of(const Gl& gl, const Fog& fog) {
    const CellAtlas atlas = build_cell_atlas(approximations(fog.decomposition));
    const bool single = atlas.channels == 1;
    return {fog_facts(fog, atlas),
            make_texture_2d(gl, single ? GL_R32F : GL_RGBA32F, atlas.width, atlas.height,
                            single ? GL_RED : GL_RGBA, GL_FLOAT, atlas.texels.data())};
}

std::vector<float> filled(const Gl& gl, const Cells& cells, const RadialShape& shape,
                          const shader::FogBlock& fog, const shader::RadialBlock& radial) {
    auto fill = RadialFill::create(gl, cells.facts, shape);
    REQUIRE_MESSAGE(fill.has_value(), (fill ? "" : fill.error().message));
    CHECK((fill->bytes() > 0) == !has_compute(gl));
    const Texture table = fill->make_table(shape);
    fill->fill(table.name(), shape, fog, radial, cells.texture.name());
    CHECK(gl.GetError() == GL_NO_ERROR);
    return read_texture(gl, table.name(), shape.columns, shape.rows * shape.layers, 4).pixels;
}

/// The largest difference of two tables' means, which are at most about 1.
double largest_difference(const Gl& gl, const Fog& fog, const Camera& camera,
                          const Method& method) {
    const Gl less = without_compute(gl);
    const Cells cells = cells_of(gl, fog);
    const RadialShape shape = radial_shape(cells.facts, method);
    const double limit = sky_limit(camera);
    const auto block = fog_block(cells.facts, camera.eye, method.mu, 0, limit);
    const RadialView view =
        radial_view(camera_matrices(camera, kWidth, kHeight), camera, kWidth, kHeight);
    const auto radial = radial_block(cells.facts, camera.eye, view, 0, limit, shape);
    const auto computed = filled(gl, cells, shape, block, radial);
    const auto drawn = filled(less, cells, shape, block, radial);
    double largest = 0, sum = 0;
    REQUIRE(computed.size() == drawn.size());
    for (std::size_t i = 0; i < computed.size(); ++i) {
        if (!std::isfinite(drawn[i])) return std::numeric_limits<double>::infinity();
        const int row = static_cast<int>(i / 4) / shape.columns % shape.rows;
        // A texture without alpha reads 1.
        if (i % 4 == 3 || row >= radial.size.y) continue;
        largest = std::max(largest, std::abs(static_cast<double>(computed[i]) - drawn[i]));
        sum += computed[i];
    }
    CHECK(sum > 0);
    return largest;
}

// Sums of some hundred steps in another order, and steps told apart by differences, each to 2^-24
// of a map's length; near the eye a mean is divided by few of its metres.
constexpr double kRounding = 2e-5;

}  // namespace

TEST_CASE("radial without compute shaders: the same table for every basis, profile and border") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    Random random(107);
    const auto cases = camera_cases();
    double worst = 0;
    for (int degree = 0; degree <= 2; ++degree)
        for (const Boundary boundary : {Boundary::zero, Boundary::repeat}) {
            FogOptions options;
            options.degree = degree;
            options.levels = 3;
            options.boundary = boundary;
            Fog fog = fog_of(make_map<float>(MapKind::random, 48, 36, random), options);
            fog.rect = {-20, -12, 28, 24};
            fog.extinction = 0.02;
            for (const auto& profile : all_profiles())
                for (const int i : {0, 1, 2})
                    for (const double mu : {1.0, 0.6}) {
                        fog.profile = profile;
                        const Method method = {
                            .kind = MethodKind::radial, .radial = {200, 150 + 211 * i}, .mu = mu};
                        CAPTURE(degree);
                        CAPTURE(static_cast<int>(boundary));
                        CAPTURE(static_cast<int>(profile.kind));
                        CAPTURE(std::string(cases[static_cast<std::size_t>(i)].name));
                        CAPTURE(mu);
                        const double difference = largest_difference(
                            gl, fog, cases[static_cast<std::size_t>(i)].camera, method);
                        worst = std::max(worst, difference);
                        CHECK_LE(difference, kRounding);
                    }
        }
    MESSAGE("largest difference " << worst);
}

TEST_CASE("radial without compute shaders: the same pictures") {
    Context& context = osmesa();
    const Gl& gl = context.gl();
    const Gl less = without_compute(gl);
    CHECK(has_compute(gl));
    CHECK_FALSE(has_compute(less));
    Random random(109);
    Fog fog = random_fog(48, 36, {.degree = 1, .levels = 2}, random);
    double worst = 0;
    for (const auto& profile : all_profiles()) {
        fog.profile = profile;
        const auto textures = FogTextures::create(gl, fog);
        auto computed = FogPass::create(gl, {&*textures}, {.kind = MethodKind::radial}, {1, 1, 1});
        auto drawn = FogPass::create(less, {&*textures}, {.kind = MethodKind::radial}, {1, 1, 1});
        REQUIRE_MESSAGE(drawn.has_value(), (drawn ? "" : drawn.error().message));
        for (const auto& [name, camera] : camera_cases()) {
            const FogPicture picture = make_picture(gl, camera);
            computed->draw_optical_depth(picture.frame, camera, picture.target.name());
            const Image a = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
            drawn->draw_optical_depth(picture.frame, camera, picture.target.name());
            const Image b = read_texture(gl, picture.tau.name(), kWidth, kHeight, 4);
            CAPTURE(std::string(name));
            CAPTURE(static_cast<int>(profile.kind));
            double largest = 0;
            for (std::size_t i = 0; i < a.pixels.size(); i += 4)
                largest = std::max(largest, std::abs(std::exp(-static_cast<double>(a.pixels[i])) -
                                                     std::exp(-static_cast<double>(b.pixels[i]))));
            worst = std::max(worst, largest);
            // (In uniform fog so dense that T < 1e-3 the compute shader's columns end, for speed.)
            // The exponential profile takes differences of far integrals, which multiply rounding.
            CHECK_LE(largest, profile.kind == Profile::Kind::exponential ? 8e-5 : 4e-6);
        }
    }
    MESSAGE("largest difference in T " << worst);
    CHECK(gl.GetError() == GL_NO_ERROR);
}

TEST_CASE("a context without compute shaders loads, and froxel says what it lacks") {
    Context& context = osmesa();
    const auto loaded = load_gl([&](const char* name) -> void* {
        const bool compute = std::string(name) == "glDispatchCompute";
        return compute ? nullptr : context.loader()(name);
    });
    REQUIRE_MESSAGE(loaded.has_value(), (loaded ? "" : loaded.error().message));
    CHECK_FALSE(has_compute(*loaded));
    Random random(113);
    const auto textures =
        FogTextures::create(*loaded, random_fog(24, 18, {.degree = 1, .levels = 1}, random));
    const auto froxel = FogPass::create(
        *loaded, {&*textures}, {.kind = MethodKind::froxel, .froxels = {16, 9, 8}}, {1, 1, 1});
    REQUIRE_FALSE(froxel.has_value());
    CHECK(froxel.error().kind == ErrorKind::data);
    CHECK(froxel.error().message.find("needs compute shaders") != std::string::npos);
}

namespace {

bool has_validator() {
    return std::system("command -v glslangValidator > /dev/null 2>&1") == 0;
}

}  // namespace

// Counted as skipped where the tool is missing (Debian: glslang-tools).
TEST_CASE("radial without compute shaders: its shaders are GLSL ES 3.00" *
          doctest::skip(!has_validator())) {
    const TempDir folder;
    std::string files;
    const auto add = [&](const std::string& shader, const std::string& defines) {
        static int count = 0;
        const std::string name = std::to_string(count++) + shader.substr(shader.find('.'));
        files += ' ';
        files += folder.write(name, "#version 300 es\n" + defines + shader_source(shader)).string();
    };
    add("post_fullscreen.vert", "");
    for (const char* repeat : {"", "#define FOG_REPEAT\n"})
        for (int degree = 0; degree <= 2; ++degree)
            for (int profile = 0; profile <= 3; ++profile) {
                std::string variant = repeat;
                variant += "#define FOG_DEGREE " + std::to_string(degree);
                variant += "\n#define FOG_PROFILE " + std::to_string(profile) + "\n";
                add("radial_segments.frag", variant);
                add("radial_scan.frag", variant + "#define RADIAL_JOINED 8\n");
                add("fog_pass.frag", variant + "#define FOG_METHOD 5\n");
                add("fog_pass.frag", variant + "#define FOG_METHOD 5\n#define RADIAL_LAYERED\n");
                // What an orthographic camera gets.
                add("fog_pass.frag", variant + "#define FOG_METHOD 0\n#define FOG_SKIP\n");
            }
    // Formulas, and fogs that the colours see differently.
    add("fog_pass.frag",
        "#define FOG_DEGREE 0\n#define FOG_PROFILE 0\n#define FOG_METHOD 6\n#define FOG_CHANNELS\n"
        "#define FOG_PREVIOUS_TAU\n");
    add("fog_reduce_depth.frag", "");
    add("fog_reduce_depth.frag", "#define FOG_AVERAGE\n");
    for (const char* upsample : {"0", "1", "2"})
        for (const char* more : {"", "#define FOG_CHANNELS\n#define FOG_OUTPUT_TAU\n"})
            add("fog_upsample.frag", "#define FOG_UPSAMPLE " + std::string(upsample) + "\n" + more);
    const auto log = folder / "log";
    const int status =
        std::system(("glslangValidator" + files + " > " + log.string() + " 2>&1").c_str());
    std::ifstream text(log);
    std::string line, errors;
    while (std::getline(text, line))
        if (line.find("ERROR") != std::string::npos) errors += line + '\n';
    CHECK_MESSAGE(status == 0, errors);
    CHECK(errors.empty());
}
