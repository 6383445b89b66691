// The reference integrator at mu = 1 against independent quadrature and closed forms.
#include "wavefog/fogmap/reference.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "fogmap/fog_support.h"

namespace wavefog::test {
namespace {

using Eigen::Vector3d;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double quadrature(const Reference& reference, const Vector3d& o, const Vector3d& p) {
    const auto density = [&](double t) { return reference.extinction(o + t * (p - o)); };
    return AdaptiveSimpson(density).integral(0, 1, 64, 1e-13) * (p - o).norm();
}

/// Rays that meet knots, vertices and faces in the ways a traversal gets wrong (stability.md 8,
/// rows 1 to 3 and 17). The grid has cells of 4 m x 4.5 m with a line through (-20, -12) at even
/// degrees.
std::vector<std::pair<Vector3d, Vector3d>> special_rays(const Fog& fog) {
    const double cx = fog.cell_x(), cz = fog.cell_z();
    const double x = fog.rect.x0 - cx * fog.degree() / 2, z = fog.rect.z0 - cz * fog.degree() / 2;
    const auto knot = [&](double i, double y, double j) {
        return Vector3d(x + i * cx, y, z + j * cz);
    };
    return {
        {knot(-2, 2, 3), knot(20, 2, 3)},                // along a grid line in x
        {knot(4, 2, -3), knot(4, 2, 15)},                // and in z
        {knot(-2, 2, 3.3), knot(20, 2, 3.3)},            // axis-parallel between lines
        {knot(4.7, 8, 15), knot(4.7, -3, -2)},           // axis-parallel in plan, falling
        {knot(-1, 3, -1), knot(9, 3, 9)},                // diagonal through vertices
        {knot(9, -2, 0), knot(0, 8, 9)},                 // anti-diagonal through vertices, rising
        {knot(3, 2, 3), knot(6, 2, 5)},                  // between two vertices
        {knot(3, -4, 3), knot(3, 12, 3)},                // vertical on a vertex
        {knot(3.4, 12, 3.8), knot(3.4, -4, 3.8)},        // vertical in a cell, downwards
        {knot(-3, 2, 0), knot(20, 2, 0)},                // on the box's near face
        {knot(-3, 2, 1e-6), knot(20, 2, -1e-6)},         // grazing it
        {knot(-3, 2, 3 - 1e-7), knot(20, 2, 3 + 1e-7)},  // grazing a grid line
        {knot(3.5, 1, 3.5), knot(3.5 + 1e-9, 1, 3.5)},   // shorter than anything
        {knot(3.2, 1, 3.2), knot(7.9, 1, 6.6)},          // at the profile's base all along
        {knot(-5, 6, 2.5), knot(17, 6, 3.5)},            // at the slab's top all along
    };
}

std::string describe(int degree, Boundary boundary, const Profile& profile) {
    return "degree " + std::to_string(degree) + (boundary == Boundary::zero ? " zero" : " repeat") +
           " profile " + std::to_string(static_cast<int>(profile.kind));
}

template <class Function>
void for_each_fog(Random& random, int max_degree, Function function) {
    for (int degree = 0; degree <= max_degree; ++degree)
        for (const Boundary boundary : {Boundary::zero, Boundary::repeat})
            for (const Profile& profile : all_profiles()) {
                const Form form = degree % 2 ? Form::scaling : Form::wavelet;
                Fog fog = random_fog(
                    12, 8, {.degree = degree, .form = form, .levels = 2, .boundary = boundary},
                    random);
                fog.profile = profile;
                INFO(describe(degree, boundary, profile));
                function(fog);
            }
}

}  // namespace

TEST_CASE("optical depth equals adaptive quadrature of the density on random rays") {
    Random random(11);
    double worst = 0;
    for_each_fog(random, 5, [&](const Fog& fog) {
        const Reference reference(fog);
        for (int ray = 0; ray < 12; ++ray) {
            const Vector3d o = random_point(random), p = random_point(random);
            const double error =
                std::abs(reference.optical_depth(o, p) - quadrature(reference, o, p));
            worst = std::max(worst, error);
            // Simpson is asked for 1e-13 of a path below 100 m; its Richardson step is good to
            // 1e-11.
            CHECK(error < 1e-10);
        }
    });
    MESSAGE("worst error " << worst);
}

TEST_CASE("optical depth equals adaptive quadrature on rays along lines, vertices and faces") {
    Random random(12);
    double worst = 0;
    for_each_fog(random, 4, [&](const Fog& fog) {
        const Reference reference(fog);
        for (const auto& [o, p] : special_rays(fog)) {
            const double error =
                std::abs(reference.optical_depth(o, p) - quadrature(reference, o, p));
            CAPTURE(o.transpose());
            CAPTURE(p.transpose());
            worst = std::max(worst, error);
            // As above. A Haar map jumps where a grazing ray crosses its line, and an ulp of z,
            // 2e-15 m, moves that point by 2e-15 / 9e-6 of a 92 m ray with K up to 0.05.
            CHECK(error < (fog.degree() == 0 ? 5e-9 : 1e-10));
        }
    });
    MESSAGE("worst error " << worst);
}

TEST_CASE("optical depth is symmetric, additive, and 0 for no length or a miss") {
    Random random(13);
    for_each_fog(random, 3, [&](const Fog& fog) {
        const Reference reference(fog);
        for (int ray = 0; ray < 20; ++ray) {
            const Vector3d a = random_point(random), b = random_point(random);
            const double whole = reference.optical_depth(a, b);
            // 1e-12: 100 cells times an ulp of coordinates up to 10 cells, on tau below 5.
            CHECK(reference.optical_depth(b, a) == doctest::Approx(whole).epsilon(1e-12));
            const Vector3d m = a + random.uniform() * (b - a);
            CHECK(std::abs(reference.optical_depth(a, m) + reference.optical_depth(m, b) - whole) <
                  1e-12);
            CHECK(reference.optical_depth(a, a) == 0);
        }
        if (fog.decomposition.boundary == Boundary::zero) {
            CHECK(reference.optical_depth({-100, 0, 100}, {100, 0, 100}) == 0);
            CHECK(reference.optical_depth({100, 0, 0}, {100, 50, 0}) == 0);
        }
    });
}

TEST_CASE("a constant map gives the homogeneous closed form") {
    for (int degree = 0; degree <= 4; ++degree) {
        Fog fog = fog_of(Grid<float>::Constant(8, 8, 0.5f),
                         {.degree = degree, .boundary = Boundary::repeat});
        fog.rect = {0, 0, 16, 16};
        fog.extinction = 0.2;
        const double k = 0.5 * 0.2;
        const auto depth = [&](Profile profile, double y0, double y1, double run) {
            fog.profile = profile;
            return Reference(fog).optical_depth({3, y0, 5}, {3 + run, y1, 5 + run / 3});
        };
        const auto length = [](double y0, double y1, double run) {
            return std::hypot(run, run / 3, y1 - y0);
        };
        // 1e-13 relative: the sum of up to 200 positive pieces, each good to 1e-15.
        const auto near = [](double value) {
            return doctest::Approx(value).epsilon(1e-13).scale(0);
        };
        for (const double run : {0.0, 1.0, 7.3, 200.0}) {
            CAPTURE(degree);
            CAPTURE(run);
            CHECK(depth({}, -3, 20, run) == near(k * length(-3, 20, run)));

            const Profile slab{.kind = Profile::Kind::slab, .bottom = 1, .top = 4};
            CHECK(depth(slab, -3, 20, run) == near(k * length(-3, 20, run) * 3 / 23));
            CHECK(depth(slab, 2, 3, run) == near(k * length(2, 3, run)));

            const Profile linear{.kind = Profile::Kind::linear, .top = 11, .base = 1};
            CHECK(depth(linear, -3, 20, run) ==
                  near(k * length(-3, 20, run) * (4 + 10 / 2.0) / 23));

            for (const double scale : {0.01, 0.3, 1.0, 8.0, 300.0, 1e7}) {
                CAPTURE(scale);
                const Profile fade{.kind = Profile::Kind::exponential, .base = 1, .scale = scale};
                const auto mean = [&](double y0,
                                      double y1) {  // of exp(-(y - 1) / scale), above base
                    return std::exp(-(y0 - 1) / scale) * -std::expm1(-(y1 - y0) / scale) * scale /
                           (y1 - y0);
                };
                CHECK(depth(fade, 1.5, 31.5, run) ==
                      near(k * length(1.5, 31.5, run) * mean(1.5, 31.5)));
                CHECK(depth(fade, 9, 2, run) == near(k * length(9, 2, run) * mean(2, 9)));
                CHECK(depth(fade, -3, 5, run) ==
                      near(k * length(-3, 5, run) * (4 + 4 * mean(1, 5)) / 8));
                if (run > 0)
                    CHECK(depth(fade, 2, 2, run) ==
                          near(k * length(2, 2, run) * std::exp(-1 / scale)));
            }
        }
    }
}

TEST_CASE("a zero border ends half the degree past the rectangle") {
    for (int degree = 0; degree <= 4; ++degree) {
        Fog fog = fog_of(Grid<float>::Constant(9, 9, 1.0f), {.degree = degree, .levels = 3});
        fog.rect = {0, 0, 9, 9};
        const Reference reference(fog);
        // Through the middle, where z sees the full sum: the integral over u of sum phi(u - i)
        // is 9. 1e-6: the details' float32 coefficients.
        CHECK(reference.optical_depth({-20, 0, 4.5}, {30, 0, 4.5}) ==
              doctest::Approx(9).epsilon(1e-6));
        CHECK(reference.extinction({-0.5 * degree - 1e-9, 0, 4.5}) == 0);
        CHECK(reference.far_end({4.5, 0, 4.5}, {1, 0, 0}, 1e9) ==
              doctest::Approx(4.5 + 0.5 * degree));
    }
}

TEST_CASE("a vertical ray sees the density of its point times the profile's integral") {
    Random random(14);
    for (int degree = 0; degree <= 3; ++degree) {
        Fog fog = random_fog(12, 8, {.degree = degree}, random);
        for (const Profile& profile : all_profiles()) {
            fog.profile = profile;
            const Reference reference(fog);
            const double x = random.uniform(-20, 28), z = random.uniform(-12, 24);
            const double ground = reference.extinction({x, 0.5, z}) / profile(0.5);
            double integral = 0;  // of h from -4 to 12
            switch (profile.kind) {
                case Profile::Kind::uniform:
                    integral = 16;
                    break;
                case Profile::Kind::slab:
                    integral = 7;
                    break;
                case Profile::Kind::exponential:
                    integral = 5 - 4 * std::expm1(-11 / 4.0);
                    break;
                case Profile::Kind::linear:
                    integral = 2 + 11 / 2.0;
                    break;
            }
            CHECK(reference.optical_depth({x, -4, z}, {x, 12, z}) ==
                  doctest::Approx(ground * integral).epsilon(1e-13));
            // A direction cosine of 1e-12 is the same ray to 1e-11 m.
            CHECK(reference.optical_depth({x, -4, z}, {x + 1.6e-11, 12, z}) ==
                  doctest::Approx(ground * integral).epsilon(1e-9));
        }
    }
}

TEST_CASE("the exponential profile tends to its limits without overflow") {
    Random random(15);
    Fog fog = random_fog(12, 8, {.degree = 2}, random);
    const Vector3d a(-15, 3, -5), b(20, 9, 15);
    const double uniform = Reference(fog).optical_depth(a, b);
    const auto with = [&](double base, double scale) {
        fog.profile = {.kind = Profile::Kind::exponential, .base = base, .scale = scale};
        return Reference(fog);
    };
    CHECK(with(0, 1e12).optical_depth(a, b) == doctest::Approx(uniform).epsilon(1e-11));
    CHECK(with(1e6, 1).optical_depth(a, b) == doctest::Approx(uniform).epsilon(1e-13));
    CHECK(with(-1e6, 1).optical_depth(a, b) == 0);  // underflows to nothing
    // The eye deep below the base, 1e9 scales: all of the fog below, none above.
    const Reference deep = with(0, 1);
    const Vector3d below(0, -1e9, 0), above(0, 1e9, 0);
    CHECK(deep.optical_depth(below, above) ==
          doctest::Approx((1e9 + 1) * deep.extinction({0, -1, 0})).epsilon(1e-13));
    CHECK(deep.optical_depth({0, 1e9, 0}, {1, 1e9, 1}) == 0);
}

TEST_CASE("the world's origin and whole cells do not matter") {
    Random random(16);
    for (int degree = 0; degree <= 3; ++degree) {
        Fog fog = random_fog(12, 8, {.degree = degree}, random);
        fog.profile = {.kind = Profile::Kind::exponential, .base = 1, .scale = 4};
        const Reference here(fog);
        const Vector3d offset(1e6, 0, -1e6);
        Fog moved = fog;
        moved.rect = {fog.rect.x0 + 1e6, fog.rect.z0 - 1e6, fog.rect.x1 + 1e6, fog.rect.z1 - 1e6};
        const Reference there(moved);

        Grid<float> map = 0.25f + 0.75f * make_map<float>(MapKind::random, 12, 8, random);
        Grid<float> rolled(8, 12);
        for (int j = 0; j < 8; ++j)
            for (int i = 0; i < 12; ++i) rolled((j + 3) % 8, (i + 5) % 12) = map(j, i);
        const FogOptions repeat{.degree = degree, .levels = 2, .boundary = Boundary::repeat};
        Fog tiled = fog_of(map, repeat), shifted = fog_of(rolled, repeat);
        tiled.rect = shifted.rect = {0, 0, 12, 8};
        const Reference first(tiled), second(shifted);

        for (int ray = 0; ray < 50; ++ray) {
            const Vector3d o = random_point(random), p = random_point(random);
            // Coordinates near 1e6 m carry 1.2e-10 m: times K <= 0.05 per metre and, for Haar, the
            // number of jumps.
            CHECK(std::abs(there.optical_depth(o + offset, p + offset) - here.optical_depth(o, p)) <
                  1e-9);
            // 2e-6: float32 details of different maps, over up to 100 m at K <= 1.
            const Vector3d cells(5, 0, 3);
            CHECK(std::abs(first.optical_depth(o, p) - second.optical_depth(o + cells, p + cells)) <
                  2e-6 * (p - o).norm());
        }
    }
}

TEST_CASE("an eye 100000 cells away sees what an eye at the edge sees") {
    Random random(17);
    for (int degree = 0; degree <= 3; ++degree) {
        Fog fog = random_fog(64, 64, {.degree = degree}, random);
        const Reference reference(fog);
        for (int ray = 0; ray < 50; ++ray) {
            const Vector3d inside(random.uniform(-15, 20), 0, random.uniform(-10, 20));
            const double angle = random.uniform(0, 6.28);
            const Vector3d direction(std::cos(angle), 0, std::sin(angle));
            const Vector3d near_eye = inside - 100 * direction,
                           far_eye = inside - 75000 * direction;
            // 75 km = 1e5 cells: coordinates carry 1e-11 m.
            CHECK(std::abs(reference.optical_depth(far_eye, inside) -
                           reference.optical_depth(near_eye, inside)) < 1e-9);
        }
    }
}

TEST_CASE("dense fog keeps its optical depth, and bad coordinates give NaN") {
    Random random(18);
    Fog fog = random_fog(16, 16, {.degree = 1}, random);
    const double thin = Reference(fog).optical_depth({-30, 0, 0}, {40, 0, 3});
    fog.extinction *= 1e6;
    const double thick = Reference(fog).optical_depth({-30, 0, 0}, {40, 0, 3});
    CHECK(thick > 1e5);
    CHECK(thick == doctest::Approx(1e6 * thin).epsilon(1e-13));
    fog.extinction = 0;
    CHECK(Reference(fog).optical_depth({-30, 0, 0}, {40, 0, 3}) == 0);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(std::isnan(Reference(fog).optical_depth({nan, 0, 0}, {40, 0, 3})));
    CHECK(std::isnan(Reference(fog).optical_depth({0, 0, 0}, {0, kInfinity, 3})));
}

TEST_CASE("Haar cells are half-open: a ray on a line sees the cell beyond it") {
    Grid<float> map(2, 2);
    map << 1, 2, 3, 4;
    Fog fog = fog_of(map, {.degree = 0, .levels = 0});
    fog.rect = {0, 0, 2, 2};
    const Reference reference(fog);
    CHECK(reference.optical_depth({-1, 0, 1}, {3, 0, 1}) == 7);
    CHECK(reference.optical_depth({1, 0, -1}, {1, 0, 3}) == 6);
    CHECK(reference.optical_depth({-1, 0, 0}, {3, 0, 0}) == 3);
    CHECK(reference.optical_depth({-1, 0, 2}, {3, 0, 2}) == 0);
    // The far edge is outside at every level, though a coarse cell reaches beyond it.
    const Grid<float> odd = Grid<float>::Constant(3, 3, 1.0f);
    Fog coarse = fog_of(odd, {.degree = 0, .levels = 1});
    coarse.rect = {0, 0, 3, 3};
    CHECK(Reference(coarse).optical_depth({-1, 0, 3}, {4, 0, 3}, 0) == 0);
    CHECK(Reference(coarse).optical_depth({-1, 0, 2.5}, {4, 0, 2.5}, 0) > 0);
    // From either side the value lies between the two rows' sums.
    CHECK(reference.optical_depth({-1, 0, 1 - 1e-9}, {3, 0, 1 - 1e-9}) == doctest::Approx(3));
}

TEST_CASE("the far end is where the ray leaves the box and the profile") {
    Random random(19);
    Fog fog = random_fog(12, 8, {.degree = 0}, random);  // box = rectangle = [-20, 28] x [-12, 24]
    const auto end = [&](const Vector3d& o, const Vector3d& d, double limit) {
        return Reference(fog).far_end(o, d.normalized(), limit);
    };
    CHECK(end({0, 0, 0}, {1, 0, 0}, 1e4) == doctest::Approx(28));
    CHECK(end({-100, 0, 0}, {1, 0, 0}, 1e4) == doctest::Approx(128));
    CHECK(end({-100, 0, 0}, {1, 0, 0}, 50) == 0);
    CHECK(end({-100, 0, 0}, {-1, 0, 0}, 1e4) == 0);
    CHECK(end({0, 0, 0}, {0, 1, 0}, 1e4) == 1e4);
    fog.profile = {.kind = Profile::Kind::slab, .bottom = -1, .top = 6};
    CHECK(end({0, 0, 0}, {0, 1, 0}, 1e4) == doctest::Approx(6));
    CHECK(end({0, 8, 0}, {0, 1, 0}, 1e4) == 0);
    CHECK(end({0, 8, 0}, {0, -1, 0}, 1e4) == doctest::Approx(9));
    fog.profile = {.kind = Profile::Kind::linear, .top = 6, .base = -2};
    CHECK(end({0, 0, 0}, {0, 3, 4}, 1e4) == doctest::Approx(10));
    Fog tiled = random_fog(12, 8, {.degree = 0, .boundary = Boundary::repeat}, random);
    CHECK(Reference(tiled).far_end({0, 0, 0}, {1, 0, 0}, 777) == 777);
}

}  // namespace wavefog::test
