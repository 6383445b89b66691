// Study of methods that sample: a bank of fog thinner than their steps.
#include <algorithm>
#include <cmath>
#include <map>

#include "bench/accuracy.h"
#include "bench/stability.h"
#include "wavefog/gpu/fog_pass.h"
#include "wavefog/gpu/frame.h"

namespace wavefog::cli {
namespace {

constexpr int kWidth = 320, kHeight = 240, kMap = 512;
constexpr double kMetres = 256, kDistance = 33;

/// A wall of fog across the view, `pixels` of the map thick, of optical depth 1 straight through.
Result<Fog> bank(int pixels) {
    Grid<float> map = Grid<float>::Zero(kMap, kMap);
    const int row = int(kMap / 2 - kDistance / kMetres * kMap);
    map.middleRows(row - pixels / 2, pixels).setOnes();
    return study_fog(map, {.degree = 1, .levels = 0}, kMetres, kMap / (kMetres * pixels));
}

}  // namespace

Result<Figure> study_thin_bank(Context& context) {
    const Gl& gl = context.gl();
    Scene scene;
    // Off the middle: else march:N may happen to sample each pixel once, which is exact.
    scene.camera.eye = {0, 2, 37.3};
    scene.camera.target = {4, 2.5, -100};
    scene.camera.far_plane = 400;
    const Result<SceneRenderer> renderer = SceneRenderer::create(gl, scene);
    if (!renderer) return tl::unexpected(renderer.error());
    const FrameTarget frame = make_frame_target(gl, kWidth, kHeight);
    renderer->draw(frame, scene.camera);
    const Image depth = read_texture(gl, frame.depth.name(), kWidth, kHeight, 1, true);
    const Texture tau =
        make_texture_2d(gl, GL_RGBA32F, kWidth, kHeight, GL_RGBA, GL_FLOAT, nullptr);
    const Result<Framebuffer> target = make_framebuffer(gl, tau.name());
    if (!target) return tl::unexpected(target.error());

    Figure figure;
    figure.id = "stability-thin-bank";
    figure.title = "A thin bank falls between samples";
    figure.subtitle = "A wall of fog 70 m away, optical depth 1 straight through at any thickness";
    figure.x.label = "thickness of the bank, m";
    figure.y.label = "largest |ΔT| in the picture";
    figure.levels.push_back({kVisibleError, "least visible\nerror, 1/510"});
    const std::tuple<const char*, Curve::Style> methods[] = {
        {"march:32", Curve::Style::dashed},
        {"march:256", Curve::Style::line},
        {"froxel:160x90x64", Curve::Style::dashed},
        {"froxel:160x90x256", Curve::Style::line},
        {"exact", Curve::Style::line}};
    for (const auto& [name, style] : methods)
        figure.curves.push_back({name, method_base(name), style, {}});
    for (int pixels = 1; pixels <= 128; pixels *= 2) {
        const Result<Fog> fog = bank(pixels);
        if (!fog) return tl::unexpected(fog.error());
        const Truth truth = compute_truth({*fog}, {}, scene.camera, depth);
        const Result<FogTextures> textures = FogTextures::create(gl, *fog);
        if (!textures) return tl::unexpected(textures.error());
        for (std::size_t i = 0; i < std::size(methods); ++i) {
            Result<FogPass> pass = FogPass::create(
                gl, {&*textures}, *parse_method(std::get<0>(methods[i])), scene.fog_colour);
            if (!pass) return tl::unexpected(pass.error());
            pass->draw_optical_depth(frame, scene.camera, target->name());
            const Image drawn = read_texture(gl, tau.name(), kWidth, kHeight, 4);
            const Image sky{kWidth, kHeight, 4, std::vector<float>(drawn.pixels.size(), 0.5f)};
            const Accuracy accuracy = measure_accuracy(truth, drawn, sky, scene.fog_colour);
            figure.curves[i].points.emplace_back(pixels * kMetres / kMap, accuracy.max_dT);
        }
    }
    return figure;
}

}  // namespace wavefog::cli
