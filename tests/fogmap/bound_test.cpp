// The certified bound on dropped details against the reference integrator.
#include <algorithm>
#include <cmath>
#include <string>
#include <tuple>

#include "fogmap/fog_support.h"
#include "wavefog/fogmap/bound.h"
#include "wavefog/fogmap/image.h"
#include "wavefog/fogmap/reference.h"

namespace wavefog::test {
namespace {

using Eigen::Vector3d;

struct Segment {
    Vector3d o, p;
};

double error_of(const Reference& reference, const Segment& s, double mu) {
    return std::abs(reference.optical_depth(s.o, s.p, mu) - reference.optical_depth(s.o, s.p, 1));
}

/// Climbs from a random segment to one with a large error, within `length`.
Segment worst_segment(const Reference& reference, const Rect& rect, double mu, double length,
                      double rise, Random& random) {
    const auto any = [&](double margin) {
        const double x = random.uniform(rect.x0 - margin, rect.x1 + margin);
        const double y = random.uniform(0, rise);
        return Vector3d(x, y, random.uniform(rect.z0 - margin, rect.z1 + margin));
    };
    const auto shorten = [&](Segment s) {
        const Vector3d along = s.p - s.o;
        if (along.norm() > length) s.p = s.o + along * (length / along.norm());
        return s;
    };
    Segment best{};
    double worst = -1;
    for (int k = 0; k < 24; ++k) {
        Segment s{any(3), any(3)};
        if (k % 3 == 1) s.p.z() = s.o.z();  // along the grid: where cells' errors line up
        if (rise > 0 && k % 4 == 1) s.p = s.o + Vector3d(0.1, rise - s.o.y(), 0.05);  // steep
        if (k % 3 == 2) s.p = s.o + (s.p.x() - s.o.x()) * Vector3d(1, 0, k % 2 ? 1 : -1);
        s = shorten(s);
        const double error = error_of(reference, s, mu);
        if (error > worst) best = s, worst = error;
    }
    double step = 4;
    for (int k = 0; k < 60; ++k) {
        const auto nudge = [&] {
            const double x = random.uniform(-step, step);
            return Vector3d(x, 0, random.uniform(-step, step));
        };
        const Segment s = shorten({best.o + nudge(), best.p + nudge()});
        const double error = error_of(reference, s, mu);
        if (error > worst)
            best = s, worst = error;
        else
            step = std::max(step * 0.93, 0.05);
    }
    return best;
}

struct Tightness {
    double worst_share = 0;  ///< of the bound that an error reached
};

void check_bound(const Fog& fog, Random& random, Tightness& tightness) {
    const Reference reference(fog);
    const DetailBound bound(fog);
    REQUIRE(bound.levels() == fog.decomposition.levels());
    for (const double mu : {0.0, 0.4, 0.8, 0.97})
        for (const auto& [length, rise] : {std::pair{6.0, 0.0}, std::pair{30.0, 2.0},
                                           std::pair{90.0, 0.0}, std::pair{20.0, 20.0}}) {
            const Segment s = worst_segment(reference, fog.rect, mu, length, rise, random);
            const double error = error_of(reference, s, mu);
            const double most = bound.optical_depth(mu, length, rise);
            CAPTURE(mu);
            CAPTURE(length);
            CAPTURE(rise);
            // The pyramid's float32 rounding, 2^-22 of the largest density over the path, is not
            // the bound's business.
            CHECK(error <= most + 0x1p-22 * fog.extinction * length);
            const double dT = std::abs(std::exp(-reference.optical_depth(s.o, s.p, mu)) -
                                       std::exp(-reference.optical_depth(s.o, s.p, 1)));
            CHECK(dT <= bound.transmittance(mu, length, rise) + 0x1p-22 * fog.extinction * length);
            if (most > 0) tightness.worst_share = std::max(tightness.worst_share, error / most);
        }
}

}  // namespace

TEST_CASE("dropped details err no more than the certified bound, on every kind of map") {
    Random random(71);
    Tightness tightness;
    for (const MapKind kind : {MapKind::constant, MapKind::smooth, MapKind::random,
                               MapKind::hard_edged, MapKind::impulse, MapKind::checkerboard})
        for (int degree = 0; degree <= 2; ++degree)
            for (const Boundary boundary : {Boundary::zero, Boundary::repeat}) {
                CAPTURE(std::string(map_name(kind)));
                CAPTURE(degree);
                Fog fog = fog_of(make_map<float>(kind, 32, 24, random),
                                 {.degree = degree, .levels = 3, .boundary = boundary});
                fog.rect = {-20, -12, 28, 24};
                fog.extinction = 0.05;
                check_bound(fog, random, tightness);
            }
    MESSAGE("an error reached " << tightness.worst_share << " of its bound");
    CHECK(tightness.worst_share > 0.1);  // else the bound says little
    CHECK(tightness.worst_share <= 1);
}

TEST_CASE("the certified bound holds for all families, profiles and a real map") {
    Random random(72);
    Tightness tightness;
    const auto picture = read_fogmap(WAVEFOG_DATA_DIR "/weather_crop_64.png");
    REQUIRE(picture.has_value());
    for (const auto& [degree, family, form] :
         {std::tuple{1, "2,4", Form::wavelet}, std::tuple{1, "positive", Form::scaling},
          std::tuple{1, "chui-wang", Form::wavelet}, std::tuple{2, "3,5", Form::wavelet}}) {
        for (const Profile& profile : all_profiles()) {
            CAPTURE(std::string(family));
            Fog fog = fog_of(picture->pixels,
                             {.degree = degree, .family = family, .form = form, .levels = 4});
            fog.rect = {-20, -12, 28, 24};
            fog.extinction = 0.08;
            fog.profile = profile;
            check_bound(fog, random, tightness);
        }
    }
    MESSAGE("an error reached " << tightness.worst_share << " of its bound");
}

TEST_CASE("the certified bound is 0 where nothing is dropped and grows with what is") {
    Random random(73);
    const Fog fog = random_fog(40, 30, {.degree = 1, .levels = 3}, random);
    const DetailBound bound(fog);
    CHECK(bound.optical_depth(1, 1e6, 1e6) == 0);
    CHECK(bound.optical_depth(0.5, 0, 9) == 0);
    double before = 0;
    for (const double length : {0.1, 1.0, 5.0, 20.0, 60.0, 200.0}) {
        const double here = bound.optical_depth(0.5, length, 3);
        CHECK(here >= before);
        before = here;
    }
    CHECK(bound.optical_depth(0, 60, 0) >= bound.optical_depth(0.9, 60, 0));
    // No levels, nothing to drop.
    CHECK(
        DetailBound(random_fog(9, 9, {.degree = 2, .levels = 0}, random)).optical_depth(0, 99, 9) ==
        0);
}

}  // namespace wavefog::test
