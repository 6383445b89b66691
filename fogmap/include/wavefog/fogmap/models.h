// Fogs given by formulas instead of a map: their extinction at a point, and in closed form along a
// segment. Lengths in metres, extinction in 1/m, world axes with y up.
#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <variant>
#include <vector>

#include "wavefog/fogmap/channels.h"
#include "wavefog/wavelet/result.h"

namespace wavefog {

/// Fog on one side of a plane (Lengyel, "Unified Distance Formulas for Halfspace Fog"). At depth s
/// metres behind the plane the extinction is extinction + gradient * s.
struct Halfspace {
    /// Transmittance of a ray with the optical depth tau in this fog (table 1 there, with the true
    /// distance). Only `exp` is the law of Beer; the others, OpenGL's, hold for whole rays: parts
    /// of one do not add up.
    enum class Fraction {
        exp,     ///< exp(-tau)
        linear,  ///< 1 - (tau - extinction * start), in [0, 1]
        exp2     ///< exp(-tau^2)
    };
    Eigen::Vector3d normal{0, 1, 0};  ///< unit length, points out of the fog
    Eigen::Vector3d point{0, 0, 0};   ///< any point of the plane
    double extinction = 0;            ///< constant part, eq. 5; 1/m
    double gradient = 0;              ///< linear part (the paper's a), eq. 13; 1/m^2
    Fraction fraction = Fraction::exp;
    double start = 0;  ///< linear: metres of constant fog before it shows (GL_FOG_START); it
                       ///< saturates 1 / extinction further (the paper's e, GL_FOG_END)
    /// Optical depth of linear fog that has saturated: no share of it that a float holds is left.
    static constexpr double kSaturated = 200;
};

/// Fog that changes with height alone (paper 001, section 3.2.2): straight lines between points,
/// the first and the last extinction on below and above. Two points make a ground fog that ends,
/// four a layer.
struct Ramp {
    struct Point {
        double y = 0, extinction = 0;
    };
    std::vector<Point> points;  ///< at least two, y ascending
};

/// The same with extinction * exp(-(y - base) / scale) above base, and `extinction` below.
struct ExponentialLayer {
    double extinction = 0, base = 0, scale = 1;
};

/// constant + sum of amplitudes times cos(k Lambda(x) + phase), Lambda(x) = direction . x (paper
/// 000, section 3.2.1). Not negative, because the constant is at least the sum of |amplitude|.
struct Cosines {
    struct Wave {
        double extinction = 0;               ///< amplitude, 1/m, either sign
        Eigen::Vector3d direction{1, 0, 0};  ///< any length but 0
        double frequency = 0;                ///< k, radians a metre of Lambda
        double phase = 0;                    ///< radians
    };
    double extinction = 0;  ///< the constant, 1/m
    std::vector<Wave> waves;
};

/// Sum of polynomials of one coordinate each (paper 000, section 3.2.2): P(u) with u from -1 to 1
/// across a bounded domain, u = (x - centre) . direction / half_width.
struct Polynomials {
    enum class Outside { zero, repeat };
    struct Term {
        double extinction = 0;               ///< of P = 1, 1/m
        std::vector<double> coefficients;    ///< ascending powers of u, 1 to kMaxCoefficients
        Eigen::Vector3d direction{1, 0, 0};  ///< unit length
        Eigen::Vector3d centre{0, 0, 0};
        double half_width = 1;              ///< metres, above 0
        Outside outside = Outside::repeat;  ///< repeat: the domain again as tiles, P(-1) = P(1)
    };
    static constexpr int kMaxCoefficients = 10;
    std::vector<Term> terms;
};

/// Fog around virtual objects (paper 000, section 3.2.3, eq. 9 with c = 1 / extinction and d =
/// c / reach^2): a point at distance r has extinction / (1 + r^2 / reach^2). The paper takes r
/// between object and ray; here it is taken at every point of the ray, and integrated. For a
/// sphere r is the length of the tangent, 0 inside: the integral stays in closed form.
struct Potentials {
    struct Object {
        enum class Kind { point, line, sphere };
        Kind kind = Kind::point;
        Eigen::Vector3d from{0, 0, 0};  ///< the point, the line's beginning, the sphere's centre
        Eigen::Vector3d to{0, 0, 0};    ///< line: its end
        double radius = 0;              ///< sphere: above 0
        double extinction = 0;          ///< on the object; negative subtracts
        double reach = 1;               ///< distance at which half of it is left, above 0
    };
    double extinction = 0;  ///< everywhere; at least what the negative objects take away
    std::vector<Object> objects;
};

/// A function of one coordinate: straight lines between evenly spaced values (paper 001, section
/// 3.2.2: an integral that is computed before, eq. 6-8).
struct AxisTable {
    std::vector<double> values;  ///< 0 or more each; none: 1 everywhere; else 2 to kMaxValues
    double begin = 0, end = 1;   ///< where the first and the last one lie, metres
    bool repeat = false;         ///< outside: the table again (its last value is the first), or its
                                 ///< first and last value
    static constexpr std::size_t kMaxValues = 4096;
};

/// extinction * x(x) * y(y) * z(z) (paper 001, section 3.2.3). With one table alone it is a layer,
/// level or upright, of any shape.
struct Separable {
    enum class Integral {
        exact,     ///< of the product: a walk over the tables' values
        published  ///< F(x) F(y) F(z): the product of the three means, times distance. That is no
                   ///< line integral: parts of a segment do not add up
    };
    double extinction = 0;  ///< 1/m
    std::array<AxisTable, 3> axes;
    Integral integral = Integral::exact;
};

struct FogModel
    : std::variant<Halfspace, Ramp, ExponentialLayer, Cosines, Polynomials, Potentials, Separable> {
    using variant::variant;
    Channels channels = kAllChannels;
};

/// A data error that names the field, as in the scene file: "waves[1].direction is [0, 0, 0]; ...".
Result<void> validate(const FogModel& model);

/// Extinction at a point, 1/m, before `channels` and any Halfspace::Fraction. The model must pass
/// validate(), here and below.
double extinction(const FogModel& model, const Eigen::Vector3d& point);

/// Integral of extinction from O to P in double, before `channels`: 0 for a zero-length segment,
/// symmetric, additive (but Separable::Integral::published). Of a halfspace with another fraction
/// -log T, up to kSaturated.
double optical_depth(const FogModel& model, const Eigen::Vector3d& o, const Eigen::Vector3d& p);

/// Several fogs add their optical depths.
double optical_depth(const std::vector<FogModel>& models, const Eigen::Vector3d& o,
                     const Eigen::Vector3d& p);

}  // namespace wavefog
