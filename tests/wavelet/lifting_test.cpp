// The fast paths for 1,1 and 2,2 give what generic filtering gives.
#include "lifting.h"

#include <doctest/doctest.h>

#include "scheme.h"
#include "support/maps.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

// A handful of roundings of values up to 2.
constexpr double kRounding = 4e-15;

void check_same(const Band<double>& fast, const Band<double>& generic) {
    CHECK(fast.start_x == generic.start_x);
    CHECK(fast.start_z == generic.start_z);
    REQUIRE(fast.values.rows() == generic.values.rows());
    REQUIRE(fast.values.cols() == generic.values.cols());
    CHECK((fast.values - generic.values).abs().maxCoeff() <= kRounding);
}

Band<double> noise_like(const Band<double>& band, Random& random) {
    Band<double> out = band;
    for (double& value : out.values.reshaped()) value = random.uniform(-1, 1);
    return out;
}

}  // namespace

TEST_CASE("Fast split and merge equal the filters, for any size and start") {
    Random random(51);
    for (const Family& family :
         {Family{Family::Kind::cdf, 0, 1}, Family{Family::Kind::cdf, 1, 2}}) {
        REQUIRE(has_lifting(family, Boundary::zero));
        const Scheme scheme = *Scheme::make(family, Boundary::zero);
        for (int height = 1; height <= 12; ++height)
            for (int width = 1; width <= 12; ++width)
                for (int start = family.degree == 0 ? 0 : -3; start <= (family.degree == 0 ? 0 : 2);
                     ++start) {
                    CAPTURE(family.name());
                    CAPTURE(width);
                    CAPTURE(height);
                    CAPTURE(start);
                    const Band<double> fine{
                        make_map<double>(MapKind::random, width, height, random), start, 1 - start};
                    const Band<double> aligned =
                        family.degree == 0 ? Band<double>{fine.values} : fine;
                    const IndexRect rect = rect_of(aligned);
                    Detail<double> fast, generic;
                    Band<double> a;
                    lifting_split<double>(family.degree, aligned.values, rect, {&fast, 1}, a);
                    check_same(a, scheme.split(aligned, generic));
                    check_same(fast.phi_psi, generic.phi_psi);
                    check_same(fast.psi_phi, generic.psi_phi);
                    check_same(fast.psi_psi, generic.psi_psi);
                    // Any coefficients, not only those that an analysis can give.
                    const Band<double> coarse = noise_like(a, random);
                    const Detail<double> detail{noise_like(fast.phi_psi, random),
                                                noise_like(fast.psi_phi, random),
                                                noise_like(fast.psi_psi, random),
                                                {}};
                    Grid<double> merged;
                    lifting_merge<double>(family.degree, coarse, {&detail, 1}, rect, merged);
                    check_same({merged, rect.x.first, rect.z.first},
                               scheme.merge(coarse, detail, rect, rect));
                }
    }
}

TEST_CASE("All levels at once equal the filters level by level, with reused storage too") {
    Random random(53);
    for (const Family& family :
         {Family{Family::Kind::cdf, 0, 1}, Family{Family::Kind::cdf, 1, 2}}) {
        const Scheme scheme = *Scheme::make(family, Boundary::zero);
        Decomposition<double> fast;  // keeps its storage from one size to the next
        Grid<double> back;
        for (const auto& [width, height] :
             {std::pair{64, 64}, {64, 64}, {37, 5}, {1, 19}, {50, 1}}) {
            const auto map = make_map<double>(MapKind::random, width, height, random);
            REQUIRE(
                decompose_into(map, family, 8, Form::wavelet, Boundary::zero, fast).has_value());
            Band<double> level{map};
            for (int l = fast.levels(); l > 0; --l) {
                Detail<double> generic;
                level = scheme.split(level, generic);
                const auto& detail = fast.details[static_cast<std::size_t>(l - 1)];
                check_same(detail.phi_psi, generic.phi_psi);
                check_same(detail.psi_phi, generic.psi_phi);
                check_same(detail.psi_psi, generic.psi_psi);
                CHECK(detail.residual.values.size() == 0);
            }
            check_same(fast.approximation, level);
            reconstruct_into(fast, back);
            check_same({back}, {map});
        }
    }
}

TEST_CASE("Other families and the periodic boundary use the filters") {
    CHECK_FALSE(has_lifting({Family::Kind::cdf, 1, 2}, Boundary::repeat));
    CHECK_FALSE(has_lifting({Family::Kind::cdf, 1, 4}, Boundary::zero));
    CHECK_FALSE(has_lifting({Family::Kind::cdf, 0, 3}, Boundary::zero));
    CHECK_FALSE(has_lifting({Family::Kind::positive, 0, 0}, Boundary::zero));
}

TEST_CASE("Bands of unexpected size are cropped or filled with zeros, not read out of bounds") {
    Random random(52);
    const auto map = make_map<float>(MapKind::random, 17, 9, random);
    auto dec = *decompose(map, {Family::Kind::cdf, 1, 2}, 2);
    const Grid<float> expected = reconstruct(dec);
    Band<float>& band = dec.details[1].psi_psi;
    const IndexRect rect = rect_of(band);
    band = cropped(band, {{rect.x.first - 5, rect.x.last + 3}, {rect.z.first - 1, rect.z.last}});
    CHECK((reconstruct(dec) == expected).all());
    band = {};
    dec.approximation = {};
    CHECK(reconstruct(dec).rows() == 9);
}
