// What a fog is: a spline surface of extinction over a rectangle, times a height profile.
#pragma once

#include <string>

#include "wavefog/fogmap/wind.h"
#include "wavefog/wavelet/decomposition.h"
#include "wavefog/wavelet/result.h"

namespace wavefog {

/// Splines of a higher degree are refused: their B-splines are flat and wide, and no picture needs
/// them.
inline constexpr int kMaxDegree = 15;
/// Levels of an "auto" decomposition: finer steps than 32 cells gain nothing for the renderer.
inline constexpr int kAutoLevels = 5;

/// World rectangle of the picture's outer edges, metres. Image column i grows along +x, row j
/// along +z.
struct Rect {
    double x0 = 0, z0 = 0, x1 = 1, z1 = 1;
    bool operator==(const Rect&) const = default;
};

/// Height profile h(y), dimensionless, y in metres.
struct Profile {
    enum class Kind {
        uniform,      ///< h = 1
        slab,         ///< h = 1 for bottom <= y <= top, else 0
        exponential,  ///< h = exp(-(y - base) / scale) above base, 1 below
        linear,       ///< h = 1 below base, falls to 0 at top
    };
    Kind kind = Kind::uniform;
    double bottom = 0, top = 0;  ///< slab: bottom < top; linear: base < top
    double base = 0, scale = 1;  ///< exponential: scale > 0
    bool operator==(const Profile&) const = default;

    double operator()(double y) const;
    /// A data error that names the offending value, e.g. "scale is 0; it must be above 0".
    Result<void> validate() const;
};

/// Extinction K(x,y,z) = extinction * rho(x,z) * h(y), 1/m; rho is the spline surface whose finest
/// coefficients are the fogmap's pixels (integer images in [0,1], float images as they are).
struct Fog {
    Rect rect;
    double extinction = 1;  ///< 1/m, >= 0
    Profile profile;
    Wind wind;
    Channels channels = kAllChannels;    ///< no part of fog files
    Decomposition<float> decomposition;  ///< carries basis, family, form, boundary, sizes

    int degree() const { return decomposition.degree(); }
    double cell_x() const { return (rect.x1 - rect.x0) / decomposition.width; }
    double cell_z() const { return (rect.z1 - rect.z0) / decomposition.height; }
    /// Checks rectangle, extinction, profile and finite coefficients.
    Result<void> validate() const;
};

/// Metres along x and z from a map's rectangle to where the wind has taken it. A repeated map comes
/// back after every period: whole ones are left out, exactly, so that no precision goes with time.
Eigen::Vector2d wind_offset(const Wind& wind, const Rect& rect, Boundary boundary, double seconds);

/// Options of make_fog, as on the command line.
struct FogOptions {
    int degree = 1;
    std::string family = {};  ///< empty: default_family(degree, form)
    Form form = Form::wavelet;
    int levels = -1;  ///< -1: auto, max_levels capped at kAutoLevels
    Boundary boundary = Boundary::zero;
};

/// Decomposes a map of finite, non-negative coefficients, as read by read_fogmap (a data error
/// names the first pixel that is not). The rectangle is one metre a pixel until the caller sets
/// another.
Result<Fog> make_fog(const Grid<float>& map, const FogOptions& options);

}  // namespace wavefog
