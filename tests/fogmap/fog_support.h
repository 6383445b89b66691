// Random fogs, all height profiles, and an integrator that knows nothing of cells.
#pragma once

#include <doctest/doctest.h>

#include <Eigen/Core>
#include <cmath>
#include <utility>
#include <vector>

#include "support/maps.h"
#include "support/random.h"
#include "wavefog/fogmap/fog.h"

namespace wavefog::test {

inline const std::vector<Profile>& all_profiles() {
    static const std::vector<Profile> profiles = {
        {.kind = Profile::Kind::uniform},
        {.kind = Profile::Kind::slab, .bottom = -1, .top = 6},
        {.kind = Profile::Kind::exponential, .base = 1, .scale = 4},
        {.kind = Profile::Kind::linear, .top = 9, .base = -2},
    };
    return profiles;
}

inline Fog fog_of(const Grid<float>& map, const FogOptions& options) {
    auto fog = make_fog(map, options);
    REQUIRE_MESSAGE(fog.has_value(), (fog ? "" : fog.error().message));
    return std::move(*fog);
}

/// 48 m x 36 m around the origin. With values in [0.25, 1] no step is negative at mu = 1, so that
/// the clamp has nothing to do.
inline Fog random_fog(int width, int height, const FogOptions& options, Random& random) {
    Fog fog =
        fog_of(0.25f + 0.75f * make_map<float>(MapKind::random, width, height, random), options);
    fog.rect = {-20, -12, 28, 24};
    fog.extinction = 0.05;
    return fog;
}

/// A point in a box somewhat larger than random_fog's.
inline Eigen::Vector3d random_point(Random& random) {
    const double x = random.uniform(-30, 40), y = random.uniform(-6, 14);
    return {x, y, random.uniform(-25, 35)};
}

/// Adaptive Simpson with Richardson's correction of f over [begin, end], from `pieces` equal parts
/// so that no narrow feature is missed. A jump ends in a part too short to matter (depth 45).
template <class Function>
class AdaptiveSimpson {
  public:
    explicit AdaptiveSimpson(Function f) : f_(std::move(f)) {}

    double integral(double begin, double end, int pieces, double tolerance) const {
        double sum = 0;
        for (int k = 0; k < pieces; ++k) {
            const double a = begin + (end - begin) * k / pieces;
            const double b = begin + (end - begin) * (k + 1) / pieces;
            const double m = (a + b) / 2, fa = f_(a), fm = f_(m), fb = f_(b);
            sum += refine(a, fa, b, fb, m, fm, (b - a) / 6 * (fa + 4 * fm + fb), tolerance / pieces,
                          45);
        }
        return sum;
    }

  private:
    double refine(double a, double fa, double b, double fb, double m, double fm, double whole,
                  double tolerance, int depth) const {
        const double l = (a + m) / 2, r = (m + b) / 2, fl = f_(l), fr = f_(r);
        const double left = (m - a) / 6 * (fa + 4 * fl + fm),
                     right = (b - m) / 6 * (fm + 4 * fr + fb);
        const double error = left + right - whole;
        if (depth <= 0 || std::abs(error) <= 15 * tolerance) return left + right + error / 15;
        return refine(a, fa, m, fm, l, fl, left, tolerance / 2, depth - 1) +
               refine(m, fm, b, fb, r, fr, right, tolerance / 2, depth - 1);
    }

    Function f_;
};

}  // namespace wavefog::test
