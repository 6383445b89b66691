// Names of the wavelet families. Taps and lifting steps are in filters.h.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "wavefog/wavelet/result.h"

namespace wavefog {

/// The highest spline degree of a family: the Gram matrices of the banded solves reach a condition
/// number of 1e6 there, so a double still keeps 10 digits.
inline constexpr int max_degree = 15;

/// A way to choose the coarse approximation (and, with it, the wavelet) of a B-spline of a degree.
/// Synthesis is always a B-spline of that degree.
struct Family {
    enum class Kind {
        cdf,  ///< Biorthogonal Cohen-Daubechies-Feauveau N,Nt with N = degree + 1; Nt = 0: lazy.
        chui_wang,  ///< Finite-interval semi-orthogonal (L2 projection by banded solves).
        positive,   ///< Restriction (1,1)/2 at even, (1,2,1)/4 at odd degree; scaling form only.
    };
    Kind kind = Kind::cdf;
    int degree = 1;        ///< d >= 0
    int dual_moments = 2;  ///< Nt, for Kind::cdf only, 0 otherwise.

    bool operator==(const Family&) const = default;

    /// "2,2", "3,5", "chui-wang", "positive".
    std::string name() const;
    /// False for 3,1, 4,2, 4,4 and 2,0, whose condition number grows with every level.
    bool stable() const;
    /// Growth of the condition number per level: 1.47 (3,1), 1.77 (4,2), 1.15 (4,4), 1.41 (2,0),
    /// 1 for stable families (stability.md 1.3).
    double condition_growth() const;
    /// What to tell the user of an unstable family, naming the growth; empty for a stable one.
    std::string warning() const;
};

/// The two forms of a decomposition (paper 004, 4.2 and 4.4).
enum class Form {
    wavelet,  ///< Three wavelet bands a level: phi psi, psi phi, psi psi.
    scaling,  ///< Details turned back into scaling functions: one residual grid a level.
};

/// Haar 1,1; linear 2,2; quadratic 3,3 in wavelet form and 3,5 in scaling form; cubic 4,6;
/// Chui-Wang from degree 4 on.
Family default_family(int degree, Form form);

/// All families of a degree, the CDF pairs first.
std::vector<Family> families(int degree);

/// Parses "2,2", "chui-wang", "positive" for splines of `degree`; a usage error lists what there
/// is.
Result<Family> parse_family(std::string_view text, int degree);

/// "haar", "linear", "quadratic", "cubic" or "degree-N" and back.
std::string basis_name(int degree);
Result<int> parse_basis(std::string_view text);

}  // namespace wavefog
