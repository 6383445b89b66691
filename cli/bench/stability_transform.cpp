// Studies of the transform and of what dropping its levels does.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "bench/stability.h"
#include "wavefog/fogmap/reference.h"
#include "wavefog/wavelet/bspline.h"
#include "wavefog/wavelet/filters.h"
#include "wavefog/wavelet/standard.h"

namespace wavefog::cli {
namespace {

constexpr int kSize = 256, kLevels = 8;

std::vector<Family> studied_families() {
    std::vector<Family> families;
    for (const auto& [name, degree] : {std::pair{"1,1", 0},
                                       {"2,2", 1},
                                       {"3,3", 2},
                                       {"3,5", 2},
                                       {"4,6", 3},
                                       {"2,0", 1},
                                       {"3,1", 2},
                                       {"4,4", 3},
                                       {"4,2", 3}})
        families.push_back(*parse_family(name, degree));
    return families;
}

/// ||sum_i c_i phi(. - i)|| for the taps c, from the splines' Gram matrix.
double norm(const std::vector<double>& taps, int degree) {
    double square = 0;
    for (std::size_t i = 0; i < taps.size(); ++i)
        for (std::size_t j = 0; j < taps.size(); ++j)
            square +=
                taps[i] * taps[j] * bspline(2 * degree + 1, degree + 1 + double(i) - double(j));
    return std::sqrt(square);
}

double spectral_norm(const Eigen::MatrixXd& matrix) {
    const Eigen::MatrixXd square = matrix.rows() < matrix.cols()
                                       ? Eigen::MatrixXd(matrix * matrix.transpose())
                                       : Eigen::MatrixXd(matrix.transpose() * matrix);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(square, Eigen::EigenvaluesOnly);
    return std::sqrt(solver.eigenvalues().maxCoeff());
}

Eigen::VectorXd coefficients(const StandardDecomposition<double>& d) {
    std::vector<double> all;
    for (const Band<double>& band : d.bands)
        all.insert(all.end(), band.values.data(), band.values.data() + band.values.size());
    return Eigen::Map<Eigen::VectorXd>(all.data(), Eigen::Index(all.size()));
}

/// ||S|| ||A|| of the 1-D transform (a map of one row has no levels along z), with functions of
/// equal L2 norm.
double condition(const Family& family, int levels) {
    Grid<double> impulse = Grid<double>::Zero(1, kSize);
    StandardDecomposition<double> d = *decompose_standard(impulse, family, levels);
    Eigen::VectorXd scale(coefficients(d).size());
    const double psi = norm(filters(family)->q.values, family.degree) /
                       norm(two_scale(family.degree), family.degree);
    Eigen::Index at = 0;
    for (int l = 0; l <= levels; ++l)
        for (int i = 0; i < d.band(l, 0).width(); ++i)
            scale(at++) = std::exp2(0.5 * (l == 0 ? levels : levels - l + 1)) * (l == 0 ? 1 : psi);

    Eigen::MatrixXd analysis(scale.size(), kSize), synthesis(kSize, scale.size());
    for (int i = 0; i < kSize; ++i) {
        impulse.setZero();
        impulse(0, i) = 1;
        analysis.col(i) =
            scale.cwiseProduct(coefficients(*decompose_standard(impulse, family, levels)));
    }
    for (Band<double>& band : d.bands) band.values.setZero();
    at = 0;
    for (Band<double>& band : d.bands)
        for (double& value : band.values.reshaped()) {
            value = 1 / scale(at);
            synthesis.col(at++) = reconstruct_standard(d).reshaped();
            value = 0;
        }
    return spectral_norm(analysis) * spectral_norm(synthesis);
}

/// To 8 bits, signed, with the band's largest magnitude as its scale.
void round_to_bytes(Band<float>& band) {
    if (band.values.size() == 0) return;
    const float scale = band.values.abs().maxCoeff() / 127.5f;
    if (scale > 0) band.values = (band.values / scale).round() * scale;
}

/// Largest error of the map, in steps of 1/255 of its maximum.
double byte_error(const Grid<float>& map, const Family& family, int levels) {
    Decomposition<float> d = *decompose(map, family, levels);
    round_to_bytes(d.approximation);
    for (Detail<float>& detail : d.details)
        for (Band<float>* band : {&detail.phi_psi, &detail.psi_phi, &detail.psi_psi})
            round_to_bytes(*band);
    return 255 * double((reconstruct(d) - map).abs().maxCoeff()) / double(map.maxCoeff());
}

std::string family_label(const Family& family) {
    return family.name() + (family.stable() ? "" : " (unstable)");
}

struct DropCase {
    std::string name, key, family;
    int degree;
    Form form;
    Curve::Style style;
    bool clamp;
};

}  // namespace

std::vector<Figure> study_transforms() {
    Figure conditions, bytes;
    conditions.id = "stability-condition";
    conditions.title = "Unstable families lose digits with every level";
    conditions.subtitle =
        "Condition number of the 1-D transform of 256 samples, functions of equal norm";
    conditions.x = {"levels", false, 0.8, 8.2, 1};
    conditions.y.label = "condition number ‖S‖·‖A‖";
    bytes.id = "stability-bytes";
    bytes.title = "Coefficients in 8 bits: error against levels";
    bytes.subtitle = "Hard-edged map of 256×256, every band scaled to its own largest coefficient";
    bytes.x = conditions.x;
    bytes.y = {"largest error of the map, steps of 1/255", false, 0, 0};
    const Grid<float> map = hard_edged_map(kSize);
    for (const Family& family : studied_families()) {
        Curve kappa{family_label(family), family.name(), Curve::Style::line, {}};
        Curve steps = kappa;
        for (int levels = 1; levels <= kLevels; ++levels) {
            kappa.points.emplace_back(levels, condition(family, levels));
            steps.points.emplace_back(levels, byte_error(map, family, levels));
        }
        conditions.curves.push_back(std::move(kappa));
        bytes.curves.push_back(std::move(steps));
    }
    return {conditions, bytes};
}

Result<std::vector<Figure>> study_dropped_levels() {
    constexpr int size = 64;
    constexpr double metres = 64, extinction = 0.5;
    const Grid<float> map = hard_edged_map(size);
    const std::vector<DropCase> cases = {
        {"Haar 1,1", "1,1", "1,1", 0, Form::wavelet, Curve::Style::line, true},
        {"linear 2,2, clamped", "2,2", "2,2", 1, Form::wavelet, Curve::Style::line, true},
        {"linear 2,2, not clamped", "2,2", "2,2", 1, Form::wavelet, Curve::Style::dashed, false},
        {"quadratic 3,5, clamped", "3,5", "3,5", 2, Form::scaling, Curve::Style::line, true},
        {"quadratic 3,5, not clamped", "3,5", "3,5", 2, Form::scaling, Curve::Style::dashed, false},
        {"linear positive", "positive", "positive", 1, Form::scaling, Curve::Style::line, false}};
    Figure lowest, error;
    lowest.id = "stability-dropped-density";
    lowest.title = "Dropped details make the density negative";
    lowest.subtitle =
        "Hard-edged map of 64×64: discs of 1 on 0; all but the positive family and Haar dip below "
        "0";
    lowest.x = {"levels of detail dropped, the finest first", false, -0.05, 3.05, 1};
    lowest.y = {"lowest density, share of the map's maximum", false, -0.3, 0.05};
    error.id = "stability-dropped-error";
    error.title = "Dropped details: the clamp keeps T below 1";
    error.subtitle =
        "The same map, extinction 0.5/m, 4000 rays of up to 90 m: fog that brightens what is "
        "behind";
    error.x = {"levels of detail dropped, the finest first", false, 0.9, 3.1, 1};
    error.y = {"largest excess of T over 1", false, -0.1, 2.5};
    const auto segments = random_segments(4000, metres, 3);
    for (const DropCase& one : cases) {
        Curve density{one.name, one.key, Curve::Style::line, {}};
        Curve excess{one.name, one.key, one.style, {}};
        for (int dropped = 0; dropped <= 3; ++dropped) {
            const Result<Fog> fog = study_fog(
                map,
                {.degree = one.degree, .family = one.family, .form = one.form, .levels = dropped},
                metres, extinction);
            if (!fog) return tl::unexpected(fog.error());
            const Reference approximation(*fog);
            double largest = 1;
            for (const Segment& s : segments)
                largest = std::max(largest,
                                   std::exp(-approximation.optical_depth(s.o, s.p, 0, one.clamp)));
            if (dropped > 0) excess.points.emplace_back(dropped, largest - 1);

            // The approximation alone is a fog whose details are 0.
            Fog coarse = *fog;
            for (Detail<float>& detail : coarse.decomposition.details)
                for (Band<float>* band :
                     {&detail.phi_psi, &detail.psi_phi, &detail.psi_psi, &detail.residual})
                    band->values.setZero();
            const Reference field(coarse);
            double least = 1e300;
            for (int j = 0; j < 4 * size; ++j)
                for (int i = 0; i < 4 * size; ++i)
                    least = std::min(least, field.extinction({(i + 0.5) / 4 - metres / 2, 1.0,
                                                              (j + 0.5) / 4 - metres / 2}));
            density.points.emplace_back(dropped, least / extinction);
        }
        error.curves.push_back(std::move(excess));
        // The density is the same with and without the clamp of steps.
        if (one.style == Curve::Style::dashed) continue;
        density.name = density.name.substr(0, density.name.find(", clamped"));
        lowest.curves.push_back(std::move(density));
    }
    return std::vector{lowest, error};
}

}  // namespace wavefog::cli
