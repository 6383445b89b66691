#include "wavefog/fogmap/reference.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "support/maps.h"
#include "support/random.h"

namespace wavefog::test {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

const std::vector<Profile>& profiles() {
    static const std::vector<Profile> all = {
        {.kind = Profile::Kind::uniform},
        {.kind = Profile::Kind::slab, .bottom = -1, .top = 6},
        {.kind = Profile::Kind::exponential, .base = 1, .scale = 4},
        {.kind = Profile::Kind::linear, .top = 9, .base = -2},
    };
    return all;
}

/// Values in [0.25, 1]: no step is negative, so that the clamp has nothing to do.
Fog make_random_fog(int degree, int width, int height, Boundary boundary, Random& random,
                    int levels = 2, Form form = Form::wavelet) {
    Grid<float> map = 0.25f + 0.75f * make_map<float>(MapKind::random, width, height, random);
    FogOptions options;
    options.degree = degree;
    options.levels = levels;
    options.form = form;
    options.boundary = boundary;
    auto fog = make_fog(map, options);
    REQUIRE_MESSAGE(fog.has_value(), (fog ? "" : fog.error().message));
    fog->rect = {-20, -12, 28, 24};
    fog->extinction = 0.05;
    return *fog;
}

// --- Independent truth: adaptive Simpson on extinction(point), which knows nothing of cells except
// that a discontinuity ends in a piece too short to matter.

struct Adaptive {
    const Reference& reference;
    Vector3d o, p;
    double f(double t) const { return reference.extinction(o + t * (p - o)); }

    double refine(double a, double fa, double b, double fb, double m, double fm, double whole,
                  double tolerance, int depth) const {
        const double l = (a + m) / 2, r = (m + b) / 2, fl = f(l), fr = f(r);
        const double left = (m - a) / 6 * (fa + 4 * fl + fm),
                     right = (b - m) / 6 * (fm + 4 * fr + fb);
        const double error = left + right - whole;
        if (depth <= 0 || std::abs(error) <= 15 * tolerance) return left + right + error / 15;
        return refine(a, fa, m, fm, l, fl, left, tolerance / 2, depth - 1) +
               refine(m, fm, b, fb, r, fr, right, tolerance / 2, depth - 1);
    }
    /// Starts from `pieces` equal parts so that no narrow feature is missed.
    double integral(int pieces, double tolerance) const {
        double sum = 0;
        for (int k = 0; k < pieces; ++k) {
            const double a = double(k) / pieces, b = double(k + 1) / pieces, m = (a + b) / 2;
            const double fa = f(a), fb = f(b), fm = f(m);
            sum += refine(a, fa, b, fb, m, fm, (b - a) / 6 * (fa + 4 * fm + fb), tolerance / pieces,
                          40);
        }
        return sum * (p - o).norm();
    }
};

}  // namespace

TEST_CASE("optical depth equals adaptive quadrature of the density") {
    Random random(11);
    double worst = 0;
    for (int degree = 0; degree <= 3; ++degree)
        for (const Boundary boundary : {Boundary::zero, Boundary::repeat})
            for (const Profile& profile : profiles()) {
                Fog fog = make_random_fog(degree, 12, 8, boundary, random);
                fog.profile = profile;
                const Reference reference(fog);
                for (int ray = 0; ray < 12; ++ray) {
                    const auto point = [&] {
                        return Vector3d(random.uniform(-30, 40), random.uniform(-6, 14),
                                        random.uniform(-25, 35));
                    };
                    const Vector3d o = point(), p = point();
                    const double truth = Adaptive{reference, o, p}.integral(64, 1e-13);
                    worst = std::max(worst, std::abs(reference.optical_depth(o, p) - truth));
                }
            }
    MESSAGE("worst error " << worst);
    // Adaptive Simpson is asked for 1e-13 of a path of up to 100 m.
    CHECK(worst < 1e-10);
}

}  // namespace wavefog::test
