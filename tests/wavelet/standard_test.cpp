#include "wavefog/wavelet/standard.h"

#include <doctest/doctest.h>

#include "support/maps.h"

using namespace wavefog;
using namespace wavefog::test;

TEST_CASE("Standard decomposition: the inverse restores maps of any size, family and boundary") {
    Random random(61);
    for (int degree = 0; degree <= 4; ++degree)
        for (const Family& family : families(degree)) {
            if (family.kind == Family::Kind::positive) continue;
            CAPTURE(family.name());
            for (const Boundary boundary : {Boundary::zero, Boundary::repeat})
                for (const auto& [width, height] :
                     {std::pair{1, 1}, {1, 9}, {32, 8}, {31, 17}, {48, 5}})
                    for (int levels : {0, 1, 4}) {
                        const auto map = make_map<double>(MapKind::random, width, height, random);
                        const auto dec = decompose_standard(map, family, levels, boundary);
                        REQUIRE(dec.has_value());
                        // Both axes to 4 levels with 4,2: the condition number is 27^2.
                        CHECK((reconstruct_standard(*dec) - map).abs().maxCoeff() <= 1e-12);
                        const auto in_float =
                            decompose_standard<float>(map.cast<float>(), family, levels, boundary);
                        if (family.stable())
                            CHECK((reconstruct_standard(*in_float) - map.cast<float>())
                                      .abs()
                                      .maxCoeff() <= 16 * 0x1p-24f);
                    }
        }
}

TEST_CASE("Standard decomposition: one level is the non-standard transform's") {
    Random random(62);
    const auto map = make_map<double>(MapKind::random, 18, 13, random);
    for (const Family& family : families(2)) {
        if (family.kind == Family::Kind::positive) continue;
        const auto standard = *decompose_standard(map, family, 1);
        const auto other = *decompose(map, family, 1);
        const auto same = [](const Band<double>& a, const Band<double>& b) {
            CHECK(a.start_x == b.start_x);
            CHECK(a.start_z == b.start_z);
            REQUIRE(a.values.rows() == b.values.rows());
            REQUIRE(a.values.cols() == b.values.cols());
            CHECK((a.values - b.values).abs().maxCoeff() <= 1e-13);
        };
        same(standard.band(0, 0), other.approximation);
        same(standard.band(0, 1), other.details[0].phi_psi);
        same(standard.band(1, 0), other.details[0].psi_phi);
        same(standard.band(1, 1), other.details[0].psi_psi);
    }
}

TEST_CASE("Standard decomposition: a separable map costs the product of its factors") {
    // x-constant map with repeat: all bands with x details are empty of energy.
    Grid<double> map(16, 32);
    for (int j = 0; j < 16; ++j) map.row(j).setConstant(std::sin(j));
    const auto dec = *decompose_standard(map, {Family::Kind::cdf, 1, 2}, 4, Boundary::repeat);
    CHECK(dec.levels_x == 4);
    CHECK(dec.levels_z == 4);
    for (int lz = 0; lz <= 4; ++lz)
        for (int lx = 1; lx <= 4; ++lx) CHECK(dec.band(lx, lz).values.abs().maxCoeff() <= 1e-15);
}

TEST_CASE("Standard decomposition refuses what it cannot do") {
    const Grid<float> map = Grid<float>::Ones(4, 4);
    CHECK_FALSE(decompose_standard(map, {Family::Kind::positive, 1, 0}, 1).has_value());
    CHECK_FALSE(decompose_standard(map, {Family::Kind::cdf, 1, 2}, -1).has_value());
    CHECK_FALSE(decompose_standard(Grid<float>(), {Family::Kind::cdf, 1, 2}, 1).has_value());
}
