// What fogs given by formulas must satisfy; messages name the scene file's key.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "wavefog/fogmap/models.h"

namespace wavefog {
namespace {

using Eigen::Vector3d;

/// The first complaint; later checks are skipped.
class Checks {
  public:
    void that(bool good, const std::string& message) {
        if (!good && !complaint_) complaint_ = message;
    }
    void finite(const std::string& key, double value) {
        that(std::isfinite(value), fmt::format("{} is {}; it must be a finite number", key, value));
    }
    void finite(const std::string& key, const Vector3d& v) {
        that(v.allFinite(), fmt::format("{} is [{}, {}, {}]; its numbers must be finite", key,
                                        v.x(), v.y(), v.z()));
    }
    void not_negative(const std::string& key, double value) {
        that(std::isfinite(value) && value >= 0,
             fmt::format("{} is {}; it must be 0 or more", key, value));
    }
    void positive(const std::string& key, double value) {
        that(std::isfinite(value) && value > 0,
             fmt::format("{} is {}; it must be above 0", key, value));
    }
    void direction(const std::string& key, const Vector3d& v) {
        finite(key, v);
        that(v.norm() > 0, key + " is [0, 0, 0]; give a direction");
    }
    void not_empty(const std::string& key, bool empty, const char* what) {
        that(!empty, fmt::format("{} is empty; give at least {}", key, what));
    }
    Result<void> result() const {
        if (complaint_) return data_error(*complaint_);
        return {};
    }

  private:
    std::optional<std::string> complaint_;
};

/// A u in [low, high] at which a polynomial with these Bernstein coefficients is below -slack. It
/// lies within its coefficients and has the outer two as end values; halves fit ever closer.
std::optional<double> negative_place(const std::vector<double>& bernstein, double low, double high,
                                     double slack) {
    if (*std::min_element(bernstein.begin(), bernstein.end()) >= -slack) return std::nullopt;
    if (bernstein.front() < -slack) return low;
    if (bernstein.back() < -slack) return high;
    std::vector<double> left, right(bernstein.size()), row = bernstein;
    for (std::size_t n = row.size(); n > 0; --n) {  // de Casteljau at the middle
        left.push_back(row[0]);
        right[n - 1] = row[n - 1];
        for (std::size_t i = 0; i + 1 < n; ++i) row[i] = (row[i] + row[i + 1]) / 2;
    }
    const double middle = (low + high) / 2;
    if (const auto found = negative_place(left, low, middle, slack)) return found;
    return negative_place(right, middle, high, slack);
}

/// Coefficients for the Bernstein basis on [-1, 1] from those of ascending powers.
std::vector<double> bernstein_of(const std::vector<double>& powers) {
    const std::size_t n = powers.size() - 1;
    // u = 2 x - 1: one factor after another (Horner), then powers of x to Bernstein.
    std::vector<double> x(n + 1, 0.0);
    for (std::size_t i = n + 1; i-- > 0;) {
        for (std::size_t k = n; k > 0; --k) x[k] = 2 * x[k - 1] - x[k];
        x[0] = powers[i] - x[0];
    }
    std::vector<double> bernstein(n + 1, 0.0);
    for (std::size_t j = 0; j <= n; ++j) {
        double ratio = 1;  // binomial(j, i) / binomial(n, i)
        for (std::size_t i = 0; i <= j; ++i) {
            bernstein[j] += x[i] * ratio;
            ratio *= double(j - i) / double(n - i);
        }
    }
    return bernstein;
}

void check(Checks& checks, const Halfspace& fog) {
    checks.direction("normal", fog.normal);
    checks.that(std::abs(fog.normal.norm() - 1) < 1e-12,
                fmt::format("normal has length {}; it must have length 1", fog.normal.norm()));
    checks.finite("point", fog.point);
    checks.not_negative("extinction", fog.extinction);
    checks.not_negative("gradient", fog.gradient);
    checks.not_negative("start", fog.start);
    checks.that(
        fog.start == 0 || fog.fraction == Halfspace::Fraction::linear,
        fmt::format("start is {}, which needs the fraction linear; leave it out", fog.start));
    checks.that(
        fog.start == 0 || fog.gradient == 0,
        fmt::format("start is {}, which needs constant fog; leave it out, or gradient", fog.start));
}

void check(Checks& checks, const Ramp& fog) {
    checks.that(fog.points.size() >= 2,
                fmt::format("points has {} entries; give at least two, each [y, extinction]",
                            fog.points.size()));
    for (std::size_t i = 0; i < fog.points.size(); ++i) {
        const auto key = fmt::format("points[{}]", i);
        checks.finite(key + ": y", fog.points[i].y);
        checks.not_negative(key + ": extinction", fog.points[i].extinction);
        if (i > 0)
            checks.that(fog.points[i - 1].y < fog.points[i].y,
                        fmt::format("{}: y is {}, after {}; heights must ascend", key,
                                    fog.points[i].y, fog.points[i - 1].y));
    }
}

void check(Checks& checks, const ExponentialLayer& fog) {
    checks.not_negative("extinction", fog.extinction);
    checks.finite("base", fog.base);
    checks.positive("scale", fog.scale);
}

void check(Checks& checks, const Cosines& fog) {
    checks.not_negative("extinction", fog.extinction);
    checks.not_empty("waves", fog.waves.empty(), "one");
    double sum = 0;
    for (std::size_t i = 0; i < fog.waves.size(); ++i) {
        const auto key = fmt::format("waves[{}].", i);
        const auto& wave = fog.waves[i];
        checks.finite(key + "extinction", wave.extinction);
        checks.direction(key + "direction", wave.direction);
        checks.finite(key + "frequency", wave.frequency);
        checks.finite(key + "phase", wave.phase);
        sum += std::abs(wave.extinction);
    }
    checks.that(fog.extinction >= sum * (1 - 1e-12),
                fmt::format("extinction is {}, but the waves take away up to {}, which would make "
                            "fog negative; raise it to {} or more, or weaken the waves",
                            fog.extinction, sum, sum));
}

void check(Checks& checks, const Polynomials& fog) {
    checks.not_empty("polynomials", fog.terms.empty(), "one");
    for (std::size_t i = 0; i < fog.terms.size(); ++i) {
        const auto key = fmt::format("polynomials[{}].", i);
        const auto& term = fog.terms[i];
        const auto& c = term.coefficients;
        checks.not_negative(key + "extinction", term.extinction);
        checks.direction(key + "direction", term.direction);
        checks.that(std::abs(term.direction.norm() - 1) < 1e-12,
                    key + "direction must have length 1");
        checks.finite(key + "centre", term.centre);
        checks.positive(key + "half_width", term.half_width);
        checks.not_empty(key + "coefficients", c.empty(), "the constant");
        checks.that(c.size() <= Polynomials::kMaxCoefficients,
                    fmt::format("{}coefficients has {} entries; the degree may be {} at most", key,
                                c.size(), Polynomials::kMaxCoefficients - 1));
        for (const double value : c) checks.finite(key + "coefficients", value);
        if (!checks.result()) return;

        double largest = 0, at_low = 0, at_high = 0;
        for (std::size_t k = 0; k < c.size(); ++k) {
            largest = std::max(largest, std::abs(c[k]));
            at_high += c[k];
            at_low += k % 2 ? -c[k] : c[k];
        }
        const double slack = 1e-9 * largest;
        if (const auto u = negative_place(bernstein_of(c), -1, 1, slack))
            checks.that(false, fmt::format("{}coefficients make the polynomial negative at u = "
                                           "{:.4g} (of -1 to 1); raise the first one",
                                           key, *u));
        checks.that(
            term.outside == Polynomials::Outside::zero || std::abs(at_high - at_low) <= slack,
            fmt::format("{}coefficients give {:.6g} at u = -1 and {:.6g} at u = 1; a "
                        "repeated domain needs the same at both borders",
                        key, at_low, at_high));
    }
}

void check(Checks& checks, const Potentials& fog) {
    using Kind = Potentials::Object::Kind;
    checks.not_negative("extinction", fog.extinction);
    checks.not_empty("objects", fog.objects.empty(), "one");
    double taken = 0;
    for (std::size_t i = 0; i < fog.objects.size(); ++i) {
        const auto key = fmt::format("objects[{}].", i);
        const auto& object = fog.objects[i];
        const char* place = object.kind == Kind::point    ? "point"
                            : object.kind == Kind::sphere ? "sphere"
                                                          : "line";
        checks.finite(key + place, object.from);
        if (object.kind == Kind::line) {
            checks.finite(key + place, object.to);
            checks.that(object.from != object.to,
                        key + "line begins and ends at the same point; move one, or use a point");
        }
        if (object.kind == Kind::sphere) checks.positive(key + "radius", object.radius);
        checks.finite(key + "extinction", object.extinction);
        checks.positive(key + "reach", object.reach);
        taken += std::max(-object.extinction, 0.0);
    }
    checks.that(fog.extinction >= taken * (1 - 1e-12),
                fmt::format("extinction is {}, but the objects with a negative one take away up to "
                            "{}, which would make fog negative; raise it to {} or more",
                            fog.extinction, taken, taken));
}

void check(Checks& checks, const Separable& fog) {
    checks.not_negative("extinction", fog.extinction);
    for (std::size_t a = 0; a < 3; ++a) {
        const AxisTable& axis = fog.axes[a];
        const std::string key = fmt::format("{}.", "xyz"[a]);
        if (axis.values.empty()) continue;
        checks.that(axis.values.size() >= 2 && axis.values.size() <= AxisTable::kMaxValues,
                    fmt::format("{}values has {} entries; give 2 to {}", key, axis.values.size(),
                                AxisTable::kMaxValues));
        checks.finite(key + "begin", axis.begin);
        checks.finite(key + "end", axis.end);
        checks.that(axis.begin < axis.end,
                    fmt::format("{}end is {}, begin is {}; end must be above begin", key, axis.end,
                                axis.begin));
        for (std::size_t i = 0; i < axis.values.size(); ++i)
            if (!(std::isfinite(axis.values[i]) && axis.values[i] >= 0))
                checks.not_negative(fmt::format("{}values[{}]", key, i), axis.values[i]);
        checks.that(!axis.repeat || axis.values.front() == axis.values.back(),
                    fmt::format("{}values begins with {} and ends with {}; a table that repeats "
                                "needs the same at both ends",
                                key, axis.values.front(), axis.values.back()));
    }
}

}  // namespace

Result<void> validate(const Channels& channels) {
    double sum = 0;
    for (const double share : channels) {
        if (!(std::isfinite(share) && share >= 0))
            return data_error(fmt::format("channels is [{}, {}, {}]; each must be 0 or more",
                                          channels[0], channels[1], channels[2]));
        sum += share;
    }
    if (sum == 0) return data_error("channels is [0, 0, 0]: no colour sees the fog; raise one");
    return {};
}

Result<void> validate(const FogModel& model) {
    if (auto ok = validate(model.channels); !ok) return ok;
    Checks checks;
    std::visit([&](const auto& fog) { check(checks, fog); }, model);
    // A share of a fraction's optical depth is no fraction: (1 - tau)^share, not 1 - share tau.
    if (const auto* plane = std::get_if<Halfspace>(&model))
        checks.that(plane->fraction == Halfspace::Fraction::exp || model.channels == kAllChannels,
                    "channels go with the fraction exp alone; leave channels out, or fraction");
    return checks.result();
}

}  // namespace wavefog
