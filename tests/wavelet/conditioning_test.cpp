// Growth of the condition number with levels (stability.md 1.3 and failure 13).
#include <doctest/doctest.h>

#include <Eigen/Eigenvalues>
#include <cmath>

#include "wavefog/wavelet/bspline.h"
#include "wavefog/wavelet/filters.h"
#include "wavefog/wavelet/standard.h"

using namespace wavefog;

namespace {

constexpr int kSize = 256;

// ||sum_i c_i phi(. - i)|| for the taps c.
double norm(const std::vector<double>& taps, int degree) {
    double square = 0;
    for (std::size_t i = 0; i < taps.size(); ++i)
        for (std::size_t j = 0; j < taps.size(); ++j)
            square += taps[i] * taps[j] *
                      bspline(2 * degree + 1,
                              degree + 1 + static_cast<double>(i) - static_cast<double>(j));
    return std::sqrt(square);
}

// A map of one row has no levels along z, so its standard decomposition is the 1-D transform.
Eigen::VectorXd coefficients(const StandardDecomposition<double>& d) {
    std::vector<double> all;
    for (const Band<double>& band : d.bands)
        all.insert(all.end(), band.values.data(), band.values.data() + band.values.size());
    return Eigen::Map<Eigen::VectorXd>(all.data(), static_cast<Eigen::Index>(all.size()));
}

double spectral_norm(const Eigen::MatrixXd& m) {
    const Eigen::MatrixXd square = m.transpose() * m;
    return std::sqrt(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(square, Eigen::EigenvaluesOnly)
                         .eigenvalues()
                         .maxCoeff());
}

// ||S|| ||A|| of the transform to `levels` levels, with functions of equal L2 norm.
double condition(const Family& family, int levels) {
    Grid<double> impulse = Grid<double>::Zero(1, kSize);
    StandardDecomposition<double> d = *decompose_standard(impulse, family, levels);
    REQUIRE(d.levels_x == levels);
    REQUIRE(d.levels_z == 0);
    const Eigen::VectorXd layout = coefficients(d);
    Eigen::VectorXd scale(layout.size());
    const double psi = norm(filters(family)->q.values, family.degree) /
                       norm(two_scale(family.degree), family.degree);
    Eigen::Index at = 0;
    for (int l = 0; l <= levels; ++l)
        for (int i = 0; i < d.band(l, 0).width(); ++i)
            scale(at++) = std::exp2(0.5 * (l == 0 ? levels : levels - l + 1)) * (l == 0 ? 1 : psi);

    Eigen::MatrixXd analysis(layout.size(), kSize), synthesis(kSize, layout.size());
    for (int i = 0; i < kSize; ++i) {
        impulse.setZero();
        impulse(0, i) = 1;
        analysis.col(i) =
            scale.cwiseProduct(coefficients(*decompose_standard(impulse, family, levels)));
    }
    at = 0;
    for (Band<double>& band : d.bands) band.values.setZero();
    for (Band<double>& band : d.bands)
        for (double& value : band.values.reshaped()) {
            value = 1 / scale(at);
            synthesis.col(at++) = reconstruct_standard(d).reshaped();
            value = 0;
        }
    return spectral_norm(analysis) * spectral_norm(synthesis);
}

}  // namespace

TEST_CASE("Default families: the condition number stops growing") {
    for (const auto& [degree, form] : {std::pair{0, Form::wavelet},
                                       {1, Form::wavelet},
                                       {2, Form::wavelet},
                                       {2, Form::scaling},
                                       {3, Form::wavelet}}) {
        const Family family = default_family(degree, form);
        const double five = condition(family, 5), six = condition(family, 6);
        MESSAGE(family.name() << ": kappa " << five << " at 5 levels, " << six << " at 6");
        CHECK(six / five < 1.1);
        CHECK(six < 16);  // stability.md 1.3: 1, 2.9, 7.6, 5.6, 13.3
    }
}

TEST_CASE("Unstable families: the condition number grows with every level") {
    for (const Family& family : {Family{Family::Kind::cdf, 2, 1}, Family{Family::Kind::cdf, 3, 2},
                                 Family{Family::Kind::cdf, 1, 0}}) {
        const double growth = condition(family, 6) / condition(family, 5);
        MESSAGE(family.name() << ": grows by " << growth);
        CHECK(growth > 1.1);
        CHECK(growth == doctest::Approx(family.condition_growth()).epsilon(0.1));
        CHECK_FALSE(family.stable());
    }
}
