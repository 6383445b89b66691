#include "model_reader.h"

#include <fmt/format.h>

#include <array>

#include "axis_reader.h"

namespace wavefog::detail {
namespace {

using Eigen::Vector3d;

/// Directions of planes and polynomials have unit length; 0 stays 0 for validate() to name.
Vector3d unit_vector(const JsonValue& value) {
    const Vector3d v = value.vector3();
    return v.norm() > 0 ? v.stableNormalized() : v;
}

double number_or(const JsonValue& value, const char* key, double otherwise) {
    const auto found = value.find(key);
    return found ? found->number() : otherwise;
}

/// The value has no keys but these and those that every formula or shape may have.
void only(const JsonValue& value, std::vector<std::string_view> keys) {
    keys.insert(keys.begin(), {"time", "model", "wind", "channels"});
    value.only(keys);
}

Halfspace read_halfspace(const JsonValue& value) {
    only(value, {"normal", "point", "extinction", "gradient", "fraction", "start"});
    if (!value.find("extinction") && !value.find("gradient"))
        value.fail(
            "needs \"extinction\" (1/m), \"gradient\" (1/m for each metre of depth), or both");
    auto fraction = Halfspace::Fraction::exp;
    if (const auto key = value.find("fraction")) {
        using enum Halfspace::Fraction;
        fraction = std::array{exp, linear, exp2}[key->choice({"exp", "linear", "exp2"})];
    }
    return {unit_vector(value.key("normal")),
            value.key("point").vector3(),
            number_or(value, "extinction", 0),
            number_or(value, "gradient", 0),
            fraction,
            number_or(value, "start", 0)};
}

FogModel read_layers(const JsonValue& value) {
    switch (value.key("profile").choice({"ramp", "exponential", "table", "depth"})) {
        case 0: {
            only(value, {"profile", "points"});
            Ramp fog;
            for (const JsonValue& point : value.key("points").items()) {
                const auto v = point.numbers(2);
                fog.points.push_back({v[0], v[1]});
            }
            return fog;
        }
        case 2:
            only(value, {"profile", "extinction", "y"});
            return Separable{value.key("extinction").number(),
                             {AxisTable{}, read_axis(value.key("y")), AxisTable{}},
                             Separable::Integral::exact};
        case 1:
            only(value, {"profile", "extinction", "base", "scale"});
            return ExponentialLayer{value.key("extinction").number(), value.key("base").number(),
                                    value.key("scale").number()};
        default:
            // Denser with depth, as water is: a halfspace whose plane is level.
            only(value, {"profile", "surface", "gradient"});
            return Halfspace{{0, 1, 0},
                             {0, value.key("surface").number(), 0},
                             0,
                             value.key("gradient").number()};
    }
}

Cosines read_cosines(const JsonValue& value) {
    only(value, {"extinction", "waves"});
    Cosines fog;
    fog.extinction = value.key("extinction").number();
    for (const JsonValue& wave : value.key("waves").items()) {
        wave.only({"extinction", "direction", "frequency", "phase"});
        fog.waves.push_back({wave.key("extinction").number(), wave.key("direction").vector3(),
                             wave.key("frequency").number(), number_or(wave, "phase", 0)});
    }
    return fog;
}

Polynomials read_polynomials(const JsonValue& value) {
    only(value, {"polynomials"});
    Polynomials fog;
    for (const JsonValue& item : value.key("polynomials").items()) {
        item.only({"extinction", "coefficients", "direction", "centre", "half_width", "outside"});
        Polynomials::Term term;
        term.extinction = item.key("extinction").number();
        for (const JsonValue& c : item.key("coefficients").items())
            term.coefficients.push_back(c.number());
        term.direction = unit_vector(item.key("direction"));
        if (const auto centre = item.find("centre")) term.centre = centre->vector3();
        term.half_width = item.key("half_width").number();
        term.outside = item.key("outside").choice({"zero", "repeat"}) == 0
                           ? Polynomials::Outside::zero
                           : Polynomials::Outside::repeat;
        fog.terms.push_back(std::move(term));
    }
    return fog;
}

Potentials::Object read_object(const JsonValue& value) {
    using Kind = Potentials::Object::Kind;
    Potentials::Object object;
    const auto point = value.find("point"), line = value.find("line"),
               sphere = value.find("sphere");
    if (int(point.has_value()) + int(line.has_value()) + int(sphere.has_value()) != 1)
        value.fail("needs one of \"point\", \"line\" and \"sphere\"");
    if (point) {
        value.only({"point", "extinction", "reach"});
        object.from = point->vector3();
    } else if (line) {
        value.only({"line", "extinction", "reach"});
        const auto ends = line->items();
        if (ends.size() != 2) line->fail("must be two points, [[x, y, z], [x, y, z]]");
        object.kind = Kind::line;
        object.from = ends[0].vector3();
        object.to = ends[1].vector3();
    } else {
        value.only({"sphere", "radius", "extinction", "reach"});
        object.kind = Kind::sphere;
        object.from = sphere->vector3();
        object.radius = value.key("radius").number();
    }
    object.extinction = value.key("extinction").number();
    object.reach = value.key("reach").number();
    return object;
}

Potentials read_potentials(const JsonValue& value) {
    only(value, {"extinction", "objects"});
    Potentials fog;
    fog.extinction = number_or(value, "extinction", 0);
    for (const JsonValue& object : value.key("objects").items())
        fog.objects.push_back(read_object(object));
    return fog;
}

Separable read_separable(const JsonValue& value) {
    only(value, {"extinction", "integral", "x", "y", "z"});
    Separable fog;
    fog.extinction = value.key("extinction").number();
    if (const auto integral = value.find("integral"))
        fog.integral = integral->choice({"exact", "published"}) == 0
                           ? Separable::Integral::exact
                           : Separable::Integral::published;
    for (const auto& [key, axis] : {std::pair{"x", 0u}, {"y", 1u}, {"z", 2u}})
        if (const auto table = value.find(key)) fog.axes[axis] = read_axis(*table);
    return fog;
}

/// `fog`: the entry with "model", which its shapes do not repeat.
FogModel read_unchecked(const JsonValue& fog, const JsonValue& value) {
    switch (fog.key("model").choice({"wavelet", "halfspace", "layers", "cosines", "polynomials",
                                     "potentials", "separable", "particles"})) {
        case 1:
            return read_halfspace(value);
        case 2:
            return read_layers(value);
        case 3:
            return read_cosines(value);
        case 4:
            return read_polynomials(value);
        case 5:
            return read_potentials(value);
        default:
            return read_separable(value);
    }
}

FogModel read_shape(const JsonValue& fog, const JsonValue& shape) {
    FogModel model = read_unchecked(fog, shape);
    if (const auto channels = fog.find("channels")) model.channels = read_channels(*channels);
    if (const auto ok = validate(model); !ok) shape.fail(ok.error().message);
    return model;
}

}  // namespace

Channels read_channels(const JsonValue& value) {
    const auto v = value.numbers(3);
    return {v[0], v[1], v[2]};
}

FogModel read_model(const JsonValue& value) {
    if (value.find("time")) value.fail("time belongs to the entries of \"shapes\"");
    return read_shape(value, value);
}

ModelMotion read_motion(const JsonValue& value) {
    ModelMotion motion;
    if (const auto wind = value.find("wind")) motion.wind = read_wind(*wind);
    const auto shapes = value.find("shapes");
    if (!shapes) return motion;
    value.only({"model", "wind", "channels", "shapes"});
    for (const JsonValue& shape : shapes->items()) {
        for (const char* key : {"model", "wind", "channels"})
            if (shape.find(key))
                shape.fail(fmt::format("\"{}\" stands beside \"shapes\", for all of them", key));
        const double seconds = shape.key("time").number();
        FogModel model = read_shape(value, shape);
        if (!motion.shapes.empty()) {
            const ModelMotion::Key& before = motion.shapes.back();
            if (!(before.seconds < seconds))
                shape.fail(fmt::format("time is {}, after {}; times must ascend", seconds,
                                       before.seconds));
            if (const auto ok = check_interpolable(before.shape, model); !ok)
                shape.fail(ok.error().message);
        }
        motion.shapes.push_back({seconds, std::move(model)});
    }
    if (motion.shapes.empty()) shapes->fail("is empty; give at least one shape");
    return motion;
}

}  // namespace wavefog::detail
