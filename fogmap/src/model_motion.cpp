#include "wavefog/fogmap/model_motion.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

namespace wavefog {
namespace {

using Eigen::Vector3d;
using Complaint = std::optional<std::string>;

template <class Value>
Value mixed(const Value& a, const Value& b, double share) {
    return a + share * (b - a);
}

Halfspace mixed(const Halfspace& a, const Halfspace& b, double share) {
    Halfspace fog = a;
    fog.point = mixed(a.point, b.point, share);
    fog.extinction = mixed(a.extinction, b.extinction, share);
    fog.gradient = mixed(a.gradient, b.gradient, share);
    fog.start = mixed(a.start, b.start, share);
    return fog;
}

Ramp mixed(const Ramp& a, const Ramp& b, double share) {
    Ramp fog = a;
    for (std::size_t i = 0; i < a.points.size(); ++i)
        fog.points[i] = {mixed(a.points[i].y, b.points[i].y, share),
                         mixed(a.points[i].extinction, b.points[i].extinction, share)};
    return fog;
}

ExponentialLayer mixed(const ExponentialLayer& a, const ExponentialLayer& b, double share) {
    return {mixed(a.extinction, b.extinction, share), mixed(a.base, b.base, share),
            mixed(a.scale, b.scale, share)};
}

Cosines mixed(const Cosines& a, const Cosines& b, double share) {
    Cosines fog = a;
    fog.extinction = mixed(a.extinction, b.extinction, share);
    for (std::size_t i = 0; i < a.waves.size(); ++i) {
        const auto &from = a.waves[i], &to = b.waves[i];
        fog.waves[i] = {mixed(from.extinction, to.extinction, share),
                        mixed(from.direction, to.direction, share),
                        mixed(from.frequency, to.frequency, share),
                        mixed(from.phase, to.phase, share)};
    }
    return fog;
}

Polynomials mixed(const Polynomials& a, const Polynomials& b, double share) {
    Polynomials fog = a;
    for (std::size_t i = 0; i < a.terms.size(); ++i) {
        const auto &from = a.terms[i], &to = b.terms[i];
        auto& term = fog.terms[i];
        term.centre = mixed(from.centre, to.centre, share);
        term.extinction = 1;
        term.coefficients.assign(std::max(from.coefficients.size(), to.coefficients.size()), 0);
        for (std::size_t k = 0; k < from.coefficients.size(); ++k)
            term.coefficients[k] += (1 - share) * from.extinction * from.coefficients[k];
        for (std::size_t k = 0; k < to.coefficients.size(); ++k)
            term.coefficients[k] += share * to.extinction * to.coefficients[k];
    }
    return fog;
}

Potentials mixed(const Potentials& a, const Potentials& b, double share) {
    Potentials fog = a;
    fog.extinction = mixed(a.extinction, b.extinction, share);
    for (std::size_t i = 0; i < a.objects.size(); ++i) {
        const auto &from = a.objects[i], &to = b.objects[i];
        fog.objects[i] = {from.kind,
                          mixed(from.from, to.from, share),
                          mixed(from.to, to.to, share),
                          mixed(from.radius, to.radius, share),
                          mixed(from.extinction, to.extinction, share),
                          mixed(from.reach, to.reach, share)};
    }
    return fog;
}

Separable mixed(const Separable& a, const Separable& b, double share) {
    Separable fog = a;
    fog.extinction = mixed(a.extinction, b.extinction, share);
    for (std::size_t i = 0; i < a.axes.size(); ++i) {
        fog.axes[i].begin = mixed(a.axes[i].begin, b.axes[i].begin, share);
        fog.axes[i].end = mixed(a.axes[i].end, b.axes[i].end, share);
        for (std::size_t k = 0; k < a.axes[i].values.size(); ++k)
            fog.axes[i].values[k] = mixed(a.axes[i].values[k], b.axes[i].values[k], share);
    }
    return fog;
}

Complaint same_number(const char* what, std::size_t a, std::size_t b) {
    if (a == b) return {};
    return fmt::format("{} has {} entries, before {}; give as many, extinction 0 hides one", what,
                       b, a);
}

Complaint unlike(const Halfspace& a, const Halfspace& b) {
    if (a.fraction != b.fraction) return "fraction differs from that before; give the same";
    if ((a.normal - b.normal).norm() > 1e-12)
        return "normal differs from that before; a plane moves, it does not turn";
    return {};
}

Complaint unlike(const Ramp& a, const Ramp& b) {
    return same_number("points", a.points.size(), b.points.size());
}

Complaint unlike(const ExponentialLayer&, const ExponentialLayer&) {
    return {};
}

Complaint unlike(const Cosines& a, const Cosines& b) {
    return same_number("waves", a.waves.size(), b.waves.size());
}

Complaint unlike(const Polynomials& a, const Polynomials& b) {
    if (auto number = same_number("polynomials", a.terms.size(), b.terms.size())) return number;
    for (std::size_t i = 0; i < a.terms.size(); ++i) {
        const auto &from = a.terms[i], &to = b.terms[i];
        if (from.half_width != to.half_width || from.outside != to.outside ||
            (from.direction - to.direction).norm() > 1e-12)
            return fmt::format(
                "polynomials[{}]: direction, half_width or outside differs from that "
                "before; coefficients, extinction and centre may",
                i);
    }
    return {};
}

Complaint unlike(const Potentials& a, const Potentials& b) {
    if (auto number = same_number("objects", a.objects.size(), b.objects.size())) return number;
    for (std::size_t i = 0; i < a.objects.size(); ++i) {
        const auto &from = a.objects[i], &to = b.objects[i];
        if (from.kind != to.kind)
            return fmt::format("objects[{}] is of another kind than before; give the same", i);
        const Vector3d before = from.to - from.from, after = to.to - to.from;
        const double dot = before.dot(after);
        if (from.kind == Potentials::Object::Kind::line && dot < 0 &&
            before.cross(after).norm() < 1e-9 * -dot)
            return fmt::format(
                "objects[{}]: the line turns about and would vanish on its way; "
                "exchange its ends",
                i);
    }
    return {};
}

Complaint unlike(const Separable& a, const Separable& b) {
    if (a.integral != b.integral) return "integral differs from that before; give the same";
    for (std::size_t i = 0; i < a.axes.size(); ++i)
        if (a.axes[i].values.size() != b.axes[i].values.size() ||
            a.axes[i].repeat != b.axes[i].repeat)
            return fmt::format(
                "{} has another number of values or another outside than before; "
                "give the same",
                "xyz"[i]);
    return {};
}

}  // namespace

FogModel interpolate(const FogModel& a, const FogModel& b, double share) {
    FogModel result = a;
    std::visit(
        [&](auto& shape) {
            using Kind = std::decay_t<decltype(shape)>;
            shape = mixed(std::get<Kind>(a), std::get<Kind>(b), share);
        },
        result);
    return result;
}

Result<void> check_interpolable(const FogModel& a, const FogModel& b) {
    if (a.index() != b.index())
        return data_error("is of another kind than the shape before; give shapes of one kind");
    const Complaint complaint = std::visit(
        [&](const auto& shape) {
            using Kind = std::decay_t<decltype(shape)>;
            return unlike(shape, std::get<Kind>(b));
        },
        a);
    if (complaint) return data_error(*complaint);
    return {};
}

std::vector<FogModel> models_at(std::vector<FogModel> models,
                                const std::vector<ModelMotion>& motions, double seconds) {
    for (std::size_t i = 0; i < std::min(models.size(), motions.size()); ++i) {
        const auto& keys = motions[i].shapes;
        if (!keys.empty()) {
            const auto after = std::upper_bound(
                keys.begin(), keys.end(), seconds,
                [](double time, const ModelMotion::Key& key) { return time < key.seconds; });
            const auto next = static_cast<std::size_t>(after - keys.begin());
            const auto &a = keys[next == 0 ? 0 : next - 1],
                       &b = keys[std::min(next, keys.size() - 1)];
            models[i] = &a == &b ? a.shape
                                 : interpolate(a.shape, b.shape,
                                               (seconds - a.seconds) / (b.seconds - a.seconds));
        }
        const Eigen::Vector2d offset = motions[i].wind.offset(seconds);
        models[i] = moved(models[i], {offset.x(), 0, offset.y()});
    }
    return models;
}

}  // namespace wavefog
