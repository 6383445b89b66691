// The views that a fit is tuned on and those that it is held to.
#pragma once

#include <limits>
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
    Image depth;               ///< as the fog passes read it
    Truth truth;               ///< of all fogs
    std::vector<Truth> parts;  ///< of each map, for views to tune on
};

/// The scene's camera, called "main", and its further ones.
std::vector<NamedCamera> cameras_of(const Scene& scene);
/// What to tune on: the scene's cameras, and each turned a little to either side.
std::vector<NamedCamera> tuning_cameras(const Scene& scene);
/// What to verify on: views that the tuning has not seen, from other places too.
std::vector<NamedCamera> held_out_cameras(const Scene& scene);

/// Draws the scene and integrates `fogs` (undecomposed) by the reference, for every camera.
Result<std::vector<View>> make_views(const Gl& gl, const Scene& scene, const std::vector<Fog>& fogs,
                                     const std::vector<NamedCamera>& cameras, const Size& size);

/// The scene's own cameras in full: the truth of every pixel up to 3840x2160, of larger pictures
/// every n-th of every n-th row, as whole_words() says.
Result<std::vector<View>> make_whole_views(const Gl& gl, const Scene& scene,
                                           const std::vector<Fog>& fogs, const Size& size);
/// "every pixel" or "one pixel in every 2x2".
std::string whole_words(const Size& size);

Result<std::vector<FogTextures>> make_textures(const Gl& gl, const std::vector<Fog>& fogs);

/// `textures` stay where they are and outlive the pass.
Result<FogPass> make_pass(const Gl& gl, const std::vector<FogTextures>& textures,
                          const Method& method, const Scene& scene,
                          const std::vector<FogModel>& models);

/// The largest |T - T_true| over the views' pixels, and where it is.
struct Worst {
    double error = 0;
    std::string view;
};

/// Stops at the first view that errs more than `limit`: the error is then that view's.
Result<Worst> largest_error(const Gl& gl, FogPass& pass, const std::vector<View>& views,
                            double limit = std::numeric_limits<double>::infinity());

/// The same of fogs that are drawn for this alone.
Result<Worst> largest_error(const Gl& gl, const Scene& scene, const std::vector<Fog>& fogs,
                            const std::vector<FogModel>& models, const Method& method,
                            const std::vector<View>& views,
                            double limit = std::numeric_limits<double>::infinity());

}  // namespace wavefog::cli
