#include "line_sums.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
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
constexpr size_t kLanes = 16;

using Lanes = std::array<float, kLanes>;

/// Largest sums of lines through a strip: of all its columns, from the left, and to the right.
struct Sums {
    float *total, *left, *right;

    Sums from(size_t at) const { return {total + at, left + at, right + at}; }
};

float larger(float a, float b) {
    return a > b ? a : b;
}

float largest(const Lanes& lanes) {
    return *std::max_element(lanes.begin(), lanes.end());
}

/// Lines meet pixel + share * rise + bend * down in a column; where a part is a whole pixel, so
/// that the next one is near too, + next_bend * down[1].
struct Crossing {
    const float *pixel, *rise, *down;
    float share, bend, next_bend;
};

template <bool whole>
[[gnu::always_inline]] inline float add_lines(const std::array<Crossing, kLeaf>& columns,
                                              size_t count, float* __restrict total,
                                              float* __restrict left, float* __restrict right) {
    Lanes best{};
    for (size_t i = 0; i < count; i += kLanes) {
        Lanes t{}, l{}, r{};
        for (const Crossing& c : columns)
            for (size_t k = 0; k < kLanes; ++k) {
                float value = c.pixel[i + k] + c.share * c.rise[i + k] + c.bend * c.down[i + k];
                if (whole) value += c.next_bend * c.down[i + k + 1];
                t[k] += value;
                l[k] = larger(l[k], t[k]);
                r[k] = larger(r[k] + value, 0);
                best[k] = larger(best[k], r[k]);
            }
        for (size_t k = 0; k < kLanes; ++k) {
            total[i + k] = t[k];
            left[i + k] = l[k];
            right[i + k] = r[k];
        }
    }
    return largest(best);
}

/// Sums over columns, and the largest one. Here as below, `count` is rounded up to whole kLanes.
WAVEFOG_VECTOR_CLONES
float add_columns(const std::array<Crossing, kLeaf>& columns, bool whole, size_t count, Sums sums) {
    const auto [total, left, right] = sums;
    return whole ? add_lines<true>(columns, count, total, left, right)
                 : add_lines<false>(columns, count, total, left, right);
}

/// Lines through a and then b.
struct Halves {
    Sums a, b;
};

template <bool two>
[[gnu::always_inline]] inline float join_lines(const Halves& one, const Halves& other, size_t count,
                                               float* __restrict total, float* __restrict left,
                                               float* __restrict right) {
    // Copies, so that no store can change the pointers.
    const auto [a_total, a_left, a_right] = one.a;
    const auto [b_total, b_left, b_right] = one.b;
    const auto [c_total, c_left, c_right] = other.a;
    const auto [d_total, d_left, d_right] = other.b;
    Lanes best{};
    for (size_t first = 0; first < count; first += kLanes)
        for (size_t k = 0; k < kLanes; ++k) {
            const size_t i = first + k;
            float t = a_total[i] + b_total[i];
            float l = larger(a_left[i], a_total[i] + b_left[i]);
            float r = larger(b_right[i], b_total[i] + a_right[i]);
            float most = a_right[i] + b_left[i];
            if (two) {
                t = larger(t, c_total[i] + d_total[i]);
                l = larger(l, larger(c_left[i], c_total[i] + d_left[i]));
                r = larger(r, larger(d_right[i], d_total[i] + c_right[i]));
                most = larger(most, c_right[i] + d_left[i]);
            }
            total[i] = t;
            left[i] = l;
            right[i] = r;
            best[k] = larger(best[k], most);
        }
    return largest(best);
}

/// Of each, the larger one of `one` and, if there are `two`, of `other`.
WAVEFOG_VECTOR_CLONES
float join(const Halves& one, const Halves& other, bool two, size_t count, Sums both) {
    const auto [total, left, right] = both;
    return two ? join_lines<true>(one, other, count, total, left, right)
               : join_lines<false>(one, other, count, total, left, right);
}

WAVEFOG_VECTOR_CLONES
float join_best(const float* right, const float* left, size_t count) {
    Lanes best{};
    for (size_t i = 0; i < count; i += kLanes)
        for (size_t k = 0; k < kLanes; ++k) best[k] = larger(best[k], right[i + k] + left[i + k]);
    return largest(best);
}

/// Lines that climb, through pixels of (column, row). Rows repeat: a line that leaves the map
/// above comes in again below, with what is outside between them; no bound gets smaller by that.
///
/// A strip's sums are by how far lines climb (o) and where they enter (a = pixel * parts + part):
/// at [(o * parts + part) * stride + pixel], with the first pixels again after the last, so that
/// loops may go on to whole kLanes. Lines that climb by about as much, in all strips, need no
/// others: a few climbs at a time, all stays in the processor's caches.
class Climbing {
  public:
    /// Rows become columns if transposed, and their order is turned if mirrored.
    Climbing(const LineField& field, bool transposed, bool mirrored, int parts, Scratch& scratch)
        : outside_(field.outside),
          repeats_(field.repeats),
          nearest_(field.degree == 0),
          cell_(transposed ? field.cell_z : field.cell_x),
          climb_(transposed ? field.cell_x : field.cell_z),
          parts_(static_cast<size_t>(parts)),
          columns_(static_cast<size_t>(transposed ? field.pixels.rows() : field.pixels.cols())),
          // Beside what does not repeat, one row of what is outside.
          rows_(static_cast<size_t>(transposed ? field.pixels.cols() : field.pixels.rows()) +
                (repeats_ ? 0 : 1)),
          scratch_(scratch) {
        scratch.clear();
        met_ = scratch.take<float>(3 * kLeaf * met_stride_);
        take_pixels(field.pixels, transposed, mirrored);
        for (size_t above = 0; above < parts_ * kLeaf; ++above)
            crossings_.push_back(crossing(double(above) / double(kLeaf)));
    }

    double most(double longest, const std::stop_token& stop) {
        // Sums over so many columns lie in two neighbouring strips.
        const auto count = static_cast<double>(columns_);
        const double reach = longest / cell_ + 1;
        const double needed = repeats_ ? reach : std::min(reach, std::ceil(count / 2));
        size_t width = kLeaf;
        while (double(width) < needed && 2 * width * parts_ * parts_ * rows_ <= kMostSums)
            width *= 2;
        const double strips = std::ceil(count / double(width)) + (repeats_ ? 1 : 0);
        const double pieces = strips > 2 ? std::ceil(reach / double(width)) : 1;
        while (together_ > 1 && together_ * (width / kLeaf) * parts_ * stride_ > kCached)
            together_ /= 2;
        for (size_t w = kLeaf; w < width; w *= 2) halves_.push_back({take(w), take(w)});
        Sums strip = take(width), before = take(width);
        for (lowest_ = 0; lowest_ < kLeaf * parts_; lowest_ += together_)
            for (size_t s = 0; double(s) < strips && !stop.stop_requested(); ++s) {
                make(s * width, width, strip);
                if (s > 0) join_best(before, strip, 2 * width);
                std::swap(before, strip);
            }
        // Sums of floats are off by half a last bit for each addition, of which none is behind
        // more.
        const double additions = 2 * kLeaf + 8 + 2 * std::log2(double(width));
        const double rounding = additions * 0x1p-24 * 2 * double(width) * double(most_value_) *
                                std::hypot(cell_, climb_);
        return (best_ + rounding) * pieces;
    }

  private:
    /// Of a kind, in a strip, for all climbs. Longer segments are several.
    static constexpr size_t kMostSums = (size_t{1} << 31) / (3 * sizeof(float));
    /// Of those, for climbs that are looked at together: their first is their neighbours' last,
    /// so that too few cost more than they save.
    static constexpr size_t kCached = 160000;

    /// Columns one after another.
    void take_pixels(const Grid<float>& pixels, bool transposed, bool mirrored) {
        pixels_ = scratch_.take<float>(columns_ * rows_);
        const size_t inside = rows_ - (repeats_ ? 0 : 1);
        most_value_ = -outside_;
        for (size_t i = 0; i < columns_; ++i) {
            float* const column = &pixels_[i * rows_];
            const auto at = static_cast<Eigen::Index>(i);
            for (size_t j = 0; j < inside; ++j) {
                const auto row = static_cast<Eigen::Index>(mirrored ? inside - 1 - j : j);
                column[j] = transposed ? pixels(at, row) : pixels(row, at);
            }
            std::fill_n(column + inside, rows_ - inside, outside_);
            for (size_t j = 0; j < rows_; ++j)
                most_value_ = larger(std::fabs(column[j]), most_value_);
        }
    }

    /// Of those that are looked at together, in a strip: the first, and how many.
    size_t first_climb(size_t width) const { return lowest_ * (width / kLeaf); }
    size_t climbs(size_t width) const { return together_ * (width / kLeaf) + 1; }

    Sums take(size_t width) {
        const size_t count = climbs(width) * parts_ * stride_;
        const auto sums = [&] { return scratch_.take<float>(count).data(); };
        return {sums(), sums(), sums()};
    }

    void make(size_t first, size_t width, Sums strip) {
        if (width == kLeaf) {
            add_columns(first, strip);
            return;
        }
        const auto& [a, b] = halves_[static_cast<size_t>(std::countr_zero(width / 2 / kLeaf))];
        make(first, width / 2, a);
        make(first + width / 2, width / 2, b);
        join(a, b, width, strip);
    }

    /// `sum` was found on a line that climbs by o or up to one more in `width` columns.
    void found(float sum, size_t o, size_t width) {
        const double slope = std::min(double(o + 1) / double(width * parts_), 1.0);
        best_ = std::max(best_, double(sum) * std::hypot(cell_, slope * climb_));
    }

    const float* pixel_of(size_t place) const { return &met_[place * met_stride_]; }
    const float* rise_of(size_t place) const { return pixel_of(kLeaf + place); }
    const float* down_of(size_t place) const { return pixel_of(2 * kLeaf + place); }

    /// What lines meet in a column, which is at `place` in its strip.
    void meet(size_t column, size_t place) {
        float* const pixel = &met_[place * met_stride_];
        float* const rise = pixel + kLeaf * met_stride_;
        float* const down = rise + kLeaf * met_stride_;
        if (!repeats_ && column >= columns_) {
            std::fill_n(pixel, met_stride_, outside_);
            std::fill_n(rise, met_stride_, 0.0f);
            std::fill_n(down, met_stride_, 0.0f);
            return;
        }
        std::copy_n(&pixels_[column % columns_ * rows_], rows_, pixel);
        for (size_t j = rows_; j < met_stride_; ++j) pixel[j] = pixel[j - rows_];
        const size_t last = met_stride_ - 1;
        for (size_t j = 0; j < last; ++j) rise[j] = pixel[j + 1] - pixel[j];
        if (nearest_) {
            // A line that passes a pixel's edge may be on either side.
            for (size_t j = 0; j < last; ++j) rise[j] = larger(rise[j], 0);
            std::fill_n(down, last, 0.0f);
            return;
        }
        for (size_t j = 1; j < last; ++j)
            down[j] = larger(2 * pixel[j] - pixel[j - 1] - pixel[j + 1], 0);
        down[0] = down[rows_];
    }

    /// Of lines that are so many parts above a pixel, without what they meet.
    Crossing crossing(double parts) const {
        Crossing c{};
        if (nearest_) {
            c.share = parts > double(parts_ - 1) ? 1 : 0;
            return c;
        }
        const auto bend = [&](double distance) {
            return distance < 1 ? static_cast<float>(distance * (1 - distance) / double(parts_))
                                : 0.0f;
        };
        c.share = static_cast<float>(parts / double(parts_));
        c.bend = bend(parts);
        c.next_bend = bend(double(parts_) - parts);
        return c;
    }

    void add_columns(size_t first, Sums strip) {
        for (size_t i = 0; i < kLeaf; ++i) meet(first + i, i);
        for (size_t o = 0; o < climbs(kLeaf); ++o) {
            float best = 0;
            for (size_t part = 0; part < parts_; ++part) {
                std::array<Crossing, kLeaf> columns;
                for (size_t i = 0; i < kLeaf; ++i) {
                    const size_t climb = (first_climb(kLeaf) + o) * i;
                    const Place at = up(part, climb / kLeaf);
                    columns[i] = crossings_[at.part * kLeaf + climb % kLeaf];
                    columns[i].pixel = pixel_of(i) + at.pixel;
                    columns[i].rise = rise_of(i) + at.pixel;
                    columns[i].down = down_of(i) + at.pixel;
                    if (parts_ > 1 && columns[i].next_bend > 0) {
                        columns[i].bend = columns[i].next_bend;
                        ++columns[i].down;
                    }
                }
                const Sums sums = strip.from((o * parts_ + part) * stride_);
                best = larger(best, wfog::add_columns(columns, parts_ == 1, rows_, sums));
                repeat(sums);
            }
            found(best, first_climb(kLeaf) + o, kLeaf);
        }
    }

    /// The first pixels after the last.
    void repeat(Sums sums) const {
        for (float* const row : {sums.total, sums.left, sums.right})
            for (size_t k = 0; k < kLanes; ++k) row[rows_ + k] = row[k];
    }

    struct Place {
        size_t pixel, part;
    };
    /// `climb` parts above a part of pixel 0.
    Place up(size_t part, size_t climb) const {
        const auto above = static_cast<unsigned>(part + climb);  // divides sooner
        const auto parts = static_cast<unsigned>(parts_);
        return {above / parts, above % parts};
    }

    /// Where lines that go through two strips are in the sums of each.
    struct InBoth {
        size_t a, b;
    };

    /// body(one, other, in both, how many) for runs of lines that climb by the o-th of `width`:
    /// in a by half of that, which `one` rounds down and `other` up, and in b by the rest.
    template <class Body>
    void for_halves(size_t o, size_t width, Body body) const {
        const size_t low = o / 2, high = o - low;
        for (size_t part = 0; part < parts_; ++part) {
            const size_t climb = first_climb(width / 2) + low;
            const Place one = up(part, climb), other = up(part, climb + 1);
            const auto at = [&](size_t half, size_t in) { return (half * parts_ + in) * stride_; };
            const auto run = [&](size_t first, size_t in_b, size_t count) {
                const size_t in_other = in_b + other.pixel - one.pixel;
                body(InBoth{at(low, part) + first, at(high, one.part) + in_b},
                     InBoth{at(high, part) + first, at(low, other.part) + in_other},
                     at(o, part) + first, count);
            };
            // What is above the map is its lowest pixels again.
            const size_t shift = one.pixel % rows_;
            run(0, shift, rows_ - shift);
            if (shift > 0) run(rows_ - shift, 0, shift);
        }
    }

    void join(Sums a, Sums b, size_t width, Sums both) {
        for (size_t o = 0; o < climbs(width); ++o) {
            float best = 0;
            for_halves(o, width, [&](InBoth one, InBoth other, size_t in_both, size_t count) {
                const float most =
                    wfog::join({a.from(one.a), b.from(one.b)}, {a.from(other.a), b.from(other.b)},
                               o % 2 > 0, count, both.from(in_both));
                best = larger(best, most);
            });
            for (size_t part = 0; part < parts_; ++part)
                repeat(both.from((o * parts_ + part) * stride_));
            found(best, first_climb(width) + o, width);
        }
    }

    /// Only the largest sums of lines that are in both.
    void join_best(Sums a, Sums b, size_t width) {
        for (size_t o = 0; o < climbs(width); ++o) {
            float best = 0;
            for_halves(o, width, [&](InBoth one, InBoth other, size_t, size_t count) {
                best = larger(best, wfog::join_best(a.right + one.a, b.left + one.b, count));
                if (o % 2 > 0)
                    best =
                        larger(best, wfog::join_best(a.right + other.a, b.left + other.b, count));
            });
            found(best, first_climb(width) + o, width);
        }
    }

    const float outside_;
    const bool repeats_, nearest_;
    const double cell_, climb_;
    const size_t parts_, columns_, rows_;
    const size_t stride_ = (rows_ + 2 * kLanes - 1) / kLanes * kLanes;
    const size_t met_stride_ = (rows_ + kLeaf + 2 * kLanes) / kLanes * kLanes;
    Scratch& scratch_;
    std::vector<Crossing> crossings_;  ///< by kLeaf-ths of a part above a pixel
    std::span<float> pixels_;
    std::span<float> met_;  ///< in a leaf's columns: pixels, then rises, then what bends down
    float most_value_ = 0;
    size_t lowest_ = 0, together_ = kLeaf;     ///< climbs of a leaf
    std::vector<std::array<Sums, 2>> halves_;  ///< of strips, by their width
    double best_ = 0;
};

}  // namespace

double most_along_lines(std::span<const LineField> fields, double longest, int parts, int threads,
                        const std::stop_token& stop) {
    std::vector<double> most(4 * fields.size(), 0);
    for_each_parallel(most.size(), threads, stop, [&](size_t i, Scratch& scratch) {
        most[i] = Climbing(fields[i / 4], i % 2 > 0, i % 4 > 1, parts, scratch).most(longest, stop);
    });
    return most.empty() ? 0 : std::ranges::max(most);
}

}  // namespace wavefog::wfog
