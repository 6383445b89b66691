#include "wavefog/gpu/radial_bound.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include "fog_uniforms.h"
#include "radial_around.h"
#include "radial_bound_profile.h"
#include "radial_wedge.h"
#include "wavefog/gpu/pixel_rays.h"

namespace wavefog {
namespace {

// Pieces of the height profile's value where a ray ends.
constexpr int kEnds = 4;

/// A ray's height profile, seen from the eye.
struct Heights {
    Profile::Kind kind = Profile::Kind::uniform;
    double near = 0, far = 0;  ///< from the eye to the nearer and the farther end of the profile's
                               ///< varying part, metres; near is 0 inside
    double eta = 0;            ///< the eye's, in units of that part, from its lower end
};

Heights heights_of(const Profile& profile, double y) {
    Heights heights;
    heights.kind = profile.kind;
    if (profile.kind != Profile::Kind::slab && profile.kind != Profile::Kind::linear)
        return heights;
    const double bottom = profile.kind == Profile::Kind::slab ? profile.bottom : profile.base;
    heights.near = std::max({bottom - y, y - profile.top, 0.0});
    heights.far = std::max(std::abs(bottom - y), std::abs(profile.top - y));
    heights.eta = (y - bottom) / (profile.top - bottom);
    return heights;
}

/// Goes through a table's wedges.
class Search {
  public:
    Search(RadialWedges& wedges, const Heights& heights, const RadialFacts& facts, double stop)
        : wedges_(wedges), heights_(heights), facts_(facts), limits_(facts.limits), stop_(stop) {}

    void add(int wedge);
    double largest() const { return largest_; }

  private:
    /// Metres of a ray a metre on the ground.
    double steepest(double r, double exit) const {
        const double at = std::min(r, exit);
        return std::max(longest(at) / at, 1.0);
    }
    /// Of the rays that end at most that far on the ground.
    double longest(double r) const {
        return std::min({limits_.length, std::hypot(r, limits_.rise), limits_.steepest * r});
    }
    double rounding(double far, double high) const { return radial_rounding(facts_, far, high); }
    void include(double bound) { largest_ = std::max(largest_, bound); }
    void include(double tau, double error, double least, double most, double drawn) {
        include(facts_.depth_only ? most * error : worst_error(tau, error, least, most, drawn));
    }
    bool visit_whole(const RadialStretch& s, double exit);
    bool visit_linear(const RadialStretch& s, double exit);
    void between_slabs();

    RadialWedges& wedges_;
    Heights heights_;
    RadialFacts facts_;
    RayLimits limits_;
    double stop_;
    double largest_ = 0;
    double low_ = 0,
           error_ = 0;   ///< uniform: the least optical depth of the last stretch, its error
    double second_ = 0;  ///< linear: the largest error of A_2 over its distance so far
    std::vector<RadialStretch> stretches_;
};

// Rays that fog fills from the eye on.
bool Search::visit_whole(const RadialStretch& s, double exit) {
    const double round = rounding(wedges_.start() + s.far, s.high);
    const double r = wedges_.start() + s.near;
    if (r == 0) {
        const double most = longest(s.far);
        include(s.density_low, s.relative + round / s.far, 0, most, 0);
        return true;
    }
    const double error = s.angular + s.radial + (facts_.depth_only ? 0 : s.missing) + round;
    low_ = s.low;
    error_ = error;
    include(s.low, error, 1, steepest(r, exit), std::min(s.low, stop_) * 0.999);
    const double least = std::min(s.low, stop_) * 0.999;
    // Behind so much fog neither T is larger.
    if (facts_.depth_only) return s.low <= stop_ + 1;
    if (s.low > stop_ + 1 || std::exp(-least) <= largest_) {
        include(std::exp(-least));
        return false;
    }
    return true;
}

// With the profile's value h at the ray's end and h0 at the eye, the optical depth is h A_1 plus
// (h0 - h) / r A_2 if the eye is not above, and h0 A_1 at least where h0 < h.
bool Search::visit_linear(const RadialStretch& s, double exit) {
    const double eta = heights_.eta, eye = std::clamp(1 - eta, 0.0, 1.0);
    const double round = rounding(wedges_.start() + s.far, s.high);
    const double r = wedges_.start() + s.near;
    const bool at_eye = r == 0;
    const double first = at_eye ? s.relative + round / s.far : s.radial + round;
    const double second = at_eye ? s.relative + round / s.far : s.radial_2 / r + round;
    second_ = std::max(second_, at_eye ? second * s.far : second);
    const double least = at_eye ? 0 : 1;
    const double most = at_eye ? longest(s.far) : steepest(r, exit);
    for (int k = 0; k < kEnds; ++k) {
        const double low = double(k) / kEnds, high = double(k + 1) / kEnds;
        double turns = std::max(std::abs(high - eye), std::abs(low - eye));
        if (eta < 0) turns = 1 - low - 2 * eta;
        if (eta > 1) turns = 2 * (eta - 1) + high;
        const double error = high * first + turns * (at_eye ? second : second_) +
                             (at_eye ? 0 : std::max(eye, high) * s.angular);
        double tau = 0;
        if (eta <= 1 && !at_eye) {
            const double mean = s.low_2 / (wedges_.start() + s.far);
            tau = low < eye ? (eye - low) * mean + low * s.low : eye * s.low;
        }
        include(tau, error, least, most, 0);
    }
    return true;
}

// From above or below, a ray is in the slab from r1 to r2 <= r1 far / near.
void Search::between_slabs() {
    const double start = wedges_.start(), ratio = heights_.far / std::max(heights_.near, 1e-30);
    double most = 0, relative = 0;  // of the stretches that r2 may lie in
    std::size_t reached = 0;
    for (const RadialStretch& one : stretches_) {
        const double near = start + one.near, far = start + one.far;
        if (near > limits_.length) break;
        while (reached < stretches_.size() &&
               (reached == 0 || start + stretches_[reached].near <= ratio * far)) {
            const RadialStretch& two = stretches_[reached++];
            const double round = rounding(start + two.far, two.high);
            const double error = two.angular + two.radial + round;
            most = std::max(most, error);
            const double from = start + two.near;
            relative = std::max(
                relative, std::min(limits_.length, std::hypot(start + two.far, heights_.far)) *
                              (from == 0 ? two.relative + round / two.far : error / from));
        }
        const double round = rounding(far, one.high);
        double error;
        if (near == 0) {
            error = std::hypot(far, heights_.near) * (one.relative + round / far) + relative;
        } else {
            const double steep = std::hypot(1, heights_.near / near);
            error = steep * (one.radial + round + most - one.angular_near);
        }
        include(0, error, 0, 1, 0);
    }
}

void Search::add(int wedge) {
    const bool through = heights_.kind == Profile::Kind::slab && heights_.near > 0;
    bool seen_whole = true;
    stretches_.clear();
    second_ = 0;
    wedges_.walk(wedge, [&](RadialStretch s, double exit) {
        if (facts_.step) s.radial = s.radial_2 = s.relative = 0;
        if (facts_.depth_only) s.angular = s.angular_near = 0;
        if (wedges_.start() + s.near > limits_.length) return seen_whole = false;
        if (through)
            stretches_.push_back(s);
        else if (heights_.kind == Profile::Kind::linear)
            return visit_linear(s, exit);
        else
            return seen_whole = visit_whole(s, exit);
        return true;
    });
    if (through) between_slabs();
    const double rest = limits_.length - wedges_.start() - wedges_.length();
    // Behind a table that ends in repeated fog the shader goes on with its mean.
    if (seen_whole && facts_.repeat && rest > 0) {
        const double end = wedges_.start() + wedges_.length();
        if (heights_.kind == Profile::Kind::uniform)
            include(low_, error_ + facts_.densest * rest, 1, steepest(end, end), 0);
        else
            include(1);
    }
}

/// Of look-ups in tables for each level (0 < mu < 1): |dtau| of what azimuths and left out levels
/// add, each level's between the ends of its part of a ray.
class LayeredSearch {
  public:
    LayeredSearch(std::vector<RadialWedges>& layers, const RayLimits& limits, double mu)
        : layers_(layers), limits_(limits), mu_(mu), sums_(layers.size()) {}

    void add(int wedge) {
        std::vector<double> far;
        for (std::size_t l = 0; l < layers_.size(); ++l) {
            sums_[l] = {0};
            far = {0};
            layers_[l].walk(wedge, [&](const RadialStretch& s, double) {
                sums_[l].push_back(s.angular);
                far.push_back(s.far);
                return true;
            });
        }
        const double start = layers_[0].start();
        for (std::size_t row = 1; row < far.size(); ++row) {
            const double near = start + far[row - 1], r = start + far[row];
            if (near > limits_.length) break;
            double sum = 0;
            for (std::size_t l = 0; l < layers_.size(); ++l) {
                // Distances r mu^l of rays that end in this stretch.
                const double to = r * std::pow(mu_, double(l)) - start;
                const double from =
                    l + 1 < layers_.size() ? near * std::pow(mu_, double(l + 1)) - start : -start;
                const auto before = std::upper_bound(far.begin(), far.end(), from);
                const auto behind = std::lower_bound(far.begin(), far.end(), to);
                const auto at = [&](auto place, int off) {
                    const auto index = std::distance(far.begin(), place) + off;
                    return sums_[l][std::size_t(
                        std::clamp<std::ptrdiff_t>(index, 0, std::ptrdiff_t(far.size()) - 1))];
                };
                if (to > 0) sum += at(behind, 0) - at(before, -1);
            }
            const double longest =
                std::min({limits_.length, std::hypot(r, limits_.rise), limits_.steepest * r});
            largest_ = std::max(largest_, sum * std::max(longest / r, 1.0));
        }
    }
    double largest() const { return largest_; }

  private:
    std::vector<RadialWedges>& layers_;
    RayLimits limits_;
    double mu_, largest_ = 0;
    std::vector<std::vector<double>> sums_;
};

/// Metres of a picture's ray a metre on the ground, at most.
double steepest_of(const CameraMatrices& matrices) {
    const Eigen::Matrix4d from_clip = eye_from_clip(matrices);
    const auto corner = [&](int k) -> Eigen::Vector3d {
        const double x = k == 0 || k == 3 ? -1 : 1, y = k < 2 ? -1 : 1;
        return (from_clip * Eigen::Vector4d(x, y, 1 - matrices.sky_depth, 1)).head<3>();
    };
    double steepest = 1;
    for (int k = 0; k < 4; ++k)
        for (const double up : {1.0, -1.0}) {
            const Eigen::Vector3d a = corner(k % 4), b = corner((k + 1) % 4);
            const double ya = up * a.y(), yb = up * b.y();
            if (std::max(ya, yb) <= 0) continue;
            // Where the side points up, the ray's rise has one maximum.
            double from = ya < 0 ? ya / (ya - yb) : 0, to = yb < 0 ? ya / (ya - yb) : 1;
            const auto at = [&](double t) {
                const Eigen::Vector3d ray = a + t * (b - a);
                return ray.norm() / std::max(std::hypot(ray.x(), ray.z()), 1e-30);
            };
            for (int step = 0; step < 60; ++step) {
                const double t0 = from + (to - from) / 3, t1 = to - (to - from) / 3;
                (at(t0) < at(t1) ? from : to) = at(t0) < at(t1) ? t0 : t1;
            }
            steepest = std::max(steepest, at((from + to) / 2));
        }
    return steepest * (1 + 1e-6);
}

}  // namespace

RadialBound::Impl::Impl(const Fog& the_fog, const DetailBound& of_details,
                        const Pyramid<float>& pyramid)
    : fog(the_fog),
      dropped(of_details),
      facts(fog_facts(fog, build_cell_atlas(pyramid))),
      ranges(pyramid.levels.back(), fog.degree(), fog.decomposition.boundary,
             {fog.cell_x(), fog.cell_z()}, fog.extinction) {}

double RadialBound::Impl::around(const Method& method, const Eigen::Vector3d& eye,
                                 const RadialView& view, double seconds, double limit,
                                 const RayLimits& limits) const {
    if (fog.extinction == 0) return 0;
    const RadialShape shape = radial_shape(facts, method);
    const Eigen::Vector2d cell(fog.cell_x(), fog.cell_z());
    const Eigen::Vector2d moved =
        wind_offset(fog.wind, fog.rect, fog.decomposition.boundary, seconds);
    const Eigen::Vector2d place(
        (eye.x() - fog.rect.x0 - moved.x()) / cell.x() + fog.degree() / 2.0,
        (eye.z() - fog.rect.z0 - moved.y()) / cell.y() + fog.degree() / 2.0);
    const bool uniform = fog.profile.kind == Profile::Kind::uniform;
    const double stops = uniform ? shape.stop() : std::numeric_limits<double>::infinity();
    const shader::RadialBlock block = radial_block(facts, eye, view, seconds, limit, shape);
    std::vector<RadialWedges> layers;
    for (int l = 0; l < shape.layers; ++l)
        layers.emplace_back(ranges, dropped, block, place, l, stops);
    if (!layers[0].narrow()) return 1;

    RadialFacts known;
    known.limits = limits;
    known.start = layers[0].start();
    known.densest = ranges.largest();
    known.cell = cell.minCoeff();
    known.step = shape.step;
    known.repeat = ranges.repeat();
    known.depth_only = shape.layers > 1;
    const int first = view.full ? 0 : layers[0].first();
    const auto of_table = [&](RadialWedges& wedges) {
        if (fog.profile.kind == Profile::Kind::exponential) {
            ProfileSearch search((eye.y() - fog.profile.base) / fog.profile.scale,
                                 fog.profile.scale, known, wedges.count() - first);
            std::vector<RadialStretch> stretches;
            for (int wedge = first; wedge < wedges.count(); ++wedge) {
                stretches.clear();
                wedges.walk(wedge, [&](const RadialStretch& s, double) {
                    stretches.push_back(s);
                    return true;
                });
                search.add(stretches);
            }
            return search.largest();
        }
        Search search(wedges, heights_of(fog.profile, eye.y()), known, shape.stop());
        for (int wedge = first; wedge < wedges.count(); ++wedge) search.add(wedge);
        return search.largest();
    };
    double bound;
    if (known.depth_only) {
        // A level's part of a ray is the difference of two look-ups.
        LayeredSearch search(layers, limits, method.mu);
        for (int wedge = first; wedge < layers[0].count(); ++wedge) search.add(wedge);
        double error = search.largest();
        for (RadialWedges& wedges : layers) error += 2 * of_table(wedges);
        bound = std::max(-std::expm1(-error), std::exp(error - std::max(stops, error)));
    } else {
        bound = of_table(layers[0]);
    }
    return std::min(bound + 0x1p-21, 1.0);
}

RadialBound::RadialBound(const Fog& fog, const DetailBound& dropped)
    : impl_(std::make_unique<const Impl>(fog, dropped, approximations(fog.decomposition))) {}

RadialBound::~RadialBound() = default;

double RadialBound::transmittance(const Method& method, const Camera& camera, int width, int height,
                                  const RayLimits& limits, double seconds) const {
    const CameraMatrices matrices = camera_matrices(camera, width, height);
    const RadialView view = radial_view(matrices, camera, width, height);
    RayLimits seen = limits;
    if (!view.full) seen.steepest = std::min(seen.steepest, steepest_of(matrices));
    return impl_->around(method, camera.eye, view, seconds, sky_limit(camera), seen);
}

}  // namespace wavefog
