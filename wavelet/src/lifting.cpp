// All levels run at once. A row of the map is lifted horizontally into a buffer; vertical lifting
// works on whole buffered rows that are still in the L1 cache, writes rows of the three detail
// bands, and hands a row of the approximation to the next level, which does the same. So the map is
// read once, each band is written once, and approximations between the levels never reach memory.
// Synthesis pulls rows the other way. No column is ever walked and nothing is transposed; the inner
// loops have no branches, so compilers vectorise them for any instruction set.
//
// 2,2 with causal B-splines (stability.md 1.1; there s are the odd samples, t = 2 b the even ones):
//     b_k = c_2k / 2 - (c_2k-1 + c_2k+1) / 4          o_k = a_k - (b_k + b_k+1) / 2
//     a_k = c_2k+1 + (b_k + b_k+1) / 2                c_2k+1 = o_k, c_2k = 2 b_k + (o_k-1 + o_k) /
//     2
// For fine indices first..last, k runs over r..q for b and r-1..q for a, with r = floor(first / 2)
// and q = floor((last + 1) / 2). Samples outside are 0, so b is 0 outside r..q.
#include "lifting.h"

#include <utility>
#include <vector>

#include "fir.h"

namespace wavefog {
namespace {

// Gives a band its place; keeps its storage if the size is right. Values are left undefined.
template <class T>
void place(Band<T>& band, Range x, Range z) {
    band.values.resize(z.size(), x.size());
    band.start_x = x.first;
    band.start_z = z.first;
}

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

// Takes the rows of one level from top to bottom. Approximation rows go to `next`, or into `coarse`
// on the last level.
template <class T>
class LinearAnalyser {
  public:
    LinearAnalyser(const IndexRect& rect, Detail<T>& detail, LinearAnalyser* next, Band<T>* coarse)
        : x_(rect.x),
          z_(rect.z),
          row_index_(rect.z.first),
          detail_(detail),
          next_(next),
          coarse_(coarse),
          even_(x_),
          before_(x_),
          after_(x_),
          zero_(x_),
          approximation_(static_cast<std::size_t>(x_.low().size())),
          b_low_(zero_.low()),
          b_high_(zero_.high()) {
        place(detail.phi_psi, x_.low(), z_.high());
        place(detail.psi_phi, x_.high(), z_.low());
        place(detail.psi_psi, x_.high(), z_.high());
        detail.residual = {};
        if (coarse_) place(*coarse_, x_.low(), z_.low());
    }

    void push(const T* row) {
        const bool odd = row_index_++ % 2 != 0;
        Row<T>& target = odd ? after_ : even_;
        analyse_row(row, x_, target.low(), target.high());
        if (odd) step();
    }

    // Rows below the last are 0; a_q follows from b_q alone.
    void finish() {
        if (z_.fine.last % 2 != 0) even_ = zero_;
        after_ = zero_;
        step();
        T* a = approximation_row();
        T* psi_phi = detail_.psi_phi.values.row(done_).data();
        for (int i = 0; i < x_.low().size(); ++i) a[i] = b_low_[i] / 2;
        for (int i = 0; i < x_.high().size(); ++i) psi_phi[i] = b_high_[i] / 2;
        if (!next_) return;
        next_->push(a);
        next_->finish();
    }

  private:
    T* approximation_row() {
        return next_ ? approximation_.data() : coarse_->values.row(done_).data();
    }

    void step() {
        T* low = detail_.phi_psi.values.row(done_).data();
        T* high = detail_.psi_psi.values.row(done_).data();
        T* a = approximation_row();
        analyse_step(x_.low().size(), even_.low(), before_.low(), after_.low(), b_low_, low, a);
        analyse_step(x_.high().size(), even_.high(), before_.high(), after_.high(), b_high_, high,
                     detail_.psi_phi.values.row(done_).data());
        b_low_ = low;
        b_high_ = high;
        std::swap(before_, after_);
        ++done_;
        if (next_) next_->push(a);
    }

    Span x_, z_;
    int row_index_;  // of the next row
    int done_ = 0;   // vertical steps: rows of b that are written
    Detail<T>& detail_;
    LinearAnalyser* next_;
    Band<T>* coarse_;
    Row<T> even_, before_, after_;  // rows 2k, 2k-1, 2k+1
    const Row<T> zero_;
    std::vector<T> approximation_;
    const T* b_low_;  // row k-1 of phi psi and psi psi
    const T* b_high_;
};

// Gives the rows of one level from top to bottom, pulling approximation rows from `coarser`, or
// from `coarse` on the first level.
template <class T>
class LinearSynthesiser {
  public:
    LinearSynthesiser(const IndexRect& rect, const Detail<T>& detail, LinearSynthesiser* coarser,
                      const Band<T>* coarse)
        : x_(rect.x),
          z_(rect.z),
          row_index_(rect.z.first),
          k_(z_.r - 2),
          detail_(detail),
          coarser_(coarser),
          coarse_(coarse),
          even_(x_),
          before_(x_),
          odd_(x_),
          scratch_(x_),
          zero_(x_),
          approximation_(static_cast<std::size_t>(x_.low().size())) {}

    void pull(T* row) {
        const int n = row_index_++;
        while (k_ < half_down(n)) step();
        const Row<T>& source = n % 2 != 0 ? odd_ : even_;
        synthesise_row(source.low(), source.high(), x_, scratch_.low(), row);
    }

  private:
    const T* low(int k) const {
        return z_.high().contains(k) ? detail_.phi_psi.values.row(k - z_.r).data() : zero_.low();
    }
    const T* high(int k) const {
        return z_.high().contains(k) ? detail_.psi_psi.values.row(k - z_.r).data() : zero_.high();
    }

    // Rows 2k and 2k + 1 for the next k, from r - 1 on.
    void step() {
        ++k_;
        const int row = k_ - z_.low().first;
        const T* a = approximation_.data();
        if (coarser_)
            coarser_->pull(approximation_.data());
        else
            a = coarse_->values.row(row).data();
        std::swap(before_, odd_);
        synthesise_step(x_.low().size(), a, low(k_), low(k_ + 1), before_.low(), even_.low(),
                        odd_.low());
        synthesise_step(x_.high().size(), detail_.psi_phi.values.row(row).data(), high(k_),
                        high(k_ + 1), before_.high(), even_.high(), odd_.high());
    }

    Span x_, z_;
    int row_index_;  // of the next row
    int k_;          // of the last vertical step
    const Detail<T>& detail_;
    LinearSynthesiser* coarser_;
    const Band<T>* coarse_;
    Row<T> even_, before_, odd_, scratch_;  // rows 2k, 2k-1, 2k+1
    const Row<T> zero_;
    std::vector<T> approximation_;
};

// Haar: each 2x2 block on its own. A missing last row or column is 0.
template <class T>
class HaarAnalyser {
  public:
    HaarAnalyser(const IndexRect& rect, Detail<T>& detail, HaarAnalyser* next, Band<T>* coarse)
        : width_(rect.x.size()),
          detail_(detail),
          next_(next),
          coarse_(coarse),
          zero_(static_cast<std::size_t>(width_), T(0)) {
        const Range x = halved(rect.x), z = halved(rect.z);
        for (Band<T>* band : {&detail.phi_psi, &detail.psi_phi, &detail.psi_psi})
            place(*band, x, z);
        detail.residual = {};
        if (coarse_) place(*coarse_, x, z);
        for (std::vector<T>& row : approximation_) row.resize(static_cast<std::size_t>(x.size()));
    }
    static Range halved(Range fine) { return {half_down(fine.first), half_down(fine.last)}; }

    // A row must stay where it is until the next one has been pushed.
    void push(const T* row) {
        if (!top_) {
            top_ = row;
            return;
        }
        step(top_, row);
        top_ = nullptr;
    }

    void finish() {
        if (top_) step(top_, zero_.data());
        if (next_) next_->finish();
    }

  private:
    void step(const T* __restrict top, const T* __restrict bottom) {
        T* __restrict a =
            next_ ? approximation_[done_ % 2].data() : coarse_->values.row(done_).data();
        T* __restrict phi_psi = detail_.phi_psi.values.row(done_).data();
        T* __restrict psi_phi = detail_.psi_phi.values.row(done_).data();
        T* __restrict psi_psi = detail_.psi_psi.values.row(done_).data();
        const auto block = [&](int i, T p0, T p1, T q0, T q1) {
            const T top_sum = p0 + p1, top_difference = p0 - p1;
            const T bottom_sum = q0 + q1, bottom_difference = q0 - q1;
            a[i] = (top_sum + bottom_sum) / 4;
            phi_psi[i] = (top_sum - bottom_sum) / 4;
            psi_phi[i] = (top_difference + bottom_difference) / 4;
            psi_psi[i] = (top_difference - bottom_difference) / 4;
        };
        const int pairs = width_ / 2;
        for (int i = 0; i < pairs; ++i)
            block(i, top[2 * i], top[2 * i + 1], bottom[2 * i], bottom[2 * i + 1]);
        if (2 * pairs < width_) block(pairs, top[2 * pairs], T(0), bottom[2 * pairs], T(0));
        ++done_;
        if (next_) next_->push(a);
    }

    int width_;
    Eigen::Index done_ = 0;
    Detail<T>& detail_;
    HaarAnalyser* next_;
    Band<T>* coarse_;
    const T* top_ = nullptr;
    const std::vector<T> zero_;
    std::vector<T> approximation_[2];
};

template <class T>
class HaarSynthesiser {
  public:
    HaarSynthesiser(const IndexRect& rect, const Detail<T>& detail, HaarSynthesiser* coarser,
                    const Band<T>* coarse)
        : width_(rect.x.size()), detail_(detail), coarser_(coarser), coarse_(coarse) {
        for (std::vector<T>& row : rows_) row.resize(static_cast<std::size_t>(width_));
    }

    // The next two rows, straight to where they belong.
    void pull_pair(T* __restrict top, T* __restrict bottom) {
        const T* __restrict a = coarser_ ? coarser_->pull() : coarse_->values.row(done_).data();
        const T* __restrict phi_psi = detail_.phi_psi.values.row(done_).data();
        const T* __restrict psi_phi = detail_.psi_phi.values.row(done_).data();
        const T* __restrict psi_psi = detail_.psi_psi.values.row(done_).data();
        ++done_;
        const int pairs = width_ / 2;
        for (int i = 0; i < pairs; ++i) {
            const T top_sum = a[i] + phi_psi[i], bottom_sum = a[i] - phi_psi[i];
            const T top_difference = psi_phi[i] + psi_psi[i];
            const T bottom_difference = psi_phi[i] - psi_psi[i];
            top[2 * i] = top_sum + top_difference;
            top[2 * i + 1] = top_sum - top_difference;
            bottom[2 * i] = bottom_sum + bottom_difference;
            bottom[2 * i + 1] = bottom_sum - bottom_difference;
        }
        if (2 * pairs < width_) {
            top[2 * pairs] = a[pairs] + phi_psi[pairs] + (psi_phi[pairs] + psi_psi[pairs]);
            bottom[2 * pairs] = a[pairs] - phi_psi[pairs] + (psi_phi[pairs] - psi_psi[pairs]);
        }
    }
    // Space for a row below the last.
    T* spare_row() { return rows_[1].data(); }

  private:
    const T* pull() {
        second_ = !second_;
        if (!second_) return rows_[1].data();
        pull_pair(rows_[0].data(), rows_[1].data());
        return rows_[0].data();
    }

    int width_;
    Eigen::Index done_ = 0;
    bool second_ = false;  // the next pull() returns the second row of the pair
    const Detail<T>& detail_;
    HaarSynthesiser* coarser_;
    const Band<T>* coarse_;
    std::vector<T> rows_[2];
};

// Rectangles of the approximations, coarsest first; the last is `rect`.
std::vector<IndexRect> chain(int degree, const IndexRect& rect, std::size_t levels) {
    const auto coarser = [&](Range fine) {
        return degree == 0 ? HaarAnalyser<float>::halved(fine) : Span(fine).low();
    };
    std::vector<IndexRect> rects(levels + 1, rect);
    for (std::size_t l = levels; l > 0; --l)
        rects[l - 1] = {coarser(rects[l].x), coarser(rects[l].z)};
    return rects;
}

template <class Analyser, class T>
void split(int degree, const Grid<T>& fine, const IndexRect& rect, std::span<Detail<T>> details,
           Band<T>& coarse) {
    const std::vector<IndexRect> rects = chain(degree, rect, details.size());
    std::vector<Analyser> levels;
    levels.reserve(details.size());  // they point at each other
    for (std::size_t l = 0; l < details.size(); ++l)
        levels.emplace_back(rects[l + 1], details[l], l == 0 ? nullptr : &levels[l - 1],
                            l == 0 ? &coarse : nullptr);
    for (Eigen::Index j = 0; j < fine.rows(); ++j) levels.back().push(fine.row(j).data());
    levels.back().finish();
}

template <class Synthesiser, class T, class Rows>
void merge(int degree, const Band<T>& coarse, std::span<const Detail<T>> details,
           const IndexRect& rect, Grid<T>& fine, const Rows& rows) {
    const std::vector<IndexRect> rects = chain(degree, rect, details.size());
    std::vector<Synthesiser> levels;
    levels.reserve(details.size());
    for (std::size_t l = 0; l < details.size(); ++l)
        levels.emplace_back(rects[l + 1], details[l], l == 0 ? nullptr : &levels[l - 1],
                            l == 0 ? &coarse : nullptr);
    fine.resize(rect.z.size(), rect.x.size());
    rows(levels.back());
}

}  // namespace

bool has_lifting(const Family& family, Boundary boundary) {
    return boundary == Boundary::zero && family.kind == Family::Kind::cdf &&
           ((family.degree == 0 && family.dual_moments == 1) ||
            (family.degree == 1 && family.dual_moments == 2));
}

template <class T>
void lifting_split(int degree, const Grid<T>& fine, const IndexRect& rect,
                   std::span<Detail<T>> details, Band<T>& coarse) {
    if (degree == 0)
        split<HaarAnalyser<T>>(degree, fine, rect, details, coarse);
    else
        split<LinearAnalyser<T>>(degree, fine, rect, details, coarse);
}

template <class T>
void lifting_merge(int degree, const Band<T>& coarse, std::span<const Detail<T>> details,
                   const IndexRect& rect, Grid<T>& fine) {
    if (degree == 0)
        merge<HaarSynthesiser<T>>(degree, coarse, details, rect, fine, [&](auto& finest) {
            for (Eigen::Index j = 0; j < fine.rows(); j += 2)
                finest.pull_pair(fine.row(j).data(),
                                 j + 1 < fine.rows() ? fine.row(j + 1).data() : finest.spare_row());
        });
    else
        merge<LinearSynthesiser<T>>(degree, coarse, details, rect, fine, [&](auto& finest) {
            for (Eigen::Index j = 0; j < fine.rows(); ++j) finest.pull(fine.row(j).data());
        });
}

#define WAVEFOG_INSTANTIATE(T)                                                                     \
    template void lifting_split(int, const Grid<T>&, const IndexRect&, std::span<Detail<T>>,       \
                                Band<T>&);                                                         \
    template void lifting_merge(int, const Band<T>&, std::span<const Detail<T>>, const IndexRect&, \
                                Grid<T>&);
WAVEFOG_INSTANTIATE(float)
WAVEFOG_INSTANTIATE(double)
#undef WAVEFOG_INSTANTIATE

}  // namespace wavefog
