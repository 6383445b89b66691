// Fogs without their finest levels against the same function left by mu = 0.
#include <cmath>

#include "fogmap/fog_support.h"
#include "wavefog/fogmap/coarsen.h"
#include "wavefog/fogmap/reference.h"

namespace wavefog::test {

TEST_CASE("a fog without its finest levels is what mu = 0 leaves of them") {
    Random random(81);
    double worst = 0;
    int unclamped = 0;
    for (int degree = 0; degree <= 3; ++degree)
        for (const Boundary boundary : {Boundary::zero, Boundary::repeat})
            for (int dropped = 1; dropped <= 3; ++dropped) {
                CAPTURE(degree);
                CAPTURE(dropped);
                // As many levels as are dropped: mu = 0 leaves the same approximation.
                Fog whole = random_fog(
                    32, 24, {.degree = degree, .levels = dropped, .boundary = boundary}, random);
                const auto coarse = without_finest(whole, dropped);
                REQUIRE(coarse.has_value());
                CHECK(coarse->decomposition.levels() == 0);
                CHECK(coarse->decomposition.width < 32);
                // Coefficients below 0 became 0: a function of them changes by no more than they.
                const double negative = -std::min(
                    0.0f, approximations(whole.decomposition).levels[0].values.minCoeff());
                unclamped += negative == 0;
                const Reference all(whole), kept(*coarse);
                for (int ray = 0; ray < 40; ++ray) {
                    const auto inside = [&] {
                        const double x = random.uniform(-12, 20), y = random.uniform(-3, 3);
                        return Eigen::Vector3d(x, y, random.uniform(-4, 16));
                    };
                    const Eigen::Vector3d o = inside(), p = inside();
                    const double truth = all.optical_depth(o, p, 0, false);
                    const double error = std::abs(kept.optical_depth(o, p, 1, false) - truth);
                    if (negative == 0) worst = std::max(worst, error);
                    const double clamped = negative * whole.extinction * (p - o).norm();
                    CHECK(error < clamped + 2e-6 * (1 + truth));  // 2e-6: the pyramid's float32
                }
            }
    MESSAGE("worst error where nothing was clamped, " << unclamped << " of 24: " << worst);
    CHECK(unclamped >= 12);
}

TEST_CASE("dropping nothing changes nothing, dropping too much is refused") {
    Random random(82);
    const Fog fog = random_fog(20, 12, {.degree = 1, .levels = 2}, random);
    const auto same = without_finest(fog, 0);
    REQUIRE(same.has_value());
    CHECK(same->rect == fog.rect);
    CHECK((reconstruct(same->decomposition) == reconstruct(fog.decomposition)).all());
    const auto refused = without_finest(fog, 3);
    REQUIRE(!refused.has_value());
    CHECK(refused.error().kind == ErrorKind::usage);
    CHECK(!without_finest(fog, -1).has_value());
}

TEST_CASE("another degree reads the same pixels") {
    Random random(83);
    const Fog fog = random_fog(20, 12, {.degree = 2, .levels = 2}, random);
    const auto flat = decomposed_as(fog, 0, 1);
    REQUIRE(flat.has_value());
    CHECK(flat->degree() == 0);
    CHECK(flat->decomposition.levels() == 1);
    CHECK(flat->rect == fog.rect);
    CHECK(flat->extinction == fog.extinction);
    CHECK((reconstruct(flat->decomposition) - reconstruct(fog.decomposition)).abs().maxCoeff() <
          1e-5f);
}

}  // namespace wavefog::test
