// Path-integral tables (paper 004, section 4.3): integrals of basis functions along paths through
// one cell, computed once and looked up while a ray walks from cell to cell.
#pragma once

#include <array>
#include <vector>

#include "wavefog/wavelet/family.h"
#include "wavefog/wavelet/result.h"

namespace wavefog {

/// What a whole path (from face to face) stores.
enum class PathLayout {
    mean,  ///< Mean along the chord, a block per pair of edges, samples on the corners; times the
           ///< exact length. Exact for degree 0 and 1 at 2 samples an edge; O(1/N^2) for degree 2.
    perimeter,  ///< The integral itself, entry and exit by their place on the perimeter, sampled at
                ///< the middles of 4 N equal parts. O(1/N) at corners (stability.md 7).
};

/// A function of one variable as polynomials on unit pieces: piece p of translate k covers
/// [stride k + first + p, + 1]. A wavelet has knots at half cells of its level, so wavelet bands
/// are walked in half cells (stride 2), where each function is one polynomial.
struct PieceFunction {
    int stride = 1;
    int first = 0;
    int degree = 0;
    std::vector<double>
        coefficients;  ///< piece p, power n: [p (degree + 1) + n], local t in [0, 1]

    int pieces() const { return static_cast<int>(coefficients.size()) / (degree + 1); }
    double operator()(double x) const;  ///< of translate 0; x in pieces
};

/// phi on whole cells (stride 1), phi and psi on half cells (stride 2).
PieceFunction scaling_pieces(int degree);
PieceFunction scaling_half_pieces(int degree);
/// psi = sum q_n phi(2 x - n) (paper 004, eq. 8); a usage error for families without a wavelet on
/// the whole line (positive; Chui-Wang, whose boundary wavelets differ).
Result<PieceFunction> wavelet_half_pieces(const Family& family);

/// RGBA texels, row-major.
struct PathTexture {
    int width = 0, height = 0;
    std::vector<float> rgba;
};

/// Tables of phi phi on whole cells and, for the wavelet form, phi psi, psi phi, psi psi on half
/// cells. Block b of a function holds its piece (px, pz): b = first_block + pz pieces_x + px.
struct PathTable {
    struct Function {
        int pieces_x = 0, pieces_z = 0, first_block = 0;
    };
    int degree = 1;
    int samples = 2;  ///< N, an edge
    PathLayout layout = PathLayout::mean;
    std::array<Function, 4> functions;  ///< phi phi, phi psi, psi phi, psi psi (empty: not there)
    int psi_first = 0;                  ///< PieceFunction::first of psi

    /// Whole paths. A texel holds the four corners of a bilinear patch: samples (i, j), (i + 1, j),
    /// (i, j + 1), (i + 1, j + 1). mean: columns (edge pair) (N - 1) + i, rows block (N - 1) + j,
    /// with edges 0: x = 0, 1: x = 1, 2: z = 0, 3: z = 1, pairs 01 02 03 12 13 23, i along the
    /// first. perimeter: columns i = 0 .. 4 N - 1 (exit), rows block 4 N + j (entry), place = x
    /// along z = 0, 1 + z along x = 1, 3 - x along z = 1, 4 - z along x = 0.
    PathTexture whole;
    /// Partial paths, which begin or end inside the cell, have four coordinates: too many for a
    /// table of integrals. But the mean of every degree-(d,d) polynomial over one segment is the
    /// same weighted sum of its values at (d + 1)^2 nodes (i / d, j / d), so the table holds those
    /// values and the path gives the weights: exact. One row a block; degree 0: one value; degree
    /// 1: one texel, (0,0), (1,0), (0,1), (1,1); degree 2: texel j holds nodes (0, j/2), (1/2,
    /// j/2), (1, j/2).
    PathTexture partial;

    std::size_t bytes() const { return (whole.rgba.size() + partial.rgba.size()) * sizeof(float); }
};

/// `samples` 2 .. 128. `with_wavelets` adds the wavelet bands' functions. Degree 0 to 2; a usage
/// error for other degrees, families without wavelets, and tables above 512 MiB.
Result<PathTable> make_path_table(const Family& family, int samples, PathLayout layout,
                                  bool with_wavelets);

/// What the shader computes, in double: the mean of function f's piece (px, pz) from `a` to `b` on
/// the cell's perimeter, by the table's interpolation.
double look_up_whole(const PathTable& table, int function, int px, int pz, const double* a,
                     const double* b);

}  // namespace wavefog
