#include "wavefog/fogmap/model_motion.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <type_traits>

#include "keyframes.h"

namespace wavefog {
namespace {

using Eigen::Vector3d;
using Complaint = std::optional<std::string>;

template <class Value>
Value mixed(const Value& a, const Value& b, double share) {
    return a + share * (b - a);
}

Ramp::Point mixed(const Ramp::Point& a, const Ramp::Point& b, double share) {
    return {mixed(a.y, b.y, share), mixed(a.extinction, b.extinction, share)};
}

Cosines::Wave mixed(const Cosines::Wave& a, const Cosines::Wave& b, double share) {
    return {mixed(a.extinction, b.extinction, share), mixed(a.direction, b.direction, share),
            mixed(a.frequency, b.frequency, share), mixed(a.phase, b.phase, share)};
}

/// Mixed as functions: of the extinction times the coefficients.
Polynomials::Term mixed(const Polynomials::Term& a, const Polynomials::Term& b, double share) {
    Polynomials::Term term = a;
    term.centre = mixed(a.centre, b.centre, share);
    term.extinction = 1;
    term.coefficients.assign(std::max(a.coefficients.size(), b.coefficients.size()), 0);
    for (std::size_t k = 0; k < a.coefficients.size(); ++k)
        term.coefficients[k] += (1 - share) * a.extinction * a.coefficients[k];
    for (std::size_t k = 0; k < b.coefficients.size(); ++k)
        term.coefficients[k] += share * b.extinction * b.coefficients[k];
    return term;
}

Potentials::Object mixed(const Potentials::Object& a, const Potentials::Object& b, double share) {
    return {a.kind,
            mixed(a.from, b.from, share),
            mixed(a.to, b.to, share),
            mixed(a.radius, b.radius, share),
            mixed(a.extinction, b.extinction, share),
            mixed(a.reach, b.reach, share)};
}

/// Of as many parts.
template <class Part>
std::vector<Part> mixed(const std::vector<Part>& a, const std::vector<Part>& b, double share) {
    std::vector<Part> parts;
    for (std::size_t i = 0; i < a.size(); ++i) parts.push_back(mixed(a[i], b[i], share));
    return parts;
}

AxisTable mixed(const AxisTable& a, const AxisTable& b, double share) {
    return {mixed(a.values, b.values, share), mixed(a.begin, b.begin, share),
            mixed(a.end, b.end, share), a.repeat};
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
    return {mixed(a.points, b.points, share)};
}

ExponentialLayer mixed(const ExponentialLayer& a, const ExponentialLayer& b, double share) {
    return {mixed(a.extinction, b.extinction, share), mixed(a.base, b.base, share),
            mixed(a.scale, b.scale, share)};
}

Cosines mixed(const Cosines& a, const Cosines& b, double share) {
    return {mixed(a.extinction, b.extinction, share), mixed(a.waves, b.waves, share)};
}

Polynomials mixed(const Polynomials& a, const Polynomials& b, double share) {
    return {mixed(a.terms, b.terms, share)};
}

Potentials mixed(const Potentials& a, const Potentials& b, double share) {
    return {mixed(a.extinction, b.extinction, share), mixed(a.objects, b.objects, share)};
}

Separable mixed(const Separable& a, const Separable& b, double share) {
    Separable fog{mixed(a.extinction, b.extinction, share), {}, a.integral};
    for (std::size_t i = 0; i < a.axes.size(); ++i)
        fog.axes[i] = mixed(a.axes[i], b.axes[i], share);
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
            const auto [a, b, share] = detail::between_keys(keys, seconds);
            models[i] = a == b ? keys[a].shape : interpolate(keys[a].shape, keys[b].shape, share);
        }
        const Eigen::Vector2d offset = motions[i].wind.offset(seconds);
        models[i] = moved(models[i], {offset.x(), 0, offset.y()});
    }
    return models;
}

}  // namespace wavefog
