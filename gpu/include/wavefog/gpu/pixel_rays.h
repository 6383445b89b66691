// The fog pass's rays in double: what a CPU method needs to draw the picture that the shader draws.
#pragma once

#include <vector>

#include "wavefog/fogmap/reference.h"
#include "wavefog/fogmap/scene.h"
#include "wavefog/gpu/frame.h"

namespace wavefog {

/// Sky rays end here when nothing else ends them, metres: the far plane, or 1000 km without one.
double sky_limit(const Camera& camera);

/// From world directions from the eye to clip coordinates: of the view only its rotation, so that
/// no world coordinate costs precision. And back.
Eigen::Matrix4d clip_from_eye(const CameraMatrices& matrices);
Eigen::Matrix4d eye_from_clip(const CameraMatrices& matrices);

/// `sky` pixels have no end point.
struct PixelRay {
    Eigen::Vector3d origin;
    Eigen::Vector3d end;  ///< surface point; for sky: origin + unit direction
    bool sky = false;
};

/// World-space rays of a picture, rebuilt from depth values as the fog pass does.
class PixelRays {
  public:
    PixelRays(const Camera& camera, int width, int height);

    /// The ray through the middle of a pixel (row 0 at the top; a part of 1 is a place in it) with
    /// this value in the depth buffer.
    PixelRay at(double x, double y_from_top, double depth) const;
    double sky_depth() const { return sky_depth_; }
    /// The height of a pixel in the middle of the picture, metres at `distance` from the eye.
    double pixel_size(double distance) const;
    /// The sum of the fogs' optical depths along a ray; a sky ray ends at each map's far end, and
    /// for models and particles at sky_limit().
    double optical_depth(const std::vector<Reference>& fogs, const PixelRay& ray, double mu = 1,
                         const std::vector<FogModel>& models = {},
                         const std::vector<Particle>& particles = {}) const;
    /// The same as red, green and blue see it: each fog times its channels.
    Eigen::Array3d channel_depths(const std::vector<Reference>& fogs, const PixelRay& ray,
                                  double mu = 1, const std::vector<FogModel>& models = {},
                                  const std::vector<Particle>& particles = {}) const;

  private:
    double through(const Reference& fog, const PixelRay& ray, double mu) const;

    Eigen::Matrix4d eye_from_clip_;
    Eigen::Vector3d eye_;
    double sky_depth_, sky_limit_;
    double pixel_;  ///< at 1 m; at any distance if orthographic
    int width_, height_;
    bool orthographic_;
};

}  // namespace wavefog
