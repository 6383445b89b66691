#include "wavefog/fogmap/wind.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace wavefog {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

Vector2d velocity_of(const Wind::Key& key) {
    return {key.x, key.z};
}

/// Share of the way from `a` to `b`, in [0, 1] between them.
double share(const Wind::Key& a, const Wind::Key& b, double seconds) {
    return (seconds - a.seconds) / (b.seconds - a.seconds);
}

/// Metres from the first key to `seconds`.
Vector2d metres_from_first(const std::vector<Wind::Key>& keys, double seconds) {
    if (seconds <= keys.front().seconds)
        return velocity_of(keys.front()) * (seconds - keys.front().seconds);
    Vector2d sum(0, 0);
    for (std::size_t i = 0; i + 1 < keys.size(); ++i) {
        const Wind::Key &a = keys[i], &b = keys[i + 1];
        const double end = std::min(seconds, b.seconds);
        const Vector2d at_end =
            velocity_of(a) + share(a, b, end) * (velocity_of(b) - velocity_of(a));
        sum += (velocity_of(a) + at_end) / 2 * (end - a.seconds);
        if (seconds <= b.seconds) return sum;
    }
    return sum + velocity_of(keys.back()) * (seconds - keys.back().seconds);
}

/// The same place of what repeats, without whole periods: exact, and no digit goes with time.
double within_period(double metres, double period) {
    return std::remainder(metres, period);
}

}  // namespace

bool Wind::calm() const {
    return std::all_of(keys.begin(), keys.end(),
                       [](const Key& key) { return key.x == 0 && key.z == 0; });
}

Vector2d Wind::velocity(double seconds) const {
    if (keys.empty()) return {0, 0};
    if (seconds <= keys.front().seconds) return velocity_of(keys.front());
    for (std::size_t i = 0; i + 1 < keys.size(); ++i)
        if (seconds <= keys[i + 1].seconds)
            return velocity_of(keys[i]) + share(keys[i], keys[i + 1], seconds) *
                                              (velocity_of(keys[i + 1]) - velocity_of(keys[i]));
    return velocity_of(keys.back());
}

Vector2d Wind::offset(double seconds) const {
    if (keys.empty()) return {0, 0};
    if (constant()) return velocity_of(keys.front()) * seconds;
    return metres_from_first(keys, seconds) - metres_from_first(keys, 0);
}

Result<void> Wind::validate() const {
    for (std::size_t i = 0; i < keys.size(); ++i) {
        const Key& key = keys[i];
        if (!std::isfinite(key.x) || !std::isfinite(key.z) || !std::isfinite(key.seconds))
            return data_error(fmt::format("[{}]: [{}, {}, {}]; all must be finite (s, m/s, m/s)", i,
                                          key.seconds, key.x, key.z));
        if (i > 0 && !(keys[i - 1].seconds < key.seconds))
            return data_error(fmt::format("[{}]: time is {}, after {}; times must ascend", i,
                                          key.seconds, keys[i - 1].seconds));
    }
    return {};
}

FogModel moved(const FogModel& model, const Vector3d& metres) {
    FogModel result = model;
    std::visit(
        [&](auto& fog) {
            using Kind = std::decay_t<decltype(fog)>;
            if constexpr (std::is_same_v<Kind, Halfspace>) {
                fog.point += metres;
            } else if constexpr (std::is_same_v<Kind, Ramp>) {
                for (auto& point : fog.points) point.y += metres.y();
            } else if constexpr (std::is_same_v<Kind, ExponentialLayer>) {
                fog.base += metres.y();
            } else if constexpr (std::is_same_v<Kind, Cosines>) {
                for (auto& wave : fog.waves)
                    wave.phase -= wave.frequency * wave.direction.dot(metres);
            } else if constexpr (std::is_same_v<Kind, Polynomials>) {
                for (auto& term : fog.terms) {
                    const bool repeat = term.outside == Polynomials::Outside::repeat;
                    if (repeat)
                        term.centre +=
                            within_period(metres.dot(term.direction), 2 * term.half_width) *
                            term.direction;
                    else
                        term.centre += metres;
                }
            } else if constexpr (std::is_same_v<Kind, Separable>) {
                for (std::size_t a = 0; a < 3; ++a) {
                    AxisTable& axis = fog.axes[a];
                    const double far = metres[static_cast<Eigen::Index>(a)];
                    const double shift =
                        axis.repeat ? within_period(far, axis.end - axis.begin) : far;
                    axis.begin += shift;
                    axis.end += shift;
                }
            } else {
                static_assert(std::is_same_v<Kind, Potentials>);
                for (auto& object : fog.objects) {
                    object.from += metres;
                    object.to += metres;
                }
            }
        },
        result);
    return result;
}

}  // namespace wavefog
