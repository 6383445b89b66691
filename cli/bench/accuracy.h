// How far a picture is from the truth.
#pragma once

#include <deque>
#include <optional>
#include <vector>

#include "wavefog/fogmap/image.h"
#include "wavefog/fogmap/scene.h"
#include "wavefog/gpu/march_bound.h"
#include "wavefog/gpu/radial_bound.h"

namespace wavefog::cli {

/// Optical depth of every pixel by the reference integrator at mu = 1, row 0 at the top.
struct Truth {
    int width = 0, height = 0;
    std::vector<double> tau;  ///< along the ray through the pixel's middle
    /// The mean of T over the pixel's area where cells are smaller than it, so that the one ray in
    /// its middle would be an aliasing error itself; elsewhere exp(-tau). Empty unless asked for.
    std::vector<double> mean_T;
    int stride = 1;  ///< pixel (x, y) is the picture's (stride x, stride y)
};

/// From the depth buffer that the fog passes read, on all cores. `fogs` as undecomposed() makes
/// them: the finest map itself. `means` asks for mean_T: 4x4 rays a pixel, all of which end at the
/// one depth that the buffer has for it.
Truth compute_truth(const std::vector<Fog>& fogs, const std::vector<FogModel>& models,
                    const Camera& camera, const Image& depth, int stride = 1, bool means = false,
                    const std::vector<Particle>& particles = {});

/// Every stride-th pixel of every stride-th row, as a Truth of that stride has them.
Image every_nth(const Image& image, int stride);

/// Of the rays of a picture: bounds on errors need no more.
RayLimits ray_limits(const std::vector<Fog>& fogs, const Camera& camera, const Image& depth);

/// What bounds need of a fog, found when it is first asked for. `fog` must outlive it.
class FogBounds {
  public:
    explicit FogBounds(const Fog& fog) : fog_(fog) {}
    FogBounds(const FogBounds&) = delete;
    FogBounds& operator=(const FogBounds&) = delete;

    const Fog& fog() const { return fog_; }
    const DetailBound& dropped();
    const MarchBound& march();
    const RadialBound& radial();
    double densest();  ///< 1/m

  private:
    const Fog& fog_;
    std::optional<DetailBound> dropped_;
    std::optional<MarchBound> march_;
    std::optional<RadialBound> radial_;
    std::optional<double> densest_;
};

/// Bound on |dT| for every ray of a picture of `width` x `height` pixels within `limits`: certified
/// for dropped details, for radial's tables and for march's samples, and what float32 adds to first
/// order: walks stop at T = 2^-21, and a place along a ray is off by four units in its last place,
/// times the densest fog there is. 1, which holds always, for methods that may miss any fog:
/// homogeneous, froxel, fog in fewer places than pixels, and the paper's tables of quadratic
/// functions and by perimeter. `fogs`: all of the picture's.
double certified_bound(std::deque<FogBounds>& fogs, const Method& method, const Camera& camera,
                       int width, int height, const RayLimits& limits);

struct Accuracy {
    double max_dT = 0, p99_dT = 0;                   ///< of |T - T_true| over the pixels
    std::optional<double> max_mean_dT, p99_mean_dT;  ///< the same against Truth::mean_T
    double rmse_tau = 0;  ///< over pixels with a true optical depth up to kOpaque
    double psnr = 0;      ///< dB, of the sRGB picture in [0,1], three channels; 200 if equal
    double ssim = 0;
};

/// Beyond this optical depth T < 4e-7: methods may stop there, and by design do.
inline constexpr double kOpaque = 14.6;

/// `tau` is a method's optical depth (channel 0), `scene` the linear picture without fog (at least
/// three channels). Both pictures are the blend L = T L_scene + (1 - T) L_fog (paper 004, eq. 4).
Accuracy measure_accuracy(const Truth& truth, const Image& tau, const Image& scene,
                          const Eigen::Vector3d& fog_colour);

/// sRGB's curve for a linear value, clipped to [0,1].
double srgb_from_linear(double value);

/// Mean structural similarity of two pictures in [0,1] (Wang et al. 2004): Gaussian window of 11x11
/// pixels with sigma 1.5, K1 = 0.01, K2 = 0.03, windows wholly inside the picture. 1 for pictures
/// smaller than a window.
double ssim(int width, int height, const std::vector<double>& a, const std::vector<double>& b);

}  // namespace wavefog::cli
