#include "wavefog/wavelet/path_table.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "wavefog/wavelet/bspline.h"
#include "wavefog/wavelet/cell.h"
#include "wavefog/wavelet/filters.h"

namespace wavefog {
namespace {

constexpr std::size_t kMaxBytes = std::size_t{512} << 20;
constexpr int kMinSamples = 2, kMaxSamples = 128;
constexpr int kMaxDegree = 2;

// sum_k taps_k phi(x - start - k) in pieces.
PieceFunction combine(int degree, const std::vector<double>& taps, int start, int stride) {
    const auto spline = bspline_pieces(degree);
    PieceFunction f;
    f.stride = stride;
    f.first = start;
    f.degree = degree;
    const int pieces = static_cast<int>(taps.size()) + degree;
    f.coefficients.assign(static_cast<std::size_t>(pieces * (degree + 1)), 0.0);
    for (int p = 0; p < pieces; ++p)
        for (int q = 0; q <= degree; ++q) {
            const int tap = p - q;
            if (tap < 0 || tap >= static_cast<int>(taps.size())) continue;
            for (int n = 0; n <= degree; ++n)
                f.coefficients[static_cast<std::size_t>(p * (degree + 1) + n)] +=
                    taps[static_cast<std::size_t>(tap)] * spline(n, q);
        }
    return f;
}

// The tensor piece (px, pz) as cell.h's polynomial.
std::vector<double> product(const PieceFunction& x, int px, const PieceFunction& z, int pz) {
    const int order = x.degree + 1;
    std::vector<double> polynomial;
    for (int m = 0; m < order; ++m)
        for (int n = 0; n < order; ++n)
            polynomial.push_back(x.coefficients[static_cast<std::size_t>(px * order + n)] *
                                 z.coefficients[static_cast<std::size_t>(pz * order + m)]);
    return polynomial;
}

struct Point {
    double x = 0, z = 0;
};

Point on_edge(int edge, double s) {
    switch (edge) {
        case 0:
            return {0, s};
        case 1:
            return {1, s};
        case 2:
            return {s, 0};
        default:
            return {s, 1};
    }
}

Point on_perimeter(double place) {
    place -= 4 * std::floor(place / 4);
    if (place < 1) return {place, 0};
    if (place < 2) return {1, place - 1};
    if (place < 3) return {3 - place, 1};
    return {0, 4 - place};
}

double perimeter_place(Point p) {
    if (p.z <= 0) return p.x;
    if (p.x >= 1) return 1 + p.z;
    if (p.z >= 1) return 3 - p.x;
    return 4 - p.z;
}

constexpr int kPairs[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};

class Filler {
  public:
    Filler(PathTable& table, const std::vector<double>& polynomial, int block)
        : table_(table), polynomial_(polynomial), block_(block) {}

    void whole() {
        if (table_.layout == PathLayout::mean)
            mean_blocks();
        else
            perimeter_block();
    }

    void partial() {
        const int order = table_.degree + 1;
        const auto node = [&](int i) { return order == 1 ? 0.5 : double(i) / (order - 1); };
        for (int j = 0; j < order; ++j)
            for (int i = 0; i < order; ++i) {
                const Point p{node(i), node(j)};
                const int value = order == 2 ? j * order + i : i;
                texel(table_.partial, order == 2 ? 0 : j, block_)[value] = mean(p, p);
            }
    }

  private:
    float mean(Point a, Point b) const {
        return static_cast<float>(
            segment_mean(polynomial_.data(), table_.degree, a.x, a.z, b.x, b.z));
    }
    static float* texel(PathTexture& texture, int x, int y) {
        return &texture.rgba[4 * (static_cast<std::size_t>(y) *
                                      static_cast<std::size_t>(texture.width) +
                                  static_cast<std::size_t>(x))];
    }

    void mean_blocks() {
        const int n = table_.samples - 1;
        for (int pair = 0; pair < 6; ++pair)
            for (int j = 0; j < n; ++j)
                for (int i = 0; i < n; ++i) {
                    float* out = texel(table_.whole, pair * n + i, block_ * n + j);
                    for (int corner = 0; corner < 4; ++corner)
                        out[corner] = mean(on_edge(kPairs[pair][0], double(i + corner % 2) / n),
                                           on_edge(kPairs[pair][1], double(j + corner / 2) / n));
                }
    }

    void perimeter_block() {
        const int count = 4 * table_.samples;
        std::vector<float> integral(static_cast<std::size_t>(count * count));
        for (int j = 0; j < count; ++j)
            for (int i = 0; i < count; ++i) {
                const Point a = on_perimeter((j + 0.5) / table_.samples);
                const Point b = on_perimeter((i + 0.5) / table_.samples);
                integral[static_cast<std::size_t>(j * count + i)] =
                    mean(a, b) * static_cast<float>(std::hypot(b.x - a.x, b.z - a.z));
            }
        for (int j = 0; j < count; ++j)
            for (int i = 0; i < count; ++i) {
                float* out = texel(table_.whole, i, block_ * count + j);
                for (int corner = 0; corner < 4; ++corner)
                    out[corner] = integral[static_cast<std::size_t>(
                        (j + corner / 2) % count * count + (i + corner % 2) % count)];
            }
    }

    PathTable& table_;
    const std::vector<double>& polynomial_;
    int block_;
};

}  // namespace

double PieceFunction::operator()(double x) const {
    const double at = x - first;
    const int p = static_cast<int>(std::floor(at));
    if (p < 0 || p >= pieces()) return 0;
    double value = 0;
    for (int n = degree; n >= 0; --n)
        value = value * (at - p) + coefficients[static_cast<std::size_t>(p * (degree + 1) + n)];
    return value;
}

PieceFunction scaling_pieces(int degree) {
    return combine(degree, {1.0}, 0, 1);
}

PieceFunction scaling_half_pieces(int degree) {
    return combine(degree, two_scale(degree), 0, 2);
}

Result<PieceFunction> wavelet_half_pieces(const Family& family) {
    if (family.kind != Family::Kind::cdf)
        return usage_error("family " + family.name() +
                           ": has no wavelet that is the same in every cell; use the scaling form "
                           "(paper-scaling), or a family N,Nt");
    auto bank = filters(family);
    if (!bank) return tl::unexpected(bank.error());
    return combine(family.degree, bank->q.values, bank->q.start, 2);
}

Result<PathTable> make_path_table(const Family& family, int samples, PathLayout layout,
                                  bool with_wavelets) {
    if (family.degree > kMaxDegree)
        return usage_error("path-integral table: degree " + std::to_string(family.degree) +
                           "; tables hold degree 0 to 2");
    if (samples < kMinSamples || samples > kMaxSamples)
        return usage_error("path-integral table: " + std::to_string(samples) +
                           " samples an edge; choose 2 to 128");
    PathTable table;
    table.degree = family.degree;
    table.samples = samples;
    table.layout = layout;
    const PieceFunction whole = scaling_pieces(family.degree);
    PieceFunction phi, psi;
    if (with_wavelets) {
        auto wavelet = wavelet_half_pieces(family);
        if (!wavelet) return tl::unexpected(wavelet.error());
        psi = std::move(*wavelet);
        phi = scaling_half_pieces(family.degree);
        table.psi_first = psi.first;
    }
    struct Factors {
        const PieceFunction *x, *z;
    };
    const Factors factors[4] = {{&whole, &whole}, {&phi, &psi}, {&psi, &phi}, {&psi, &psi}};
    int blocks = 0;
    for (int f = 0; f < (with_wavelets ? 4 : 1); ++f) {
        auto& function = table.functions[static_cast<std::size_t>(f)];
        function = {factors[f].x->pieces(), factors[f].z->pieces(), blocks};
        blocks += function.pieces_x * function.pieces_z;
    }
    const int order = table.degree + 1,
              side = layout == PathLayout::mean ? samples - 1 : 4 * samples;
    table.whole.width = layout == PathLayout::mean ? 6 * side : side;
    table.whole.height = blocks * side;
    table.partial.width = order == 2 ? 1 : order;
    table.partial.height = blocks;
    const auto floats = [](const PathTexture& t) {
        return 4 * static_cast<std::size_t>(t.width) * static_cast<std::size_t>(t.height);
    };
    if (floats(table.whole) * sizeof(float) > kMaxBytes)
        return usage_error("path-integral table: " + std::to_string(samples) +
                           " samples an edge need " +
                           std::to_string((floats(table.whole) * sizeof(float)) >> 20) +
                           " MiB; choose fewer (the limit is 512 MiB)");
    table.whole.rgba.resize(floats(table.whole));
    table.partial.rgba.resize(floats(table.partial));
    for (int f = 0; f < 4; ++f) {
        const auto& function = table.functions[static_cast<std::size_t>(f)];
        for (int pz = 0; pz < function.pieces_z; ++pz)
            for (int px = 0; px < function.pieces_x; ++px) {
                const auto polynomial = product(*factors[f].x, px, *factors[f].z, pz);
                Filler fill(table, polynomial, function.first_block + pz * function.pieces_x + px);
                fill.whole();
                fill.partial();
            }
    }
    return table;
}

double look_up_whole(const PathTable& table, int function, int px, int pz, const double* a,
                     const double* b) {
    const auto& f = table.functions[static_cast<std::size_t>(function)];
    const int block = f.first_block + pz * f.pieces_x + px;
    const auto patch = [&](int x, int y, double u, double v) {
        const float* t = &table.whole.rgba[4 * (static_cast<std::size_t>(y) *
                                                    static_cast<std::size_t>(table.whole.width) +
                                                static_cast<std::size_t>(x))];
        return (1 - v) * ((1 - u) * t[0] + u * t[1]) + v * ((1 - u) * t[2] + u * t[3]);
    };
    if (table.layout == PathLayout::perimeter) {
        const int count = 4 * table.samples;
        const auto place = [&](const double* p) {
            const double s = perimeter_place({p[0], p[1]}) * table.samples - 0.5;
            return s < 0 ? s + count : s;
        };
        const double s = place(b), t = place(a);
        const int i = static_cast<int>(s), j = static_cast<int>(t);
        const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
        return patch(i, block * count + j, s - i, t - j) / length;
    }
    const auto edge_of = [](const double* p) {
        return p[0] <= 0 ? 0 : p[0] >= 1 ? 1 : p[1] <= 0 ? 2 : 3;
    };
    int first = edge_of(a), second = edge_of(b);
    if (first > second) {
        std::swap(first, second);
        std::swap(a, b);
    }
    int pair = 0;
    while (pair < 5 && (kPairs[pair][0] != first || kPairs[pair][1] != second)) ++pair;
    const int n = table.samples - 1;
    const double s = (first < 2 ? a[1] : a[0]) * n, t = (second < 2 ? b[1] : b[0]) * n;
    const int i = std::min(static_cast<int>(s), n - 1), j = std::min(static_cast<int>(t), n - 1);
    return patch(pair * n + i, block * n + j, s - i, t - j);
}

}  // namespace wavefog
