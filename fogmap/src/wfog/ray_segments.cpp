#include "ray_segments.h"

#include <algorithm>
#include <cmath>

#include "vector_clones.h"

namespace wavefog::wfog {

using std::size_t;

/// Lengths of 1, 2, 3, 4 ... 10, 12, 14, 16, 19 ... times `least`, each at most a fifth more than
/// the one before from 5 on, and last `most`.
RaySegments::RaySegments(double most, double least, double extinction) : extinction_(extinction) {
    double shortest = 0;
    for (double n = 1; shortest < most; n += std::max(std::floor(n / 5), 1.0)) {
        classes_.push_back({.shortest = shortest, .longest = std::min(n * least, most)});
        shortest = classes_.back().longest;
    }
}

namespace {

/// high[i] and low[i] become the extremes of [i] and [i + shift].
WAVEFOG_VECTOR_CLONES
void grow(double* high, double* low, size_t count, size_t shift) {
    for (size_t i = 0; i < count; ++i) {
        high[i] = std::max(high[i], high[i + shift]);
        low[i] = std::min(low[i], low[i + shift]);
    }
}

/// From every sample, how far the sum can rise or fall by the extremes [shortest] and [shift], and
/// the class of the depth up to `shortest`.
WAVEFOG_VECTOR_CLONES
void rate(const double* sums, const double* high, const double* low, const double* depths,
          size_t count, size_t shortest, size_t shift, double last_class, double* rise,
          int* depth_class) {
    for (size_t i = 0; i < count; ++i) {
        const double up = std::max(high[i + shortest], high[i + shift]) - sums[i];
        const double down = sums[i] - std::min(low[i + shortest], low[i + shift]);
        rise[i] = std::max(up, down);
        depth_class[i] = static_cast<int>(std::min(depths[i + shortest] - depths[i], last_class));
    }
}

}  // namespace

void RaySegments::add_line(const std::vector<double>& sums, const std::vector<double>& density,
                           double step) {
    const size_t count = sums.size();
    const auto samples = [&](double length) { return std::min(length / step, double(count)); };
    const auto last = static_cast<size_t>(std::ceil(samples(classes_.back().longest)));
    const size_t padded = count + 3 * last + 2;
    high_.assign(padded, sums.back());
    std::copy(sums.begin(), sums.end(), high_.begin());
    low_ = high_;
    depths_.assign(padded, density.back() * extinction_ / kDepthStep);
    for (size_t i = 0; i < count; ++i) depths_[i] = density[i] * extinction_ / kDepthStep;
    rise_.resize(count);
    depth_class_.resize(count);
    size_t width = 0;  // extremes of sums[i .. i + width]
    for (Class& of : classes_) {
        // The ends of its segments: two windows of `width` cover them. Extremes come from those of
        // half the width.
        const auto shortest = static_cast<size_t>(samples(of.shortest));
        if (shortest == count) break;
        const auto longest = static_cast<size_t>(std::ceil(samples(of.longest)));
        const size_t ends = std::max(longest - shortest, width);
        for (size_t more; more = std::max<size_t>(width, 1), width + more <= ends;) {
            grow(high_.data(), low_.data(), padded - more, more);
            width += more;
        }
        rate(sums.data(), high_.data(), low_.data(), depths_.data(), count, shortest,
             shortest + ends - width, double(kDepths - 1), rise_.data(), depth_class_.data());
        // Neighbours are often of one class.
        int current = 0;
        double most = 0;
        for (size_t i = 0; i < count; ++i) {
            if (depth_class_[i] != current) {
                of.worst[size_t(current)] = std::max(of.worst[size_t(current)], most);
                current = depth_class_[i];
                most = 0;
            }
            most = std::max(most, rise_[i]);
        }
        of.worst[size_t(current)] = std::max(of.worst[size_t(current)], most);
    }
}

void RaySegments::add(const RaySegments& other) {
    for (size_t k = 0; k < classes_.size(); ++k)
        for (size_t t = 0; t < kDepths; ++t)
            classes_[k].worst[t] = std::max(classes_[k].worst[t], other.classes_[k].worst[t]);
}

void RaySegments::extend(double most) {
    const double last = classes_.back().longest;
    ByDepth worst{};
    for (const Class& of : classes_)
        for (size_t t = 0; t < kDepths; ++t) worst[t] = std::max(worst[t], of.worst[t]);
    make_concave(worst);
    // Of all that are as deep or deeper.
    ByDepth deeper = worst;
    for (size_t t = kDepths - 1; t-- > 0;) deeper[t] = std::max(deeper[t], deeper[t + 1]);
    for (double pieces = 2; classes_.back().longest < most; pieces *= 2) {
        Class of{.shortest = pieces / 2 * last, .longest = pieces * last};
        for (size_t t = 0; t < kDepths; ++t) {
            // The mean of the pieces lies below the hull, and up to a class below the mean of
            // their depths, which are rounded down.
            const auto least = static_cast<size_t>(std::max(double(t) / pieces - 1, 0.0));
            const auto most_deep =
                std::min(static_cast<size_t>(double(t) / pieces) + 1, kDepths - 1);
            of.worst[t] = t + 1 == kDepths
                              ? deeper[least]
                              : *std::max_element(&worst[least], &worst[most_deep] + 1);
            of.worst[t] *= pieces;
        }
        classes_.push_back(of);
    }
}

/// The least concave sequence that is nowhere below.
void RaySegments::make_concave(ByDepth& values) {
    std::array<size_t, kDepths> corners;
    size_t count = 0;
    for (size_t t = 0; t < kDepths; ++t) {
        while (count >= 2) {
            const size_t a = corners[count - 2], b = corners[count - 1];
            if ((values[b] - values[a]) * double(t - a) > (values[t] - values[a]) * double(b - a))
                break;
            --count;
        }
        corners[count++] = t;
    }
    for (size_t c = 0; c + 1 < count; ++c)
        for (size_t a = corners[c], b = corners[c + 1], t = a + 1; t < b; ++t)
            values[t] = std::lerp(values[a], values[b], double(t - a) / double(b - a));
}

double RaySegments::worst_change(double longest, double mean, double stretch,
                                 double reserve) const {
    // Means are points below the hull of (length, depth, error) of segments. For any `price` of a
    // sample, its cross-section at the mean length lies below the hull of (depth, error - price *
    // length), plus price * mean.
    double of_mean = 0, first = 0;
    for (const Class& of : classes_) {
        if (of.shortest >= mean && first > 0) break;
        first = of.longest;
        of_mean = std::max(of_mean, *std::ranges::max_element(of.worst));
    }
    ByDepth least;
    least.fill(HUGE_VAL);
    const bool all_so_long = longest <= mean;
    for (int p = all_so_long ? 0 : 8; p >= 0; --p) {
        const double price = p == 0 ? 0 : of_mean / first * std::exp2(0.5 * (p - 7));
        ByDepth worst{};
        for (const Class& of : classes_) {
            for (size_t t = 0; t < kDepths; ++t)
                worst[t] = std::max(worst[t], of.worst[t] - price * of.shortest);
            if (of.longest >= longest) break;
        }
        make_concave(worst);
        for (size_t t = 0; t < kDepths; ++t) least[t] = std::min(least[t], worst[t] + price * mean);
    }
    // Between two depths as well, as far apart as they are on a steep ray.
    const double parts = std::clamp(std::ceil(stretch), 1.0, 32.0);
    double change = 0;
    for (size_t t = 0; t + 1 < kDepths; ++t)
        for (double part = 0; part <= parts; ++part) {
            const double depth = (double(t) + part / parts) * kDepthStep;
            const double off = std::lerp(least[t], least[t + 1], part / parts);
            change = std::max(change, std::exp(-stretch * depth) *
                                          std::expm1(stretch * reserve * extinction_ * off));
        }
    return change;
}

}  // namespace wavefog::wfog
