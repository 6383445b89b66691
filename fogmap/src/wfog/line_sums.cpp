#include "line_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "parallel.h"
#include "vector_clones.h"

// Lines that climb by 0 to 1 pixel a column; all others follow by transposing and mirroring.
//
// A B-spline surface of degree 1 is the mean of its columns sum_i L(x - i) F_i(z), F_i linear
// between pixels, so that an integral along a segment is a mean of sums of F_i over successive
// columns, at places that lie on a parallel line (for degree 2 too, a mean of shifted surfaces of
// degree 1; for degree 0, F_i is constant in a pixel). What bounds the sums bounds the integral.
//
// A line's place in column i is y_i; in q parts of a pixel, Z_i = floor(y_i + U) is a digital line
// for any U in [0, 1), y_i its mean over U. Of any three equally distant columns, Z in the middle
// is the mean of the others, rounded up or down. Hence all digital lines are among those that
// bisection gives: from a strip of columns, entered at a and left at a + o, one twice as wide by
// either rounding of its middle (as in the fast Radon transforms of Goetz and Druck, 1996, and
// Brady, 1998, which know one rounding). For every (a, o) a strip keeps the largest total, the
// largest sum from its left and to its right edge, and the largest sum of all (Kadane).
//
// In a strip of kLeaf columns, sums are those along the straight line from a to a + o. A mean over
// U of F_i there is F_i(y_i), unless F_i bends between: by up to 2 d (1 - d) / q / 2 of the bend,
// if the line passes d parts beside the pixel. That is added where F_i bends down.
namespace wavefog::wfog {

using std::size_t;

namespace {

constexpr size_t kLeaf = 16;
constexpr size_t kLanes = 32;

using Lanes = std::array<float, kLanes>;

/// Largest sums of lines through a strip: of all its columns, from the left, and to the right; by
/// where lines enter (a) and how far they climb (o), in parts: at [o * rows + a].
struct Strip {
    explicit Strip(size_t sums)
        : total(std::make_unique_for_overwrite<float[]>(sums)),
          left(std::make_unique_for_overwrite<float[]>(sums)),
          right(std::make_unique_for_overwrite<float[]>(sums)) {}

    std::unique_ptr<float[]> total, left, right;
};

float larger(float a, float b) {
    return a > b ? a : b;
}

/// The sums of a strip from one of its lines on.
struct Sums {
    float *total, *left, *right;

    Sums(const Strip& strip, size_t at)
        : total(&strip.total[at]), left(&strip.left[at]), right(&strip.right[at]) {}
};

/// Sums over columns whose values at place a are columns[i][a].
WAVEFOG_VECTOR_CLONES
float add_columns(const std::array<const float*, kLeaf>& columns, size_t count, Sums sums) {
    Lanes best{};
    for (size_t first = 0; first < count; first += kLanes) {
        const size_t lanes = std::min(kLanes, count - first);
        Lanes t{}, l{}, r{};
        for (const float* column : columns)
            for (size_t k = 0; k < kLanes; ++k) {
                const float value = column[first + k];
                t[k] += value;
                l[k] = larger(l[k], t[k]);
                r[k] = larger(r[k] + value, 0);
                best[k] = larger(best[k], r[k]);
            }
        std::copy_n(t.begin(), lanes, sums.total + first);
        std::copy_n(l.begin(), lanes, sums.left + first);
        std::copy_n(r.begin(), lanes, sums.right + first);
    }
    return *std::max_element(best.begin(), best.end());
}

/// Lines through a and then b; `more` than those that `both` has already.
template <bool more>
[[gnu::always_inline]] inline void join_line(Sums a, Sums b, Sums both, size_t i, float& best) {
    const float total = a.total[i] + b.total[i];
    const float left = larger(a.left[i], a.total[i] + b.left[i]);
    const float right = larger(b.right[i], b.total[i] + a.right[i]);
    both.total[i] = more ? larger(both.total[i], total) : total;
    both.left[i] = more ? larger(both.left[i], left) : left;
    both.right[i] = more ? larger(both.right[i], right) : right;
    best = larger(best, a.right[i] + b.left[i]);
}

template <bool more>
[[gnu::always_inline]] inline float join_lines(Sums a, Sums b, Sums both, size_t count) {
    Lanes best{};
    size_t i = 0;
    for (; i + kLanes <= count; i += kLanes)
        for (size_t k = 0; k < kLanes; ++k) join_line<more>(a, b, both, i + k, best[k]);
    for (; i < count; ++i) join_line<more>(a, b, both, i, best[0]);
    return *std::max_element(best.begin(), best.end());
}

WAVEFOG_VECTOR_CLONES
float join(Sums a, Sums b, Sums both, size_t count, bool more) {
    return more ? join_lines<true>(a, b, both, count) : join_lines<false>(a, b, both, count);
}

WAVEFOG_VECTOR_CLONES
float join_best(const float* right, const float* left, size_t count) {
    Lanes best{};
    size_t i = 0;
    for (; i + kLanes <= count; i += kLanes)
        for (size_t k = 0; k < kLanes; ++k) best[k] = larger(best[k], right[i + k] + left[i + k]);
    for (; i < count; ++i) best[0] = larger(best[0], right[i] + left[i]);
    return *std::max_element(best.begin(), best.end());
}

/// Lines that climb, through pixels of (column, row). Rows repeat: a line that leaves the map
/// above comes in again below, with what is outside between them; no bound gets smaller by that.
class Climbing {
  public:
    /// Rows become columns if transposed, and their order is turned if mirrored.
    Climbing(const LineField& field, bool transposed, bool mirrored, int parts)
        : columns_(columns_of(field, transposed, mirrored)),
          outside_(field.outside),
          repeats_(field.repeats),
          nearest_(field.degree == 0),
          cell_(transposed ? field.cell_z : field.cell_x),
          climb_(transposed ? field.cell_x : field.cell_z),
          parts_(static_cast<size_t>(parts)),
          rows_(static_cast<size_t>(columns_.cols()) * parts_) {}

    double most(double longest, const std::stop_token& stop) {
        // Sums over so many columns lie in two neighbouring strips.
        const auto count = static_cast<double>(columns_.rows());
        const double reach = longest / cell_ + 1;
        const double needed = repeats_ ? reach : std::min(reach, std::ceil(count / 2));
        size_t width = kLeaf;
        while (double(width) < needed && 2 * width * parts_ * rows_ <= kMostSums) width *= 2;
        const double strips = std::ceil(count / double(width)) + (repeats_ ? 1 : 0);
        const double pieces = strips > 2 ? std::ceil(reach / double(width)) : 1;
        std::optional<Strip> before;
        for (size_t s = 0; double(s) < strips && !stop.stop_requested(); ++s) {
            Strip strip = strip_of(s * width, width);
            if (before) {
                join_best(*before, strip, 2 * width);
                spare_[width].push_back(std::move(*before));
            }
            before = std::move(strip);
        }
        // Sums of floats are off by half a last bit for each addition, of which none is behind
        // more.
        const double most_value = std::max(double(columns_.abs().maxCoeff()), -double(outside_));
        const double additions = 2 * kLeaf + 8 + 2 * std::log2(double(width));
        const double rounding =
            additions * 0x1p-24 * 2 * double(width) * most_value * std::hypot(cell_, climb_);
        return (best_ + rounding) * pieces;
    }

  private:
    /// Of a kind, in a strip: 128 MiB in all. Longer segments are several.
    static constexpr size_t kMostSums = (size_t{1} << 27) / (3 * sizeof(float));

    static Grid<float> columns_of(const LineField& field, bool transposed, bool mirrored) {
        const Grid<float>& pixels = field.pixels;
        const Eigen::Index count = transposed ? pixels.rows() : pixels.cols();
        const Eigen::Index rows = transposed ? pixels.cols() : pixels.rows();
        // Beside what does not repeat, one row of what is outside.
        Grid<float> columns =
            Grid<float>::Constant(count, rows + (field.repeats ? 0 : 1), field.outside);
        for (Eigen::Index j = 0; j < rows; ++j) {
            const Eigen::Index row = mirrored ? rows - 1 - j : j;
            for (Eigen::Index i = 0; i < count; ++i)
                columns(i, row) = transposed ? pixels(i, j) : pixels(j, i);
        }
        return columns;
    }

    size_t climbs(size_t width) const { return width * parts_ + 1; }

    Strip strip_of(size_t first, size_t width) {
        // Memory of strips that are done with is at hand already.
        std::vector<Strip>& spare = spare_[width];
        if (spare.empty()) spare.emplace_back(climbs(width) * rows_);
        Strip strip = std::move(spare.back());
        spare.pop_back();
        if (width == kLeaf) {
            add_columns(first, strip);
            return strip;
        }
        Strip a = strip_of(first, width / 2), b = strip_of(first + width / 2, width / 2);
        join(a, b, width, strip);
        spare_[width / 2].push_back(std::move(a));
        spare_[width / 2].push_back(std::move(b));
        return strip;
    }

    /// `sum` was found on a line that climbs by o or up to one more in `width` columns.
    void found(float sum, size_t o, size_t width) {
        const double slope = std::min(double(o + 1) / double(width * parts_), 1.0);
        best_ = std::max(best_, double(sum) * std::hypot(cell_, slope * climb_));
    }

    /// Values in a column at a + phase / kLeaf parts, for all phases and a, the first of them again
    /// after the last.
    void sample(size_t column, float* values) {
        const auto count = static_cast<size_t>(columns_.cols());
        if (!repeats_ && column >= static_cast<size_t>(columns_.rows())) {
            std::fill_n(values, kLeaf * row_, outside_);
            return;
        }
        const float* pixel = &columns_(static_cast<Eigen::Index>(column) % columns_.rows(), 0);
        rise_.resize(count);
        down_.resize(count + 1);
        for (size_t j = 0; j < count; ++j) {
            const float next = pixel[(j + 1) % count], before = pixel[(j + count - 1) % count];
            rise_[j] = next - pixel[j];
            down_[j] = larger(2 * pixel[j] - before - next, 0);
        }
        down_[count] = down_[0];
        const auto bend = [&](double distance) {
            return distance < 1 ? static_cast<float>(distance * (1 - distance) / double(parts_))
                                : 0.0f;
        };
        for (size_t phase = 0; phase < kLeaf; ++phase, values += row_) {
            for (size_t r = 0; r < parts_; ++r) {
                const double at = double(r) + double(phase) / double(kLeaf);  // parts above pixel j
                if (nearest_) {
                    // A line that passes a pixel's edge may be on either side.
                    const bool edge = r + 1 == parts_ && phase > 0;
                    for (size_t j = 0; j < count; ++j)
                        values[j * parts_ + r] = pixel[j] + (edge ? larger(rise_[j], 0) : 0);
                    continue;
                }
                const auto share = static_cast<float>(at / double(parts_));
                const float low = bend(at), high = bend(double(parts_) - at);
                for (size_t j = 0; j < count; ++j)
                    values[j * parts_ + r] =
                        pixel[j] + share * rise_[j] + low * down_[j] + high * down_[j + 1];
            }
            for (size_t a = rows_; a < row_; ++a) values[a] = values[a - rows_];
        }
    }

    void add_columns(size_t first, Strip& strip) {
        samples_.resize(kLeaf * kLeaf * row_);
        for (size_t i = 0; i < kLeaf; ++i) sample(first + i, &samples_[i * kLeaf * row_]);
        for (size_t o = 0; o < climbs(kLeaf); ++o) {
            std::array<const float*, kLeaf> columns;
            for (size_t i = 0; i < kLeaf; ++i)
                columns[i] = &samples_[(i * kLeaf + o * i % kLeaf) * row_ + o * i / kLeaf];
            found(wfog::add_columns(columns, rows_, Sums(strip, o * rows_)), o, kLeaf);
        }
    }

    /// body(at in the first, at in the second, at in both, how many, more than there are already)
    /// for runs of lines that climb by o and, rounded either way, by half of it in the first strip.
    template <class Body>
    void for_halves(size_t o, Body body) const {
        for (size_t climb = o / 2; climb <= (o + 1) / 2; ++climb) {
            const size_t first = climb * rows_, second = (o - climb) * rows_, both = o * rows_;
            const size_t up = climb % rows_, before = rows_ - up;
            const bool more = climb > o / 2;
            body(first, second + up, both, before, more);
            body(first + before, second, both + before, up, more);
        }
    }

    void join(const Strip& a, const Strip& b, size_t width, Strip& both) {
        for (size_t o = 0; o < climbs(width); ++o)
            for_halves(o, [&](size_t in_a, size_t in_b, size_t in_both, size_t count, bool more) {
                if (count == 0) return;
                found(wfog::join(Sums(a, in_a), Sums(b, in_b), Sums(both, in_both), count, more), o,
                      width);
            });
    }

    /// Only the largest sums of lines that are in both.
    void join_best(const Strip& a, const Strip& b, size_t width) {
        for (size_t o = 0; o < climbs(width); ++o)
            for_halves(o, [&](size_t in_a, size_t in_b, size_t, size_t count, bool) {
                if (count == 0) return;
                found(wfog::join_best(&a.right[in_a], &b.left[in_b], count), o, width);
            });
    }

    const Grid<float> columns_;  ///< (column, row)
    const float outside_;
    const bool repeats_, nearest_;
    const double cell_, climb_;
    const size_t parts_, rows_;
    const size_t row_ = rows_ + kLeaf * parts_ + kLanes;  ///< of samples
    std::map<size_t, std::vector<Strip>> spare_;          ///< by width
    std::vector<float> rise_, down_, samples_;
    double best_ = 0;
};

}  // namespace

double most_along_lines(std::span<const LineField> fields, double longest, int parts, int threads,
                        const std::stop_token& stop) {
    std::vector<double> most(4 * fields.size(), 0);
    for_each_parallel(most.size(), threads, stop, [&](size_t i, Scratch&) {
        most[i] = Climbing(fields[i / 4], i % 2 > 0, i % 4 > 1, parts).most(longest, stop);
    });
    return most.empty() ? 0 : std::ranges::max(most);
}

}  // namespace wavefog::wfog
