// Every level is one pass over memory: a row is lifted horizontally into a buffer, and vertical
// lifting works on whole buffered rows that are still in the L1 cache. No column is ever walked and
// nothing is transposed. All inner loops have unit stride on at least one side, without branches,
// so that compilers vectorise them for any instruction set.
//
// 2,2 with causal B-splines (stability.md 1.1; there s are the odd samples, t = 2 b the even ones):
//     b_k = c_2k / 2 - (c_2k-1 + c_2k+1) / 4          o_k = a_k - (b_k + b_k+1) / 2
//     a_k = c_2k+1 + (b_k + b_k+1) / 2                c_2k+1 = o_k, c_2k = 2 b_k + (o_k-1 + o_k) /
//     2
// For fine indices first..last, k runs over r..q for b and r-1..q for a, with r = floor(first / 2)
// and q = floor((last + 1) / 2). Samples outside are 0, so b is 0 outside r..q.
#include "lifting.h"

#include <vector>

#include "fir.h"

namespace wavefog {
namespace {

// Indices of one axis of a 2,2 level.
struct Span {
    explicit Span(Range range)
        : fine(range), r(half_down(range.first)), q(half_down(range.last + 1)) {}

    Range low() const { return {r - 1, q}; }
    Range high() const { return {r, q}; }
    // k whose samples 2k-1, 2k and 2k+1 all exist.
    Range inner() const { return {half_up(fine.first + 1), half_down(fine.last - 1)}; }

    Range fine;
    int r, q;
};

// A buffered row: low-pass coefficients a (k = r-1..q), then high-pass b (k = r..q) between two
// zeros, so that b_{r-1} and b_{q+1} can be read.
template <class T>
class Row {
  public:
    explicit Row(const Span& span)
        : values_(static_cast<std::size_t>(2 * span.low().size() + 1), T(0)),
          low_size_(span.low().size()) {}

    T* low() { return values_.data(); }                   // low()[k - (r - 1)] = a_k
    T* high() { return values_.data() + low_size_ + 1; }  // high()[k - r] = b_k
    const T* low() const { return values_.data(); }
    const T* high() const { return values_.data() + low_size_ + 1; }
    int high_size() const { return low_size_ - 1; }

  private:
    std::vector<T> values_;
    int low_size_;
};

// Horizontal analysis of one row; c[0] has the index span.fine.first.
template <class T>
void analyse_row(const T* __restrict c, const Span& span, T* __restrict a, T* __restrict b) {
    const int first = span.fine.first, r = span.r, count = span.q - r + 1;
    const auto sample = [&](int n) { return span.fine.contains(n) ? c[n - first] : T(0); };
    const auto border = [&](int k) {
        b[k - r] = sample(2 * k) / 2 - (sample(2 * k - 1) + sample(2 * k + 1)) / 4;
    };
    const Range inner = span.inner();
    for (int k = r; k < std::min(inner.first, span.q + 1); ++k) border(k);
    const int from = 2 * inner.first - first, to = inner.first - r;
    for (int i = 0; i < inner.size(); ++i)
        b[to + i] = c[from + 2 * i] / 2 - (c[from + 2 * i - 1] + c[from + 2 * i + 1]) / 4;
    for (int k = std::max(inner.last + 1, r); k <= span.q; ++k) border(k);

    const int odd = 2 * r + 1 - first;
    a[0] = b[0] / 2;
    for (int i = 0; i + 1 < count; ++i) a[i + 1] = c[odd + 2 * i] + (b[i] + b[i + 1]) / 2;
    a[count] = b[count - 1] / 2;
}

// Horizontal synthesis of one row; b[-1] and b[q - r + 1] are readable zeros.
template <class T>
void synthesise_row(const T* __restrict a, const T* __restrict b, const Span& span,
                    T* __restrict odd, T* __restrict c) {
    const int first = span.fine.first, r = span.r, count = span.q - r + 1;
    for (int i = 0; i <= count; ++i) odd[i] = a[i] - (b[i - 1] + b[i]) / 2;  // odd[i] = o_{r-1+i}
    const auto even = [&](int i) { return 2 * b[i] + (odd[i] + odd[i + 1]) / 2; };
    // Pairs (2k, 2k + 1) that lie inside; at most one sample is left over on each side.
    const int k0 = half_up(first), k1 = half_down(span.fine.last - 1);
    if (2 * k0 > first) c[0] = odd[half_down(first - 1) - r + 1];
    const int from = k0 - r, to = 2 * k0 - first;
    for (int i = 0; i <= k1 - k0; ++i) {
        c[to + 2 * i] = even(from + i);
        c[to + 2 * i + 1] = odd[from + i + 1];
    }
    if (2 * k1 + 1 < span.fine.last)
        c[span.fine.last - first] = even(half_down(span.fine.last) - r);
}

// One vertical analysis step on rows: even = row 2k, before and after = rows 2k-1 and 2k+1.
template <class T>
void analyse_step(int n, const T* __restrict even, const T* __restrict before,
                  const T* __restrict after, const T* __restrict b_before, T* __restrict b,
                  T* __restrict a) {
    for (int i = 0; i < n; ++i) {
        const T value = even[i] / 2 - (before[i] + after[i]) / 4;
        b[i] = value;
        a[i] = before[i] + (b_before[i] + value) / 2;  // a_{k-1}
    }
}

// One vertical synthesis step: rows 2k (even) and 2k+1 (odd) from a_k, b_k, b_{k+1} and row 2k-1.
template <class T>
void synthesise_step(int n, const T* __restrict a, const T* __restrict b,
                     const T* __restrict b_next, const T* __restrict before, T* __restrict even,
                     T* __restrict odd) {
    for (int i = 0; i < n; ++i) {
        const T value = a[i] - (b[i] + b_next[i]) / 2;
        odd[i] = value;
        even[i] = 2 * b[i] + (before[i] + value) / 2;
    }
}

template <class T>
Band<T> linear_split(const Grid<T>& fine, const Rect& rect, Detail<T>& detail) {
    const Span x(rect.x), z(rect.z);
    const int low = x.low().size(), high = x.high().size();
    const auto band = [](const Range& bx, const Range& bz) {
        return Band<T>{Grid<T>(bz.size(), bx.size()), bx.first, bz.first};
    };
    Band<T> coarse = band(x.low(), z.low());
    detail.phi_psi = band(x.low(), z.high());
    detail.psi_phi = band(x.high(), z.low());
    detail.psi_psi = band(x.high(), z.high());

    Row<T> even(x), before(x), after(x);
    const Row<T> zero(x);
    const auto load = [&](int n, Row<T>& row) {
        if (z.fine.contains(n))
            analyse_row(fine.row(n - z.fine.first).data(), x, row.low(), row.high());
        else
            row = zero;
    };
    load(2 * z.r - 1, before);
    const T* b_low = zero.low();
    const T* b_high = zero.high();
    for (int i = 0; i < z.high().size(); ++i) {
        load(2 * (z.r + i), even);
        load(2 * (z.r + i) + 1, after);
        T* next_low = detail.phi_psi.values.row(i).data();
        T* next_high = detail.psi_psi.values.row(i).data();
        analyse_step(low, even.low(), before.low(), after.low(), b_low, next_low,
                     coarse.values.row(i).data());
        analyse_step(high, even.high(), before.high(), after.high(), b_high, next_high,
                     detail.psi_phi.values.row(i).data());
        b_low = next_low;
        b_high = next_high;
        std::swap(before, after);
    }
    const Eigen::Index last = coarse.values.rows() - 1;  // a_q: row 2q + 1 lies outside
    coarse.values.row(last) = detail.phi_psi.values.row(last - 1) / T(2);
    detail.psi_phi.values.row(last) = detail.psi_psi.values.row(last - 1) / T(2);
    return coarse;
}

template <class T>
Grid<T> linear_merge(const Band<T>& coarse, const Detail<T>& detail, const Rect& rect) {
    const Span x(rect.x), z(rect.z);
    const int low = x.low().size(), high = x.high().size(), rows = z.high().size();
    Grid<T> fine(rect.z.size(), rect.x.size());
    Row<T> even(x), before(x), odd(x), scratch(x);
    const Row<T> zero(x);
    const auto store = [&](int n, const Row<T>& row) {
        if (z.fine.contains(n))
            synthesise_row(row.low(), row.high(), x, scratch.low(),
                           fine.row(n - z.fine.first).data());
    };
    const auto phi_psi = [&](int i) {
        return i >= 0 && i < rows ? detail.phi_psi.values.row(i).data() : zero.low();
    };
    const auto psi_psi = [&](int i) {
        return i >= 0 && i < rows ? detail.psi_psi.values.row(i).data() : zero.high();
    };
    for (int i = -1; i < rows; ++i) {  // k = r + i
        synthesise_step(low, coarse.values.row(i + 1).data(), phi_psi(i), phi_psi(i + 1),
                        before.low(), even.low(), odd.low());
        synthesise_step(high, detail.psi_phi.values.row(i + 1).data(), psi_psi(i), psi_psi(i + 1),
                        before.high(), even.high(), odd.high());
        store(2 * (z.r + i), even);
        store(2 * (z.r + i) + 1, odd);
        std::swap(before, odd);
    }
    return fine;
}

// Haar: each 2x2 block on its own. A missing last row or column is 0.
template <class T>
Band<T> haar_split(const Grid<T>& fine, Detail<T>& detail) {
    const Eigen::Index rows = (fine.rows() + 1) / 2, columns = (fine.cols() + 1) / 2;
    const Eigen::Index pairs = fine.cols() / 2;
    Band<T> coarse{Grid<T>(rows, columns)};
    detail.phi_psi.values.resize(rows, columns);
    detail.psi_phi.values.resize(rows, columns);
    detail.psi_psi.values.resize(rows, columns);
    const std::vector<T> zero(static_cast<std::size_t>(fine.cols()), T(0));
    for (Eigen::Index j = 0; j < rows; ++j) {
        const T* __restrict top = fine.row(2 * j).data();
        const T* __restrict bottom =
            2 * j + 1 < fine.rows() ? fine.row(2 * j + 1).data() : zero.data();
        T* __restrict a = coarse.values.row(j).data();
        T* __restrict phi_psi = detail.phi_psi.values.row(j).data();
        T* __restrict psi_phi = detail.psi_phi.values.row(j).data();
        T* __restrict psi_psi = detail.psi_psi.values.row(j).data();
        const auto block = [&](Eigen::Index i, T p0, T p1, T q0, T q1) {
            const T top_sum = p0 + p1, top_difference = p0 - p1;
            const T bottom_sum = q0 + q1, bottom_difference = q0 - q1;
            a[i] = (top_sum + bottom_sum) / 4;
            phi_psi[i] = (top_sum - bottom_sum) / 4;
            psi_phi[i] = (top_difference + bottom_difference) / 4;
            psi_psi[i] = (top_difference - bottom_difference) / 4;
        };
        for (Eigen::Index i = 0; i < pairs; ++i)
            block(i, top[2 * i], top[2 * i + 1], bottom[2 * i], bottom[2 * i + 1]);
        if (pairs < columns) block(pairs, top[2 * pairs], T(0), bottom[2 * pairs], T(0));
    }
    return coarse;
}

template <class T>
Grid<T> haar_merge(const Band<T>& coarse, const Detail<T>& detail, const Rect& rect) {
    const Eigen::Index height = rect.z.size(), width = rect.x.size(), pairs = width / 2;
    Grid<T> fine(height, width);
    std::vector<T> outside(static_cast<std::size_t>(width));
    for (Eigen::Index j = 0; j < coarse.values.rows(); ++j) {
        const T* __restrict a = coarse.values.row(j).data();
        const T* __restrict phi_psi = detail.phi_psi.values.row(j).data();
        const T* __restrict psi_phi = detail.psi_phi.values.row(j).data();
        const T* __restrict psi_psi = detail.psi_psi.values.row(j).data();
        T* __restrict top = fine.row(2 * j).data();
        T* __restrict bottom = 2 * j + 1 < height ? fine.row(2 * j + 1).data() : outside.data();
        for (Eigen::Index i = 0; i < pairs; ++i) {
            const T top_sum = a[i] + phi_psi[i], bottom_sum = a[i] - phi_psi[i];
            const T top_difference = psi_phi[i] + psi_psi[i];
            const T bottom_difference = psi_phi[i] - psi_psi[i];
            top[2 * i] = top_sum + top_difference;
            top[2 * i + 1] = top_sum - top_difference;
            bottom[2 * i] = bottom_sum + bottom_difference;
            bottom[2 * i + 1] = bottom_sum - bottom_difference;
        }
        if (2 * pairs < width) {
            top[2 * pairs] = a[pairs] + phi_psi[pairs] + (psi_phi[pairs] + psi_psi[pairs]);
            bottom[2 * pairs] = a[pairs] - phi_psi[pairs] + (psi_phi[pairs] - psi_psi[pairs]);
        }
    }
    return fine;
}

}  // namespace

bool has_lifting(const Family& family, Boundary boundary) {
    return boundary == Boundary::zero && family.kind == Family::Kind::cdf &&
           ((family.degree == 0 && family.dual_moments == 1) ||
            (family.degree == 1 && family.dual_moments == 2));
}

template <class T>
Band<T> lifting_split(int degree, const Grid<T>& fine, const Rect& rect, Detail<T>& detail) {
    return degree == 0 ? haar_split(fine, detail) : linear_split(fine, rect, detail);
}

template <class T>
Grid<T> lifting_merge(int degree, const Band<T>& coarse, const Detail<T>& detail,
                      const Rect& rect) {
    return degree == 0 ? haar_merge(coarse, detail, rect) : linear_merge(coarse, detail, rect);
}

template Band<float> lifting_split(int, const Grid<float>&, const Rect&, Detail<float>&);
template Band<double> lifting_split(int, const Grid<double>&, const Rect&, Detail<double>&);
template Grid<float> lifting_merge(int, const Band<float>&, const Detail<float>&, const Rect&);
template Grid<double> lifting_merge(int, const Band<double>&, const Detail<double>&, const Rect&);

}  // namespace wavefog
