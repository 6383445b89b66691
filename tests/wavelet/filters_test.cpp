// All identities in integer arithmetic: numerators are compared after multiplying by denominators.
#include "wavefog/wavelet/filters.h"

#include <doctest/doctest.h>

#include "wavefog/wavelet/bspline.h"

using namespace wavefog;

namespace {

// Numerator of sum_n x_n y_{n+2k}; its denominator is the product of both.
std::int64_t correlation(const ExactTaps& x, const ExactTaps& y, int k) {
    std::int64_t sum = 0;
    for (int n = x.start; n <= x.last(); ++n) sum += x.numerator(n) * y.numerator(n + 2 * k);
    return sum;
}

// Numerator of sum_n n^power x_n.
std::int64_t moment(const ExactTaps& x, int power) {
    std::int64_t sum = 0;
    for (int n = x.start; n <= x.last(); ++n) {
        std::int64_t term = x.numerator(n);
        for (int i = 0; i < power; ++i) term *= n;
        sum += term;
    }
    return sum;
}

std::vector<FilterBank> all_banks() {
    std::vector<FilterBank> banks;
    for (const auto& [order, dual_moments] : cdf_pairs())
        banks.push_back(*cdf_filters(order, dual_moments));
    return banks;
}

}  // namespace

TEST_CASE("The filter banks are those of the issue") {
    CHECK(cdf_pairs() == std::vector<std::pair<int, int>>{{1, 1},
                                                          {1, 3},
                                                          {2, 0},
                                                          {2, 2},
                                                          {2, 4},
                                                          {3, 1},
                                                          {3, 3},
                                                          {3, 5},
                                                          {3, 7},
                                                          {4, 2},
                                                          {4, 4},
                                                          {4, 6}});
    const auto missing = cdf_filters(5, 5);
    REQUIRE_FALSE(missing.has_value());
    CHECK(missing.error().kind == ErrorKind::usage);
    CHECK(missing.error().message.find("2,2") != std::string::npos);
}

TEST_CASE("Low-pass sums, lengths and symmetry are exact") {
    for (const FilterBank& bank : all_banks()) {
        CAPTURE(bank.order);
        CAPTURE(bank.dual_moments);
        CHECK(moment(bank.p, 0) == 2 * bank.p.denominator);
        CHECK(moment(bank.h, 0) == bank.h.denominator);
        // Length 2 Nt + N - 1 (stability.md 1.1); the lazy 2,0 has one tap.
        CHECK(static_cast<int>(bank.h.numerators.size()) == 2 * bank.dual_moments + bank.order - 1);
        // phi and its dual are symmetric about the same point, (d + 1) / 2.
        CHECK(bank.h.start + bank.h.last() == bank.order);
        for (int n = bank.h.start; n <= bank.h.last(); ++n)
            CHECK(bank.h.numerator(n) == bank.h.numerator(bank.order - n));
    }
}

TEST_CASE("p are the two-scale taps 2^-d C(d+1, k)") {
    for (const FilterBank& bank : all_banks()) {
        const auto p = two_scale(bank.order - 1);
        REQUIRE(bank.p.start == 0);
        REQUIRE(bank.p.numerators.size() == p.size());
        for (std::size_t k = 0; k < p.size(); ++k)
            CHECK(static_cast<double>(bank.p.numerators[k]) ==
                  p[k] * static_cast<double>(bank.p.denominator));
    }
}

TEST_CASE("Analysis and synthesis are biorthogonal") {
    for (const FilterBank& bank : all_banks()) {
        CAPTURE(bank.order);
        CAPTURE(bank.dual_moments);
        for (int k = -20; k <= 20; ++k) {
            const std::int64_t same = k == 0 ? 1 : 0;
            CHECK(correlation(bank.h, bank.p, k) == same * bank.h.denominator * bank.p.denominator);
            CHECK(correlation(bank.g, bank.q, k) == same * bank.g.denominator * bank.q.denominator);
            CHECK(correlation(bank.h, bank.q, k) == 0);
            CHECK(correlation(bank.g, bank.p, k) == 0);
        }
    }
}

TEST_CASE("Synthesis after analysis is the identity") {
    for (const FilterBank& bank : all_banks()) {
        // sum_k p_{n-2k} h_{m-2k} + q_{n-2k} g_{m-2k} = [n == m], on one denominator: g and q carry
        // the denominators of p and h (times 2).
        REQUIRE(bank.g.denominator == 2 * bank.p.denominator);
        REQUIRE(bank.q.denominator == bank.h.denominator);
        for (int n = 0; n <= 1; ++n)
            for (int m = -30; m <= 30; ++m) {
                std::int64_t low = 0, high = 0;
                for (int k = -30; k <= 30; ++k) {
                    low += bank.p.numerator(n - 2 * k) * bank.h.numerator(m - 2 * k);
                    high += bank.q.numerator(n - 2 * k) * bank.g.numerator(m - 2 * k);
                }
                CHECK(2 * low + high == (n == m ? 2 * bank.p.denominator * bank.h.denominator : 0));
            }
    }
}

TEST_CASE("psi has Nt vanishing moments and its dual N, no more") {
    for (const FilterBank& bank : all_banks()) {
        CAPTURE(bank.order);
        CAPTURE(bank.dual_moments);
        for (int r = 0; r < bank.dual_moments; ++r) CHECK(moment(bank.q, r) == 0);
        CHECK(moment(bank.q, bank.dual_moments) != 0);
        for (int r = 0; r < bank.order; ++r) CHECK(moment(bank.g, r) == 0);
        CHECK(moment(bank.g, bank.order) != 0);
    }
}

TEST_CASE("Floating-point taps equal the exact ones") {
    for (const FilterBank& bank : all_banks()) {
        const Filters taps = *filters({Family::Kind::cdf, bank.order - 1, bank.dual_moments});
        const auto same = [](const ExactTaps& exact, const Taps& floating) {
            CHECK(exact.start == floating.start);
            REQUIRE(exact.numerators.size() == floating.values.size());
            for (std::size_t i = 0; i < floating.values.size(); ++i)  // dyadic, so no rounding
                CHECK(static_cast<double>(exact.numerators[i]) ==
                      floating.values[i] * static_cast<double>(exact.denominator));
        };
        same(bank.h, taps.h);
        same(bank.g, taps.g);
        same(bank.p, taps.p);
        same(bank.q, taps.q);
    }
}

TEST_CASE("Chui-Wang wavelets have their published taps and whole-line duals") {
    const std::vector<std::vector<double>> published = {
        {1, -1},
        {1, -6, 10, -6, 1},
        {1, -29, 147, -303, 303, -147, 29, -1},
        {1, -124, 1677, -7904, 18482, -24264, 18482, -7904, 1677, -124, 1}};
    const double denominator[] = {1, 12, 480, 40320};
    for (int d = 0; d <= 3; ++d) {
        const Filters bank = *filters({Family::Kind::chui_wang, d, 0});
        const auto& taps = published[static_cast<std::size_t>(d)];
        REQUIRE(bank.q.values.size() == taps.size());
        for (std::size_t k = 0; k < taps.size(); ++k)
            CHECK(bank.q.values[k] == doctest::Approx(taps[k] / denominator[d]).epsilon(1e-12));
    }
    for (int d = 0; d <= 8; ++d) {
        const Filters bank = *filters({Family::Kind::chui_wang, d, 0});
        const auto correlate = [](const Taps& x, const Taps& y, int k) {
            double sum = 0;
            for (int n = x.start; n <= x.last(); ++n)
                if (const int at = n + 2 * k - y.start;
                    at >= 0 && at < static_cast<int>(y.values.size()))
                    sum += x.values[static_cast<std::size_t>(n - x.start)] *
                           y.values[static_cast<std::size_t>(at)];
            return sum;
        };
        for (int k = -5; k <= 5; ++k) {
            const double same = k == 0 ? 1 : 0;
            // Solving with the Gram matrix loses log2(kappa) bits: kappa_phi = 1695 at degree 8.
            CHECK(std::abs(correlate(bank.h, bank.p, k) - same) <= 1e-12);
            CHECK(std::abs(correlate(bank.g, bank.q, k) - same) <= 1e-12);
            CHECK(std::abs(correlate(bank.h, bank.q, k)) <= 1e-12);
            CHECK(std::abs(correlate(bank.g, bank.p, k)) <= 1e-12);
        }
    }
}
