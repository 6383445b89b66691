// The rule of mu (paper 004, eq. 12) against a band-by-band sum of wavelets.
#include <algorithm>
#include <cmath>
#include <limits>

#include "fogmap/fog_support.h"
#include "wavefog/fogmap/reference.h"
#include "wavefog/wavelet/bspline.h"
#include "wavefog/wavelet/filters.h"

namespace wavefog::test {
namespace {

using Eigen::Vector3d;

/// Values of phi and psi by their definitions, and the sum of whole bands from them: no pyramid, no
/// level ranges.
class BandSum {
  public:
    explicit BandSum(const Fog& fog) : fog_(fog) {
        const auto bank = filters(fog.decomposition.family);
        REQUIRE(bank.has_value());
        q_ = bank->q;
    }

    double psi(double x) const {
        double sum = 0;
        for (std::size_t n = 0; n < q_.values.size(); ++n)
            sum += q_.values[n] * bspline(fog_.degree(), 2 * x - (q_.start + static_cast<int>(n)));
        return sum;
    }
    double phi(double x) const { return bspline(fog_.degree(), x); }

    /// Density of the approximation (level 0) or of the details of one level at causal (u, v).
    double level(int l, double u, double v) const {
        const Decomposition<float>& d = fog_.decomposition;
        const double extent_x = d.width + d.degree(), extent_z = d.height + d.degree();
        if (u < 0 || v < 0 || u >= extent_x || v >= extent_z) return 0;
        const double scale = std::ldexp(1.0, std::max(l, 1) - 1 - d.levels());
        const double x = u * scale, z = v * scale;
        const auto f = [&](double t) { return phi(t); };
        const auto g = [&](double t) { return psi(t); };
        if (l == 0) return band(d.approximation, x, z, f, f);
        const Detail<float>& detail = d.details[static_cast<std::size_t>(l - 1)];
        return band(detail.phi_psi, x, z, f, g) + band(detail.psi_phi, x, z, g, f) +
               band(detail.psi_psi, x, z, g, g);
    }

    /// tau of eq. 12: the approximation all the way, level l up to t = mu^l.
    double optical_depth(const Vector3d& o, const Vector3d& p, double mu) const {
        const Vector3d along = p - o;
        double sum = 0;
        for (int l = 0; l <= fog_.decomposition.levels(); ++l) {
            const double end = l == 0 ? 1 : std::pow(mu, l);
            const auto density = [&](double t) {
                const Vector3d at = o + t * along;
                const double u = (at.x() - fog_.rect.x0) / fog_.cell_x() + fog_.degree() / 2.0;
                const double v = (at.z() - fog_.rect.z0) / fog_.cell_z() + fog_.degree() / 2.0;
                return level(l, u, v) * fog_.profile(at.y());
            };
            if (end > 0) sum += AdaptiveSimpson(density).integral(0, end, 48, 1e-11);
        }
        return sum * fog_.extinction * along.norm();
    }

  private:
    template <class F, class G>
    double band(const Band<float>& band, double x, double z, F along_x, G along_z) const {
        double sum = 0;
        for (int j = 0; j < band.height(); ++j) {
            const double weight = along_z(z - (band.start_z + j));
            if (weight == 0) continue;
            for (int i = 0; i < band.width(); ++i)
                sum += weight * along_x(x - (band.start_x + i)) *
                       static_cast<double>(band.values(j, i));
        }
        return sum;
    }

    const Fog& fog_;
    Taps q_;
};

}  // namespace

TEST_CASE("mu cuts details off as the band-by-band sum does") {
    Random random(21);
    double worst = 0;
    for (int degree = 0; degree <= 2; ++degree) {
        Fog fog = random_fog(11, 7, {.degree = degree, .levels = 3}, random);
        for (const Profile& profile : all_profiles()) {
            fog.profile = profile;
            const Reference reference(fog);
            const BandSum bands(fog);
            for (const double mu : {0.0, 0.3, 0.7, 0.95}) {
                const Vector3d o = random_point(random), p = random_point(random);
                const double truth = bands.optical_depth(o, p, mu);
                const double error = std::abs(reference.optical_depth(o, p, mu, false) - truth);
                worst = std::max(worst, error);
                CAPTURE(degree);
                CAPTURE(mu);
                // Past the map's outermost coefficients the bands cancel to 1e-7 of the maximum,
                // their float32 rounding, where the finest map of the pyramid is exactly 0; the rim
                // is a few metres wide and K at most 0.05. Simpson's own error is below 1e-9.
                CHECK(error < 3e-8);
            }
        }
    }
    MESSAGE("worst error " << worst);
}

TEST_CASE("mu at its ends: 1 keeps everything, 0 the approximation alone") {
    Random random(22);
    for (int degree = 0; degree <= 3; ++degree) {
        // Repeated: with a zero border the coarse functions reach beyond the finest map's
        // coefficients.
        const Fog fog = random_fog(
            16, 8, {.degree = degree, .levels = 3, .boundary = Boundary::repeat}, random);
        Fog coarse = fog;
        for (Detail<float>& detail : coarse.decomposition.details)
            for (Band<float>* band : {&detail.phi_psi, &detail.psi_phi, &detail.psi_psi})
                band->values.setZero();
        const Reference all(fog), approximation(coarse);
        for (int ray = 0; ray < 30; ++ray) {
            const Vector3d o = random_point(random), p = random_point(random);
            const double full = all.optical_depth(o, p, 1, false);
            // mu = 1 - 1e-12 moves the cuts by 1e-12 of the ray.
            CHECK(all.optical_depth(o, p, 1 - 1e-12, false) ==
                  doctest::Approx(full).epsilon(1e-10));
            // The approximation alone, seen through fine cells or through coarse ones: the same
            // function, rounded differently.
            const double none = approximation.optical_depth(o, p, 1, false);
            CHECK(std::abs(all.optical_depth(o, p, 0, false) - none) <
                  1e-12 * (1 + std::abs(none)));
            CHECK(std::abs(all.optical_depth(o, p, 1e-300, false) - none) <
                  1e-12 * (1 + std::abs(none)));
        }
    }
}

TEST_CASE("details end at the same distance from the first point, whichever way the map lies") {
    // Level l counts up to |OP| mu^l: moving P farther along the ray moves the cuts with it.
    Random random(23);
    const Fog fog =
        random_fog(16, 12, {.degree = 1, .levels = 1, .boundary = Boundary::repeat}, random);
    Fog coarse = fog;
    coarse.decomposition.details[0].phi_psi.values.setZero();
    coarse.decomposition.details[0].psi_phi.values.setZero();
    coarse.decomposition.details[0].psi_psi.values.setZero();
    const Reference all(fog), approximation(coarse);
    for (int ray = 0; ray < 30; ++ray) {
        const Vector3d o = random_point(random), p = random_point(random);
        const double mu = random.uniform(0.05, 0.95);
        const Vector3d cut = o + mu * (p - o);
        const double expected =
            all.optical_depth(o, cut, 1, false) + approximation.optical_depth(cut, p, 1, false);
        CHECK(std::abs(all.optical_depth(o, p, mu, false) - expected) < 1e-12);
    }
}

TEST_CASE("the clamp keeps steps from going negative and changes nothing at mu = 1") {
    Random random(24);
    double lowest = 0;
    for (int degree = 0; degree <= 2; ++degree) {
        const Grid<float> map = make_map<float>(MapKind::hard_edged, 32, 32, random);
        Fog fog = fog_of(map, {.degree = degree, .levels = 3});
        fog.rect = {0, 0, 32, 32};
        const Reference reference(fog);
        for (int ray = 0; ray < 300; ++ray) {
            const Vector3d o(random.uniform(-4, 36), 0, random.uniform(-4, 36));
            const Vector3d p = o + Vector3d(random.uniform(-9, 9), 0, random.uniform(-9, 9));
            for (const double mu : {0.0, 0.5, 0.9}) {
                const double clamped = reference.optical_depth(o, p, mu, true);
                const double plain = reference.optical_depth(o, p, mu, false);
                lowest = std::min(lowest, plain);
                CHECK(clamped >= 0);
                CHECK(clamped >= plain - 1e-12);
            }
            // Where the map is 0, float32 coefficients leave +-2e-7 of the maximum (stability.md 8,
            // row 14), which the clamp may cut, over at most 13 m.
            CHECK(std::abs(reference.optical_depth(o, p) -
                           reference.optical_depth(o, p, 1, false)) < 1e-5);
        }
    }
    MESSAGE("lowest optical depth without the clamp " << lowest);
    CHECK(lowest < -0.01);  // else the test shows nothing
}

TEST_CASE("a positive family needs no clamp") {
    Random random(25);
    for (int degree = 0; degree <= 2; ++degree) {
        Fog fog =
            fog_of(make_map<float>(MapKind::hard_edged, 32, 32, random),
                   {.degree = degree, .family = "positive", .form = Form::scaling, .levels = 3});
        fog.rect = {0, 0, 32, 32};
        const Reference reference(fog);
        for (int ray = 0; ray < 200; ++ray) {
            const Vector3d o(random.uniform(-4, 36), 0, random.uniform(-4, 36));
            const Vector3d p(random.uniform(-4, 36), 0, random.uniform(-4, 36));
            const double plain = reference.optical_depth(o, p, 0.5, false);
            CHECK(plain >= -1e-6 * (p - o).norm());  // float32 residuals
        }
    }
}

}  // namespace wavefog::test
