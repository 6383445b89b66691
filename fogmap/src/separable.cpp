#include "separable.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wavefog::detail {
namespace {

using Eigen::Vector3d;

/// A table along a segment, in cells from its first value: at + slope t.
struct Line {
    const AxisTable* table;
    double cells;
    double at = 0, slope = 0;

    Line(const AxisTable& axis, double start, double path)
        : table(&axis), cells(static_cast<double>(axis.values.size()) - 1) {
        if (axis.values.empty()) return;
        const double per_metre = cells / (axis.end - axis.begin);
        at = (start - axis.begin) * per_metre;
        slope = path * per_metre;
    }

    double value(double u) const {
        if (table->values.empty()) return 1;
        if (table->repeat) u -= cells * std::floor(u / cells);
        u = std::clamp(u, 0.0, cells);
        const double cell = std::min(std::floor(u), cells - 1);
        const double* v = &table->values[static_cast<std::size_t>(cell)];
        return v[0] + (u - cell) * (v[1] - v[0]);
    }

    /// Over [a, b], cell by cell: the middle of a straight line is its mean.
    double integral_by_cells(double a, double b) const {
        double sum = 0;
        while (a < b) {
            const double next = std::min(std::floor(a) + 1, b);
            sum += (next - a) * value((a + next) / 2);
            a = next;
        }
        return sum;
    }

    /// Of the segment.
    double mean() const {
        double low = std::min(at, at + slope), high = std::max(at, at + slope);
        if (table->values.empty() || low == high) return value(low);
        const double length = high - low;
        double sum = 0;
        if (table->repeat) {
            low -= cells * std::floor(low / cells);
            const double periods = std::floor(length / cells);
            if (periods > 0) sum = periods * integral_by_cells(0, cells);
            return (sum + integral_by_cells(low, low + length - periods * cells)) / length;
        }
        sum = std::max(std::min(high, 0.0) - low, 0.0) * table->values.front() +
              std::max(high - std::max(low, cells), 0.0) * table->values.back();
        return (sum + integral_by_cells(std::max(low, 0.0), std::min(high, cells))) / length;
    }
};

/// The places along a segment at which one table's line changes.
class Knots {
  public:
    explicit Knots(const Line& line) : line_(&line) {
        if (line.slope == 0) return;
        index_ = line.slope > 0 ? std::floor(line.at) + 1 : std::ceil(line.at) - 1;
        if (!line.table->repeat)
            index_ = line.slope > 0 ? std::max(index_, 0.0) : std::min(index_, line.cells);
        find();
    }
    double t() const { return t_; }
    void step() {
        index_ += line_->slope > 0 ? 1 : -1;
        find();
    }

  private:
    void find() {
        const bool inside = line_->table->repeat || (index_ >= 0 && index_ <= line_->cells);
        t_ = inside ? (index_ - line_->at) / line_->slope : kNone;
    }
    static constexpr double kNone = std::numeric_limits<double>::infinity();
    const Line* line_;
    double index_ = 0, t_ = kNone;
};

/// Between knots the product is a cubic: two Gauss nodes are exact.
double mean_of_product(const std::array<Line, 3>& lines) {
    const auto product = [&](double t) {
        double value = 1;
        for (const Line& line : lines) value *= line.value(line.at + t * line.slope);
        return value;
    };
    std::array<Knots, 3> knots{Knots(lines[0]), Knots(lines[1]), Knots(lines[2])};
    const double node = 0.5 - 0.5 / std::sqrt(3.0);
    double sum = 0;
    for (double t = 0; t < 1;) {
        const double next = std::min({1.0, knots[0].t(), knots[1].t(), knots[2].t()});
        if (next > t) {
            const double part = (next - t) * node;
            sum += (next - t) / 2 * (product(t + part) + product(next - part));
            t = next;
        }
        for (Knots& of_axis : knots)
            if (of_axis.t() <= t) of_axis.step();
    }
    return sum;
}

std::array<Line, 3> lines_of(const Separable& fog, const Vector3d& start, const Vector3d& path) {
    return {Line(fog.axes[0], start.x(), path.x()), Line(fog.axes[1], start.y(), path.y()),
            Line(fog.axes[2], start.z(), path.z())};
}

}  // namespace

double extinction_at(const Separable& fog, const Vector3d& x) {
    double value = fog.extinction;
    for (const Line& line : lines_of(fog, x, Vector3d::Zero())) value *= line.value(line.at);
    return value;
}

double mean_extinction(const Separable& fog, const Vector3d& start, const Vector3d& path) {
    const auto lines = lines_of(fog, start, path);
    if (fog.integral == Separable::Integral::exact) return fog.extinction * mean_of_product(lines);
    return fog.extinction * lines[0].mean() * lines[1].mean() * lines[2].mean();
}

}  // namespace wavefog::detail
