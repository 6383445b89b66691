// One fogged frame, drawn by the GPU pass or by the reference integrator.
#pragma once

#include <memory>
#include <string>

#include "wavefog/fogmap/image.h"
#include "wavefog/fogmap/scene.h"

namespace wavefog::cli {

struct Frame {
    Image colour;         ///< linear RGB, or RGBA if Surfaces::colour is
    Image transmittance;  ///< one channel, [0, 1]; three if fogs are seen by some colours alone
    std::string renderer;
};

/// What the fog pass reads: a picture without fog.
struct Surfaces {
    Image colour;  ///< linear RGB or RGBA
    Image depth;   ///< one channel, the depth buffer's values
};

/// Draws `scene` with scene.method at `supersample` times its size and averages back to it: linear
/// colours, and T itself (not the optical depth). Terrain, meshes and sky are drawn once; the fog
/// of each frame depends on its time alone, not on the frames before.
class FrameDrawer {
  public:
    /// The scene must outlive it.
    static Result<FrameDrawer> create(const Scene& scene, const std::string& context,
                                      int supersample);
    /// The scene's fogs over surfaces from elsewhere, seen by its camera; terrain, meshes, sky and
    /// size are the surfaces' own.
    static Result<FrameDrawer> over(const Scene& scene, const Surfaces& surfaces,
                                    const std::string& context);
    FrameDrawer(FrameDrawer&&) noexcept;
    FrameDrawer& operator=(FrameDrawer&&) noexcept;
    ~FrameDrawer();

    Result<Frame> draw(double seconds);
    /// Without fog, as drawn: larger than the scene by `supersample`.
    Surfaces surfaces() const;

  private:
    struct Impl;
    explicit FrameDrawer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// One frame.
Result<Frame> draw_frame(const Scene& scene, const std::string& context, int supersample,
                         double seconds = 0);

/// Mean of every factor x factor block; sides must be multiples of the factor.
Image box_average(const Image& image, int factor);

}  // namespace wavefog::cli
