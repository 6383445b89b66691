#include "wavefog/wavelet/quantise.h"

#include <doctest/doctest.h>

#include <cmath>
#include <limits>

#include "support/maps.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

bool all_half(const Band<float>& band) {
    for (const float value : band.values.reshaped())
        if (nearest_half(value) != value) return false;
    return true;
}

bool all_half(const Decomposition<float>& decomposition) {
    bool half = all_half(decomposition.approximation);
    for (const Detail<float>& d : decomposition.details)
        half = half && all_half(d.phi_psi) && all_half(d.psi_phi) && all_half(d.psi_psi) &&
               all_half(d.residual);
    return half;
}

}  // namespace

TEST_CASE("half_above is the least half not below, across signs, subnormals and the limits") {
    CHECK(half_above(0) == 0);
    CHECK(half_above(1) == 1);
    CHECK(half_above(1 + 1e-9) == 1 + 0x1p-10f);
    CHECK(half_above(-1 - 1e-9) == -1);
    CHECK(half_above(1e-30) == 0x1p-24f);
    CHECK(half_above(-1e-30) == 0);
    CHECK(half_above(65504) == max_half);
    CHECK(std::isinf(half_above(65505)));
    Random random(81);
    for (int trial = 0; trial < 20000; ++trial) {
        const double x = std::ldexp(random.uniform(-1, 1), random.integer(-24, 15));
        const float above = half_above(x);
        CHECK(nearest_half(above) == above);
        CHECK(static_cast<double>(above) >= x);
        // No half lies between: one step of a half is 2^-10 of its magnitude, 2^-24 at least.
        CHECK(static_cast<double>(above) - x <= std::max(std::abs(x) * 0x1p-10, 0x1p-24));
    }
}

TEST_CASE("Closed loop: every coefficient is a half and the map never falls below the true one") {
    Random random(82);
    for (int degree = 0; degree <= 4; ++degree)
        for (const Family& family : families(degree))
            for (const MapKind kind : {MapKind::random, MapKind::hard_edged, MapKind::impulse,
                                       MapKind::checkerboard, MapKind::smooth})
                for (const auto& [width, height] : {std::pair{48, 48}, {33, 70}, {1, 9}}) {
                    CAPTURE(family.name());
                    CAPTURE(map_name(kind));
                    const auto map = make_map<float>(kind, width, height, random);
                    auto dec = *decompose(map, family, 4, Form::scaling);
                    REQUIRE(round_to_half_closed_loop(dec).has_value());
                    CHECK(all_half(dec));
                    const Grid<float> back = reconstruct(dec);
                    CHECK(back.minCoeff() >= 0);
                    CHECK((back - map).minCoeff() >= -0x1p-23f);  // float rounding of the residual
                    // One step of the finest residual, whose magnitude is at most 1 + |P a| <= 8.
                    CHECK((back - map).maxCoeff() <= 8 * 0x1p-10f);
                }
}

TEST_CASE("Open-loop rounding does go negative: the closed-loop test can fail") {
    Random random(83);
    const auto map = make_map<float>(MapKind::hard_edged, 64, 64, random);
    auto dec = *decompose(map, {Family::Kind::cdf, 1, 2}, 4, Form::scaling);
    const auto round = [](Band<float>& band) {
        band.values = band.values.unaryExpr([](float x) { return nearest_half(x); }).eval();
    };
    round(dec.approximation);
    for (Detail<float>& d : dec.details) round(d.residual);
    CHECK(reconstruct(dec).minCoeff() < -1e-5f);
}

TEST_CASE("Wavelet form rounds to the nearest half") {
    Random random(84);
    const auto map = make_map<float>(MapKind::random, 40, 40, random);
    auto dec = *decompose(map, default_family(2, Form::wavelet), 3);
    const auto exact = dec;
    REQUIRE(round_to_half_closed_loop(dec).has_value());
    CHECK(all_half(dec));
    const auto& a = exact.details[2].psi_psi.values;
    CHECK((dec.details[2].psi_psi.values - a).abs().maxCoeff() <= a.abs().maxCoeff() * 0x1p-11f);
}

TEST_CASE("Values that half cannot hold are an error and change nothing") {
    for (const float value :
         {1e6f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()})
        for (const Form form : {Form::wavelet, Form::scaling}) {
            const Grid<float> map = Grid<float>::Constant(8, 8, value);
            auto dec = *decompose(map, default_family(1, form), 2, form);
            const Grid<float> before = dec.approximation.values;
            const auto result = round_to_half_closed_loop(dec);
            REQUIRE_FALSE(result.has_value());
            CHECK(result.error().message.find("scale the map") != std::string::npos);
            if (value == 1e6f) CHECK((dec.approximation.values == before).all());
        }
}

TEST_CASE("Hard threshold drops what is below its level's limit and counts it") {
    Random random(85);
    const auto map = make_map<float>(MapKind::random, 32, 20, random);
    for (const Form form : {Form::wavelet, Form::scaling}) {
        auto dec = *decompose(map, default_family(1, form), 3, form);
        const auto exact = dec;
        const auto none = hard_threshold(dec, {});
        CHECK(none.dropped == 0);
        CHECK((reconstruct(dec) == reconstruct(exact)).all());
        const double limits[] = {0.01, 0.02, 0.05};
        const auto count = hard_threshold(dec, limits);
        CHECK(count.kept + count.dropped == none.kept);
        CHECK(count.dropped > 0);
        CHECK(count.kept > 0);
        for (std::size_t l = 0; l < 3; ++l) {
            const auto check = [&](const Grid<float>& now, const Grid<float>& before) {
                for (Eigen::Index i = 0; i < now.size(); ++i)
                    CHECK(now.data()[i] ==
                          (std::abs(before.data()[i]) < static_cast<float>(limits[l])
                               ? 0.0f
                               : before.data()[i]));
            };
            check(dec.details[l].psi_phi.values, exact.details[l].psi_phi.values);
            check(dec.details[l].residual.values, exact.details[l].residual.values);
        }
        CHECK(hard_threshold(dec, limits) == ThresholdCount{count.kept, 0});
    }
}
