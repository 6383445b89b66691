// The certified bound of method march: no ray's error is above it, and it falls as samples grow.
#include "wavefog/gpu/march_bound.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "fogmap/fog_support.h"
#include "wavefog/fogmap/reference.h"
#include "wavefog/gpu/fog_pass.h"

using namespace wavefog;
using namespace wavefog::test;

TEST_CASE("march bound: above every error of random and adversarial maps") {
    Random random(233);
    double closest = 0;
    for (const MapKind kind : {MapKind::random, MapKind::impulse, MapKind::checkerboard,
                               MapKind::smooth, MapKind::hard_edged})
        for (int degree = 0; degree <= 2; ++degree)
            for (const Boundary boundary : {Boundary::zero, Boundary::repeat}) {
                const auto map = make_map<float>(kind, 24, 16, random);
                Fog fog = fog_of(map, {.degree = degree, .levels = 2, .boundary = boundary});
                fog.rect = {-20, -12, 28, 20};
                fog.extinction = 0.08;
                for (const Profile& profile : all_profiles()) {
                    fog.profile = profile;
                    const MarchBound bound(fog);
                    const Reference reference(fog);
                    double before = INFINITY;
                    for (const int samples : {4, 16, 64, 256}) {
                        auto shader = ShaderOnCpu::create(
                            fog, {.kind = MethodKind::march, .samples = samples});
                        REQUIRE(shader.has_value());
                        for (int i = 0; i < 40; ++i) {
                            const auto point = [&] {
                                return Eigen::Vector3d(random.uniform(-30, 40),
                                                       random.uniform(-4, 12),
                                                       random.uniform(-20, 30));
                            };
                            const Eigen::Vector3d eye = point();
                            Eigen::Vector3d end = point();
                            // Along a line between cells, where Haar jumps all the way.
                            if (i % 4 == 0) end.z() = eye.z() + 1e-3 * (end.x() - eye.x());
                            const double off = std::abs(shader->optical_depth(eye, end) -
                                                        reference.optical_depth(eye, end));
                            const double most = bound.optical_depth(samples, (end - eye).norm(),
                                                                    std::abs(end.y() - eye.y()));
                            CAPTURE(map_name(kind));
                            CAPTURE(degree);
                            CAPTURE(static_cast<int>(boundary));
                            CAPTURE(static_cast<int>(profile.kind));
                            CAPTURE(samples);
                            // float32: 4 units in the last place of a place times the densest fog.
                            CHECK_LE(off, most + 1e-5);
                            closest = std::max(closest, off / (most + 1e-5));
                        }
                        const double whole = bound.optical_depth(samples, 60, 10);
                        CHECK_LE(whole, before);
                        before = whole;
                    }
                }
            }
    MESSAGE("the largest error is " << closest << " of its bound");
    // It is not slack everywhere.
    CHECK_GE(closest, 0.1);
}

TEST_CASE("march bound: none in a constant map's middle but what reading it may err") {
    Fog fog = fog_of(Grid<float>::Zero(8, 8), {.degree = 1, .levels = 1});
    CHECK(MarchBound(fog).optical_depth(16, 100, 5) == 0);
    fog = fog_of(Grid<float>::Ones(8, 8), {.degree = 1, .levels = 1, .boundary = Boundary::repeat});
    CHECK(MarchBound(fog).optical_depth(16, 100, 5) == 0);
}
