// Mixing maps in coefficient space is mixing the maps.
#include <doctest/doctest.h>

#include "support/maps.h"
#include "wavefog/wavelet/interpolate.h"

using namespace wavefog;
using namespace wavefog::test;

TEST_CASE("interpolate: coefficients in between are those of the map in between") {
    Random random(401);
    for (const Boundary boundary : {Boundary::zero, Boundary::repeat})
        for (const Form form : {Form::wavelet, Form::scaling})
            for (const int degree : {0, 1, 2}) {
                const auto a = make_map<float>(MapKind::random, 40, 24, random);
                const auto b = make_map<float>(MapKind::hard_edged, 40, 24, random);
                const Family family = default_family(degree, form);
                const auto of = [&](const Grid<float>& map) {
                    return *decompose(map, family, 3, form, boundary);
                };
                Decomposition<float> mixed;
                for (const double share : {0.0, 0.25, 0.7, 1.0}) {
                    REQUIRE(interpolate(of(a), of(b), share, mixed).has_value());
                    const auto weight = static_cast<float>(share);
                    const Grid<float> map = (1 - weight) * a + weight * b;
                    const auto difference = [](const Band<float>& p, const Band<float>& q) {
                        REQUIRE(p.start_x == q.start_x);
                        REQUIRE(p.values.size() == q.values.size());
                        return p.values.size() == 0 ? 0 : (p.values - q.values).abs().maxCoeff();
                    };
                    const auto direct = of(map);
                    // Maps are at most 1, coefficients at most a few; both sides round a few times.
                    constexpr double kRounding = 64 * 0x1p-24;
                    CHECK_LE(difference(mixed.approximation, direct.approximation), kRounding);
                    for (std::size_t l = 0; l < direct.details.size(); ++l) {
                        CHECK_LE(difference(mixed.details[l].psi_psi, direct.details[l].psi_psi),
                                 kRounding);
                        CHECK_LE(difference(mixed.details[l].residual, direct.details[l].residual),
                                 kRounding);
                    }
                    CHECK_LE((reconstruct(mixed) - map).abs().maxCoeff(), kRounding);
                    if (share == 0 || share == 1) {
                        const Grid<float> end = reconstruct(of(share == 0 ? a : b));
                        CHECK((reconstruct(mixed) == end).all());
                    }
                }
            }
}

TEST_CASE("interpolate: maps decomposed in different ways do not mix") {
    const Grid<float> small = Grid<float>::Ones(8, 8), wide = Grid<float>::Ones(8, 9);
    const Family family = default_family(1, Form::wavelet);
    Decomposition<float> out;
    const auto a = *decompose(small, family, 2), b = *decompose(wide, family, 2);
    const auto c = *decompose(small, family, 1);
    CHECK(interpolate(a, b, 0.5, out).error().message.find("differ in size") != std::string::npos);
    CHECK(!interpolate(a, c, 0.5, out).has_value());
}
