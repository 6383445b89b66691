// The views that a fit is tuned on and those that it is held to.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy.h"
#include "options.h"
#include "wavefog/fogmap/scene.h"
#include "wavefog/gpu/fog_pass.h"
#include "wavefog/gpu/frame.h"

namespace wavefog::cli {

/// A scene drawn from one camera without fog, with the true optical depth of its pixels.
struct View {
    std::string name;
    Camera camera;
    FrameTarget frame;
    Truth truth;
};

/// What to tune on: the scene's camera, and it turned a little to either side.
std::vector<std::pair<std::string, Camera>> tuning_cameras(const Camera& camera);
/// What to verify on: views that the tuning has not seen, from other places too.
std::vector<std::pair<std::string, Camera>> held_out_cameras(const Camera& camera);

/// Draws the scene and integrates `fogs` (undecomposed) by the reference, for every camera.
Result<std::vector<View>> make_views(const Gl& gl, const Scene& scene, const std::vector<Fog>& fogs,
                                     const std::vector<std::pair<std::string, Camera>>& cameras,
                                     const Size& size);

Result<std::vector<FogTextures>> make_textures(const Gl& gl, const std::vector<Fog>& fogs);

/// `textures` stay where they are and outlive the pass.
Result<FogPass> make_pass(const Gl& gl, const std::vector<FogTextures>& textures,
                          const Method& method, const Scene& scene);

/// The largest |T - T_true| over the views' pixels.
Result<double> largest_error(const Gl& gl, FogPass& pass, const std::vector<View>& views);

/// The same of fogs that are drawn for this alone.
Result<double> largest_error(const Gl& gl, const Scene& scene, const std::vector<Fog>& fogs,
                             const Method& method, const std::vector<View>& views);

}  // namespace wavefog::cli
