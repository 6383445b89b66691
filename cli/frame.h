// One fogged frame, drawn by the GPU pass or by the reference integrator.
#pragma once

#include <memory>
#include <string>

#include "wavefog/fogmap/image.h"
#include "wavefog/fogmap/scene.h"

namespace wavefog::cli {

struct Frame {
    Image colour;         ///< linear RGB
    Image transmittance;  ///< one channel, [0, 1]
    std::string renderer;
};

/// Draws `scene` with scene.method at `supersample` times its size and averages back to it: linear
/// colours, and T itself (not the optical depth). Terrain, meshes and sky are drawn once; the fog
/// of each frame depends on its time alone, not on the frames before.
class FrameDrawer {
  public:
    /// The scene must outlive it.
    static Result<FrameDrawer> create(const Scene& scene, const std::string& context,
                                      int supersample);
    FrameDrawer(FrameDrawer&&) noexcept;
    FrameDrawer& operator=(FrameDrawer&&) noexcept;
    ~FrameDrawer();

    Result<Frame> draw(double seconds);

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
