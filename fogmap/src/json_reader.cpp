#include "json_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

namespace wavefog::detail {

using nlohmann::json;

namespace {

struct Place {
    std::size_t line = 1, column = 1;
};

Place place_of(const std::string& text, std::size_t byte) {
    Place place;
    for (std::size_t i = 0; i < std::min(byte, text.size()); ++i)
        if (text[i] == '\n') {
            ++place.line;
            place.column = 1;
        } else {
            ++place.column;
        }
    return place;
}

// "[json.exception.parse_error.101] parse error at line 1, column 2: syntax error ...": what
// follows the place.
std::string reason(const std::string& what) {
    const auto colon = what.find(": ");
    return colon == std::string::npos ? what : what.substr(colon + 2);
}

}  // namespace

Result<json> parse_json(const std::string& text, const std::string& file) {
    // nlohmann keeps the last of two equal keys; a scene in which one of them is ignored is a
    // mistake.
    std::vector<std::set<std::string>> keys;
    std::string duplicate;
    const auto watch = [&](int, json::parse_event_t event, json& parsed) {
        if (event == json::parse_event_t::object_start) keys.emplace_back();
        if (event == json::parse_event_t::object_end) keys.pop_back();
        if (event == json::parse_event_t::key &&
            !keys.back().insert(parsed.get<std::string>()).second && duplicate.empty())
            duplicate = parsed.get<std::string>();
        return true;
    };
    try {
        json value = json::parse(text, watch);
        if (!duplicate.empty())
            return data_error(fmt::format("{}: key \"{}\" appears twice in one object; remove one",
                                          file, duplicate));
        return value;
    } catch (const json::parse_error& error) {
        // `byte` counts the character at which the parser stopped, from 1.
        const Place place = place_of(text, error.byte > 0 ? error.byte - 1 : 0);
        return data_error(fmt::format("{}: line {}, column {}: {}; correct the JSON", file,
                                      place.line, place.column, reason(error.what())));
    } catch (const json::out_of_range& error) {
        // "number overflow parsing '1e400'": where, nlohmann does not say.
        const std::string what = reason(error.what());
        const auto quote = what.find('\''), end = what.rfind('\'');
        const std::string number =
            quote < end ? what.substr(quote + 1, end - quote - 1) : std::string();
        const Place place = place_of(text, std::min(text.find(number), text.size()));
        return data_error(
            fmt::format("{}: line {}, column {}: {} is too large a number; correct it", file,
                        place.line, place.column, number));
    } catch (const json::exception& error) {
        return data_error(fmt::format("{}: {}; correct the JSON", file, reason(error.what())));
    }
}

std::string JsonValue::place() const {
    return path_.empty() ? *file_ : fmt::format("{}: {}", *file_, path_);
}

void JsonValue::fail(const std::string& what) const {
    throw JsonFailure{{ErrorKind::data, fmt::format("{}: {}", place(), what)}};
}

JsonValue JsonValue::child(std::string_view name, const json& value) const {
    return {value, *file_, path_.empty() ? std::string(name) : fmt::format("{}.{}", path_, name)};
}

const JsonValue& JsonValue::only(const std::vector<std::string_view>& keys) const {
    if (!value_->is_object()) fail(fmt::format("is {}; it must be an object", value_->type_name()));
    for (const auto& [name, value] : value_->items())
        if (std::find(keys.begin(), keys.end(), name) == keys.end())
            child(name, value)
                .fail(fmt::format("unknown key; valid keys here: {}", fmt::join(keys, ", ")));
    return *this;
}

JsonValue JsonValue::key(std::string_view name) const {
    const auto found = find(name);
    if (!found) child(name, *value_).fail("is missing; it is required");
    return *found;
}

std::optional<JsonValue> JsonValue::find(std::string_view name) const {
    if (!value_->is_object()) fail(fmt::format("is {}; it must be an object", value_->type_name()));
    const auto found = value_->find(name);
    if (found == value_->end()) return std::nullopt;
    return child(name, *found);
}

double JsonValue::number() const {
    if (!value_->is_number()) fail(fmt::format("is {}; it must be a number", value_->dump()));
    const double number = value_->get<double>();
    if (!std::isfinite(number)) fail("is not finite; it must be a finite number");
    return number;
}

double JsonValue::number(double low, double high) const {
    const double value = number();
    if (!(value >= low && value <= high)) {
        if (std::isinf(high)) fail(fmt::format("is {}; it must be {} or more", value, low));
        fail(fmt::format("is {}; it must be {} to {}", value, low, high));
    }
    return value;
}

double JsonValue::above(double low) const {
    const double value = number();
    if (!(value > low)) fail(fmt::format("is {}; it must be above {}", value, low));
    return value;
}

int JsonValue::integer(int low, int high) const {
    const double value = number();
    if (value != std::floor(value)) fail(fmt::format("is {}; it must be a whole number", value));
    if (!(value >= low && value <= high))
        fail(fmt::format("is {}; it must be {} to {}", value, low, high));
    return static_cast<int>(value);
}

bool JsonValue::boolean() const {
    if (!value_->is_boolean()) fail(fmt::format("is {}; it must be true or false", value_->dump()));
    return value_->get<bool>();
}

std::string JsonValue::text() const {
    if (!value_->is_string())
        fail(fmt::format("is {}; it must be a text in quotes", value_->dump()));
    return value_->get<std::string>();
}

int JsonValue::choice(std::initializer_list<std::string_view> choices) const {
    const std::string value = text();
    const auto found = std::find(choices.begin(), choices.end(), value);
    if (found == choices.end())
        fail(fmt::format("is \"{}\"; it must be one of: {}", value, fmt::join(choices, ", ")));
    return static_cast<int>(found - choices.begin());
}

std::vector<JsonValue> JsonValue::items() const {
    if (!value_->is_array()) fail(fmt::format("is {}; it must be a list", value_->type_name()));
    std::vector<JsonValue> items;
    for (std::size_t i = 0; i < value_->size(); ++i)
        items.emplace_back((*value_)[i], *file_, fmt::format("{}[{}]", path_, i));
    return items;
}

std::vector<double> JsonValue::numbers(std::size_t count) const {
    const auto list = items();
    if (list.size() != count)
        fail(fmt::format("has {} entries; it must be a list of {} numbers", list.size(), count));
    std::vector<double> values;
    for (const JsonValue& item : list) values.push_back(item.number());
    return values;
}

Eigen::Vector3d JsonValue::vector3() const {
    const auto v = numbers(3);
    return {v[0], v[1], v[2]};
}

Rect JsonValue::rect() const {
    const auto v = numbers(4);
    if (!(v[0] < v[2] && v[1] < v[3]))
        fail(fmt::format("is [{}]; it must be [x0, z0, x1, z1] with x0 < x1 and z0 < z1",
                         fmt::join(v, ", ")));
    return {v[0], v[1], v[2], v[3]};
}

Profile read_profile(const JsonValue& value) {
    Profile profile;
    const JsonValue name = value.key("profile");
    switch (name.choice({"uniform", "slab", "exponential", "linear"})) {
        case 0:
            profile.kind = Profile::Kind::uniform;
            value.only({"profile"});
            break;
        case 1:
            profile.kind = Profile::Kind::slab;
            value.only({"profile", "bottom", "top"});
            profile.bottom = value.key("bottom").number();
            profile.top = value.key("top").number();
            break;
        case 2:
            profile.kind = Profile::Kind::exponential;
            value.only({"profile", "base", "scale"});
            profile.base = value.key("base").number();
            profile.scale = value.key("scale").number();
            break;
        default:
            profile.kind = Profile::Kind::linear;
            value.only({"profile", "base", "top"});
            profile.base = value.key("base").number();
            profile.top = value.key("top").number();
    }
    if (const auto ok = profile.validate(); !ok) value.fail(ok.error().message);
    return profile;
}

json write_profile(const Profile& profile) {
    switch (profile.kind) {
        case Profile::Kind::uniform:
            return {{"profile", "uniform"}};
        case Profile::Kind::slab:
            return {{"profile", "slab"}, {"bottom", profile.bottom}, {"top", profile.top}};
        case Profile::Kind::exponential:
            return {{"profile", "exponential"}, {"base", profile.base}, {"scale", profile.scale}};
        case Profile::Kind::linear:
            break;
    }
    return {{"profile", "linear"}, {"base", profile.base}, {"top", profile.top}};
}

Wind read_wind(const JsonValue& value) {
    const auto items = value.items();
    Wind wind;
    if (items.size() == 2 && !items[0].is_list()) {
        const auto v = value.numbers(2);
        if (v[0] != 0 || v[1] != 0) wind = {v[0], v[1]};
    } else {
        if (items.empty() || !items[0].is_list())
            value.fail(
                fmt::format("has {} entries; it must be [vx, vz] in m/s, or a list of [t, vx, "
                            "vz] where it changes in time",
                            items.size()));
        for (const JsonValue& item : items) {
            const auto v = item.numbers(3);
            wind.keys.push_back({v[0], v[1], v[2]});
        }
    }
    if (const auto ok = wind.validate(); !ok) value.fail(ok.error().message);
    return wind;
}

json write_wind(const Wind& wind) {
    if (wind.keys.empty()) return {0, 0};
    if (wind.constant()) return {wind.keys[0].x, wind.keys[0].z};
    json keys = json::array();
    for (const Wind::Key& key : wind.keys) keys.push_back({key.seconds, key.x, key.z});
    return keys;
}

}  // namespace wavefog::detail
