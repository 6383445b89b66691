#include "radial_bound_profile.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <utility>

namespace wavefog {
namespace {

namespace plain {
#include "fog_radial_spans.glsl"
}
#define RADIAL_STEP
namespace step {
#include "fog_radial_spans.glsl"
}
#undef RADIAL_STEP

const double kCurvedPart = static_cast<double>(plain::radial_curved_part);
constexpr int kGroups = 64;  // of wedges
// Slopes of an interval change the profile's exponent by up to this share of (2 + the eye's).
constexpr double kSlopeShare = 0.4;
// Behind so much fog, and above so many scale heights, nothing is seen.
constexpr double kOpaqueDepth = 20, kEmptyHeight = 20;
// Sums of float32 terms along a column; a look-up itself.
constexpr double kUlp = 0x1p-24, kLookUp = 64;
// Terms that joining rows (or passes of them) and reading them adds, and a cell's.
constexpr double kJoin = 32, kStep = 3;
// radial_damped()'s series, and the exponential function of up to 24.
constexpr double kClosedForm = 1.5e-5;
// (1 + |P|) for the L2 projection P onto parabolas, in the L1 norm.
constexpr double kProjected = 3.2;

/// How far exp(-z y), y in [0, 1], is from straight lines.
double off_line(double z) {
    if (z < 1e-2) return z * z / 16;
    const double mean = -std::expm1(-z) / z;
    return (1 + mean * std::log(mean) - mean) / 2;
}

/// How far it is from parabolas: |f'''| / (3! 2^5), by Chebyshev's points.
double off_parabola(double z) {
    return std::min(z * z * z / 192, off_line(z));
}

double weight(double eta) {
    return std::exp(-std::max(eta, 0.0));
}

}  // namespace

double radial_rounding(const RadialFacts& facts, double far, double high) {
    return (kLookUp + 2 * far / facts.cell) * kUlp * high + 4 * kUlp * facts.densest * far;
}

double worst_error(double tau, double error, double least, double most, double drawn) {
    if (error <= 0 || most <= 0) return 0;
    double bound = std::min(-std::expm1(-most * error), std::exp(-least * std::min(tau, drawn)));
    // exp(-k tau) (exp(k error) - 1) has one maximum.
    double k = most;
    if (error < tau) k = std::clamp(-std::log1p(-error / tau) / error, least, most);
    if (k * error < 30) bound = std::min(bound, std::exp(-k * tau) * std::expm1(k * error));
    return bound;
}

ProfileSearch::ProfileSearch(double eta, double scale, const RadialFacts& facts, int wedges)
    : eta_(eta),
      scale_(scale),
      facts_(facts),
      together_((wedges + kGroups - 1) / kGroups),
      top_(static_cast<double>(facts.step ? step::radial_top : plain::radial_top)),
      width_(static_cast<double>(facts.step ? step::radial_width : plain::radial_width)),
      widen_(static_cast<double>(facts.step ? step::radial_widen : plain::radial_widen)),
      nearby_(facts.step ? static_cast<double>(step::radial_nearby) : 0) {}

void ProfileSearch::add(const std::vector<RadialStretch>& stretches) {
    if (rows_.size() < stretches.size()) rows_.resize(stretches.size());
    for (std::size_t j = 0; j < stretches.size(); ++j) {
        RadialStretch s = stretches[j];
        s.angular -= s.angular_near;  // of the stretch alone
        RadialStretch& row = rows_[j];
        if (waiting_ == 0) {
            row = s;
            continue;
        }
        row.angular = std::max(row.angular, s.angular);
        row.radial = std::max(row.radial, s.radial);
        row.relative = std::max(row.relative, s.relative);
        row.high = std::max(row.high, s.high);
        row.high_2 = std::max(row.high_2, s.high_2);
        row.density_low = std::min(row.density_low, s.density_low);
        row.density_high = std::max(row.density_high, s.density_high);
        row.slope = std::max(row.slope, s.slope);
        row.mass_low = std::min(row.mass_low, s.mass_low);
    }
    if (++waiting_ == together_) search();
}

double ProfileSearch::largest() {
    if (waiting_ > 0) search();
    return largest_;
}

void ProfileSearch::include(double tau, double error, double least, double most) {
    const double bound = facts_.depth_only ? most * error : worst_error(tau, error, least, most, 0);
    largest_ = std::max(largest_, bound);
}

void ProfileSearch::search() {
    waiting_ = 0;
    if (rows_.empty()) return;
    find_ranges();
    const RayLimits& limits = facts_.limits;
    const double length = facts_.start + rows_.back().far;
    double steepest =
        std::isinf(limits.steepest)
            ? limits.steepest
            : std::sqrt(std::max(limits.steepest * limits.steepest - 1, 0.0)) / scale_;
    if (facts_.start > 0) steepest = std::min(steepest, limits.rise / (scale_ * facts_.start));
    // Steeper rays leave what counts of the profile, or end, before row 1.
    const double within_first = std::max(kEmptyHeight, limits.rise / scale_) / rows_[0].far;
    const double last = facts_.start > 0 ? steepest : std::min(steepest, within_first);
    const double ratio = 1 + kSlopeShare / (2 + std::max(eta_, 0.0));
    double least = 0, most = std::min(0.05 / length, last);
    while (true) {
        slopes(least, most, true);
        slopes(least, most, false);
        if (most >= last) break;
        least = most;
        most = std::min(most * ratio, last);
    }
    if (facts_.start == 0 && steepest > within_first) this->steepest(within_first);
}

// Rays of at least `least` scale heights a metre on the ground, within the first stretch: the error
// of the density times their length.
void ProfileSearch::steepest(double least) {
    const RadialStretch& s = rows_[0];
    const double uneven = std::min(s.density_high - s.density_low, s.slope * s.far / 2);
    double error = kClosedForm * s.density_high + s.angular / s.far;
    // Where the profile counts, cells are walked.
    error += (facts_.step ? std::exp(-nearby_) : 1) * (2 * uneven + kProjected * s.angular / s.far);
    error *= 1 / least + scale_;
    const double below = std::min(facts_.limits.length, std::hypot(s.far, facts_.limits.rise));
    if (eta_ - facts_.limits.rise / scale_ < 0)
        error += 2 * below * (s.relative + radial_rounding(facts_, s.far, s.high) / s.far);
    error += 4 * kUlp * facts_.densest * below;
    include(0, error, 0, 1);
}

// ranges_[p][j]: of the 2^p rows from j on.
void ProfileSearch::find_ranges() {
    ranges_.assign(1, {});
    for (const RadialStretch& s : rows_)
        ranges_[0].push_back({s.density_low, s.density_high, s.slope, s.far - s.near});
    for (std::size_t size = 2; size <= rows_.size(); size *= 2) {
        const std::vector<Range>& half = ranges_.back();
        std::vector<Range> whole;
        for (std::size_t j = 0; j + size <= rows_.size(); ++j)
            whole.push_back(half[j].with(half[j + size / 2]));
        ranges_.push_back(std::move(whole));
    }
}

// Rows that one polynomial may serve together with a row, in stretches of at most `reach` metres.
ProfileSearch::Window ProfileSearch::window(std::size_t row, double reach) const {
    const auto begin = rows_.begin(), here = begin + std::ptrdiff_t(row);
    const auto first = std::partition_point(
        begin, here, [&](const RadialStretch& s) { return here->far - s.near > reach; });
    const auto last = std::partition_point(
        here + 1, rows_.end(), [&](const RadialStretch& s) { return s.far - here->near <= reach; });
    const auto from = std::size_t(first - begin), count = std::size_t(last - first);
    const auto power = std::size_t(std::bit_width(count)) - 1;
    const Range range =
        ranges_[power][from].with(ranges_[power][from + count - (std::size_t(1) << power)]);
    const double far = std::prev(last)->far;
    if (count == 1) return {range, here->far - here->near, far, true};
    return {range, std::min(reach, far - first->near), far, false};
}

// Rays of least..most scale heights a metre on the ground.
void ProfileSearch::slopes(double least, double most, bool rising) {
    const RayLimits& limits = facts_.limits;
    const double shortest = std::hypot(1, least * scale_), longest = std::hypot(1, most * scale_);
    const double lowest =
        rising ? std::max(eta_, 0.0) : 0;  // a ray's height at least, in the layer
    double tau = 0, error = 0, crossing = 0, end_weight = 1;
    bool through = true;
    std::size_t before = 0;  // the first row that may share a polynomial with the one before this
    cut_.assign(rows_.size() + 1, 0);
    for (std::size_t j = 0; j < rows_.size(); ++j) {
        cut_[j + 1] = cut_[j];
        const RadialStretch& s = rows_[j];
        const double from = facts_.start + s.near, to = facts_.start + s.far, d = s.far - s.near;
        if (shortest * from > limits.length || least * scale_ * from > limits.rise) {
            through = false;
            break;
        }
        const double low = rising ? eta_ + least * from : eta_ - most * to;
        const double high = rising ? eta_ + most * to : eta_ - least * from;
        // What lies so high adds less than the float32 sums.
        if (rising && low - lowest > kEmptyHeight) {
            include(tau, error + crossing + std::exp(-kEmptyHeight) * rows_.back().high, shortest,
                    longest);
            through = false;
            break;
        }
        if (!rising && low > kEmptyHeight) {
            error += std::exp(-kEmptyHeight) * s.density_high * (s.far - s.near);
            continue;
        }
        const double most_weight = weight(low);
        end_weight = rising ? weight(eta_ + least * to) : most_weight;

        const double uneven = s.density_high - s.density_low;
        const double partial =
            std::min(7.0 / 16 * uneven, s.slope * d / 4) * d + kProjected * s.angular;
        const double look_up = (facts_.step ? 0 : s.radial) + radial_rounding(facts_, to, s.high);
        // Wider, higher above the lowest point, than a polynomial is; and than it is at least.
        const double width = width_ + widen_ * std::max(high - lowest, 0.0);
        const double least_width =
            (width_ + widen_ * (rising ? std::max(low - lowest, 0.0) : 0)) / (1 + widen_);
        const double reach = width / std::max(least, 1e-30);
        // A polynomial that the last row cuts short, so that second moments do not count.
        const double short_reach = std::min(reach, kCurvedPart * to);
        while (rows_[before].near < s.near - short_reach) ++before;
        const double cut = cut_[j] - cut_[before];
        const double here = error + s.angular * most_weight + 4 * kUlp * facts_.densest * to;
        const double at_base =
            low < 0 && high > 0 ? (facts_.step ? 0 : partial) + cut + look_up : 0;
        if (high > 0) {
            double at_end = cut;
            if (!facts_.step)
                at_end += most_weight * partial;
            else if (rising && high - lowest >= nearby_)
                at_end += std::min(most_weight, weight(lowest + nearby_)) * partial;
            // What lies higher than the shader looks, and where it begins there.
            if (high - lowest >= top_)
                at_end += std::exp(-top_) * weight(lowest) *
                          (std::min(facts_.densest / std::max(least, 1e-30), s.high) + partial);
            include(tau, here + at_end + (rising ? std::max(crossing, at_base) : 0), shortest,
                    longest);
        }
        if (low < 0)
            include(tau, here + look_up + (rising ? 0 : std::max(crossing, at_base)), shortest,
                    longest);
        crossing = std::max(crossing, at_base);

        error += s.angular * most_weight;
        tau += s.mass_low * weight(high);
        if (shortest * tau > kOpaqueDepth && !facts_.depth_only) return;
        if (high <= 0) continue;

        const Window around = window(j, reach);
        const double span = around.span;
        const double change = std::max(around.alone ? 0 : std::min(width, most * span), most * d);
        const double heaviest =
            around.alone ? most_weight : std::min(most_weight * std::exp(change), weight(lowest));
        const bool walked =
            facts_.step && around.alone && least * d > 1 &&
            (rising ? eta_ + most * from : std::max(eta_ - least * to, 0.0)) - lowest < nearby_;
        if (!walked) {
            const double off = std::min((around.range.high - around.range.low) / 2,
                                        around.range.slope * span / std::sqrt(12)) *
                               d;
            // Stretches are as long as rows allow, so that second moments count, but for the one
            // before the last row, which may be cut short.
            const double least_span =
                around.alone ? d : std::max(d, least_width / most - around.range.widest_row);
            const bool curved = change < static_cast<double>(plain::radial_curved_change) &&
                                least_span > kCurvedPart * around.far;
            // A stretch of several rows counts with the weight of its lower end, which its own
            // integral of the weight is 1 / shared of.
            const double shared = around.alone ? 1 : change / -std::expm1(-change);
            const double by = shared * off * most_weight + kProjected * s.angular * heaviest;
            error += by * (curved ? off_parabola(change) : off_line(change));
            if (curved)
                cut_[j + 1] += by * off_line(std::min(change, most * kCurvedPart * around.far));
        }
        // Two neighbouring polynomials are wider than `least_width` together.
        const double share = std::min(1.0, 2 * most * d / least_width);
        const double ulps = (kJoin * share + kStep * (1.5 * d / facts_.cell + 1)) * kUlp;
        double noise = s.high + 2 * most * s.high_2;
        if (span >= kCurvedPart * s.far) noise += most * most * s.high_2 * s.far / 2;
        error += (ulps * noise + kClosedForm * s.density_high * d) * most_weight;
    }
    if (through && facts_.repeat && shortest * (facts_.start + rows_.back().far) < limits.length) {
        const double rest = std::min(1 / std::max(least, 1e-30), limits.length / shortest);
        const double falls = rising ? end_weight : 1;
        include(tau, error + crossing + falls * facts_.densest * rest, shortest, longest);
    }
}

}  // namespace wavefog
