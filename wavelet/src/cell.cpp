#include "wavefog/wavelet/cell.h"

#include <algorithm>
#include <cmath>

#include "wavefog/wavelet/bspline.h"

namespace wavefog {
namespace {

int wrapped(int index, int period) {
    const int rest = index % period;
    return rest < 0 ? rest + period : rest;
}

template <class T>
double coefficient(const Band<T>& band, Boundary boundary, int kx, int kz) {
    if (boundary == Boundary::repeat) {
        kx = band.start_x + wrapped(kx - band.start_x, band.width());
        kz = band.start_z + wrapped(kz - band.start_z, band.height());
    }
    return static_cast<double>(band.at(kx, kz));
}

// Piece p of phi_d(u - i) meets cell cx where i = cx - p, so along each axis
// rho = sum_p c(cx - p) sum_n B(n, p) t^n.
template <class T>
void polynomial(const Band<T>& band, const Eigen::MatrixXd& pieces, Boundary boundary, int cx,
                int cz, double* out) {
    const int order = static_cast<int>(pieces.rows());
    std::fill(out, out + order * order, 0.0);
    for (int pz = 0; pz < order; ++pz)
        for (int n = 0; n < order; ++n) {
            double along_x = 0;
            for (int px = 0; px < order; ++px)
                along_x += pieces(n, px) * coefficient(band, boundary, cx - px, cz - pz);
            for (int m = 0; m < order; ++m) out[m * order + n] += pieces(m, pz) * along_x;
        }
}

}  // namespace

template <class T>
void cell_polynomial(const Band<T>& band, int degree, Boundary boundary, int cx, int cz,
                     double* out) {
    polynomial(band, bspline_pieces(degree), boundary, cx, cz, out);
}
template void cell_polynomial(const Band<float>&, int, Boundary, int, int, double*);
template void cell_polynomial(const Band<double>&, int, Boundary, int, int, double*);

std::vector<float> cell_polynomials(const Band<float>& band, int degree, Boundary boundary,
                                    int cells_x, int cells_z) {
    const Eigen::MatrixXd pieces = bspline_pieces(degree);
    const auto terms = static_cast<std::size_t>((degree + 1) * (degree + 1));
    std::vector<double> cell(terms);
    std::vector<float> out(static_cast<std::size_t>(cells_x) * static_cast<std::size_t>(cells_z) *
                           terms);
    auto next = out.begin();
    for (int cz = 0; cz < cells_z; ++cz)
        for (int cx = 0; cx < cells_x; ++cx) {
            polynomial(band, pieces, boundary, cx, cz, cell.data());
            next = std::transform(cell.begin(), cell.end(), next,
                                  [](double term) { return static_cast<float>(term); });
        }
    return out;
}

double segment_mean(const double* polynomial, int degree, double u0, double v0, double u1,
                    double v1) {
    // With u and v linear in s, the mean of u^n v^m over s in [0, 1] is
    //   sum_{i<=n, j<=m} C(n,i) u0^(n-i) u1^i C(m,j) v0^(m-j) v1^j / (C(n+m,i+j) (n+m+1)),
    // all terms positive inside a cell: no digits are lost however short the segment is.
    constexpr int kOrder = 2 * max_degree + 1;
    double binomial[kOrder][kOrder];
    for (int n = 0; n <= 2 * degree; ++n) {
        binomial[n][0] = binomial[n][n] = 1;
        for (int k = 1; k < n; ++k) binomial[n][k] = binomial[n - 1][k - 1] + binomial[n - 1][k];
    }
    double u[kOrder][2], v[kOrder][2];  // powers of both ends
    u[0][0] = u[0][1] = v[0][0] = v[0][1] = 1;
    for (int n = 1; n <= degree; ++n) {
        u[n][0] = u[n - 1][0] * u0;
        u[n][1] = u[n - 1][1] * u1;
        v[n][0] = v[n - 1][0] * v0;
        v[n][1] = v[n - 1][1] * v1;
    }
    double mean = 0;
    for (int m = 0; m <= degree; ++m)
        for (int n = 0; n <= degree; ++n) {
            const double c = polynomial[m * (degree + 1) + n];
            if (c == 0) continue;
            double term = 0;
            for (int i = 0; i <= n; ++i)
                for (int j = 0; j <= m; ++j)
                    term += binomial[n][i] * u[n - i][0] * u[i][1] * binomial[m][j] * v[m - j][0] *
                            v[j][1] / binomial[n + m][i + j];
            mean += c * term / (n + m + 1);
        }
    return mean;
}

double bspline_segment_mean(int degree, double u0, double v0, double u1, double v1) {
    const Eigen::MatrixXd pieces = bspline_pieces(degree);
    const double du = u1 - u0, dv = v1 - v0;
    std::vector<double> cuts = {0, 1};
    for (int knot = 0; knot <= degree + 1; ++knot) {
        if (du != 0) cuts.push_back((knot - u0) / du);
        if (dv != 0) cuts.push_back((knot - v0) / dv);
    }
    std::erase_if(cuts, [](double s) { return !(s >= 0 && s <= 1); });
    std::sort(cuts.begin(), cuts.end());
    std::vector<double> cell(static_cast<std::size_t>((degree + 1) * (degree + 1)));
    double sum = 0;
    for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
        const double s0 = cuts[i], s1 = cuts[i + 1], middle = (s0 + s1) / 2;
        const double cx = std::floor(u0 + du * middle), cz = std::floor(v0 + dv * middle);
        if (!(s1 > s0) || cx < 0 || cz < 0 || cx > degree || cz > degree) continue;
        const auto px = static_cast<Eigen::Index>(cx), pz = static_cast<Eigen::Index>(cz);
        for (int m = 0; m <= degree; ++m)
            for (int n = 0; n <= degree; ++n)
                cell[static_cast<std::size_t>(m * (degree + 1) + n)] =
                    pieces(m, pz) * pieces(n, px);
        sum += (s1 - s0) * segment_mean(cell.data(), degree, u0 + du * s0 - cx, v0 + dv * s0 - cz,
                                        u0 + du * s1 - cx, v0 + dv * s1 - cz);
    }
    return sum;
}

}  // namespace wavefog
