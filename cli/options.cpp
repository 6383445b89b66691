#include "options.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <cstdint>

namespace wavefog::cli {
namespace {

constexpr int largest_side = 16384;  // what OpenGL 4.5 guarantees for textures
constexpr std::int64_t largest_map = std::int64_t{1} << 30;

std::vector<std::string_view> split(std::string_view text, char separator) {
    std::vector<std::string_view> parts;
    for (;;) {
        const auto end = text.find(separator);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos) return parts;
        text.remove_prefix(end + 1);
    }
}

template <class T>
bool parse_whole(std::string_view text, T& value) {
    if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
    const char* end = text.data() + text.size();
    const auto [stop, code] = std::from_chars(text.data(), end, value);
    return code == std::errc() && stop == end;
}

/// "WIDTHxHEIGHT", each at least 1.
std::optional<Size> sides_of(std::string_view text) {
    const auto parts = split(text, 'x');
    Size size;
    if (parts.size() != 2 || !parse_whole(parts[0], size.width) ||
        !parse_whole(parts[1], size.height) || size.width < 1 || size.height < 1)
        return std::nullopt;
    return size;
}

}  // namespace

Result<double> parse_number(std::string_view text) {
    double value = 0;
    if (!parse_whole(text, value) || !std::isfinite(value))
        return usage_error(fmt::format("'{}' is not a finite number; write it like 0.05", text));
    return value;
}

Result<double> parse_number_in(std::string_view text, double low, double high) {
    Result<double> value = parse_number(text);
    if (value && (*value < low || *value > high)) {
        if (std::isinf(high))
            return usage_error(fmt::format("{} is out of range; use {} or more", text, low));
        return usage_error(fmt::format("{} is out of range; use {} to {}", text, low, high));
    }
    return value;
}

Result<double> parse_fraction(std::string_view text) {
    const std::size_t slash = text.find('/');
    const auto above = parse_number(text.substr(0, slash));
    const auto below =
        slash == text.npos ? Result<double>(1.0) : parse_number(text.substr(slash + 1));
    if (!above || !below || !(*above > 0) || !(*below > 0) || !std::isfinite(*above / *below) ||
        *above / *below <= 0)
        return usage_error(fmt::format("'{}' is no number above 0, such as 0.004 or 1/255", text));
    return *above / *below;
}

Result<int> parse_integer_in(std::string_view text, int low, int high) {
    int value = 0;
    if (!parse_whole(text, value) || value < low || value > high)
        return usage_error(
            fmt::format("'{}' is out of range; use a whole number from {} to {}", text, low, high));
    return value;
}

Result<std::vector<double>> parse_numbers(std::string_view text, std::size_t count) {
    const auto parts = split(text, ',');
    if (parts.size() != count)
        return usage_error(fmt::format("'{}' has {} value{}; write {} with commas between them",
                                       text, parts.size(), parts.size() == 1 ? "" : "s", count));
    std::vector<double> values;
    for (const std::string_view part : parts) {
        const Result<double> value = parse_number(part);
        if (!value) return tl::unexpected(value.error());
        values.push_back(*value);
    }
    return values;
}

Result<Rect> parse_rect(std::string_view text) {
    const auto values = parse_numbers(text, 4);
    if (!values) return tl::unexpected(values.error());
    const auto& v = *values;
    const Rect rect{v[0], v[1], v[2], v[3]};
    if (rect.x0 >= rect.x1 || rect.z0 >= rect.z1)
        return usage_error(
            fmt::format("'{}' has no area; write x0,z0,x1,z1 with x0 < x1 and z0 < z1", text));
    return rect;
}

Result<Profile> parse_profile(std::string_view text) {
    const auto colon = text.find(':');
    const std::string_view name = text.substr(0, colon);
    const bool has_values = colon != std::string_view::npos;
    Profile profile;
    if (name == "uniform" && !has_values) return profile;
    if (name == "slab")
        profile.kind = Profile::Kind::slab;
    else if (name == "exponential")
        profile.kind = Profile::Kind::exponential;
    else if (name == "linear")
        profile.kind = Profile::Kind::linear;
    if (profile.kind == Profile::Kind::uniform || !has_values)
        return usage_error(fmt::format(
            "'{}' is not a height profile; use uniform, slab:BOTTOM,TOP, exponential:BASE,SCALE or "
            "linear:BASE,TOP",
            text));
    const auto values = parse_numbers(text.substr(colon + 1), 2);
    if (!values) return tl::unexpected(values.error());
    const double first = (*values)[0], second = (*values)[1];
    switch (profile.kind) {
        case Profile::Kind::slab:
            profile.bottom = first, profile.top = second;
            break;
        case Profile::Kind::exponential:
            profile.base = first, profile.scale = second;
            break;
        case Profile::Kind::linear:
            profile.base = first, profile.top = second;
            break;
        case Profile::Kind::uniform:
            break;
    }
    if (auto valid = profile.validate(); !valid) return usage_error(valid.error().message);
    return profile;
}

std::string profile_text(const Profile& profile) {
    switch (profile.kind) {
        case Profile::Kind::slab:
            return fmt::format("slab:{},{}", profile.bottom, profile.top);
        case Profile::Kind::exponential:
            return fmt::format("exponential:{},{}", profile.base, profile.scale);
        case Profile::Kind::linear:
            return fmt::format("linear:{},{}", profile.base, profile.top);
        case Profile::Kind::uniform:
            break;
    }
    return "uniform";
}

Result<Size> parse_size(std::string_view text) {
    const auto size = sides_of(text);
    if (!size || size->width > largest_side || size->height > largest_side)
        return usage_error(fmt::format("'{}' is not a size; write WIDTHxHEIGHT, each from 1 to {}",
                                       text, largest_side));
    return *size;
}

Result<Size> parse_map_size(std::string_view text) {
    const auto size = sides_of(text);
    if (!size || std::int64_t{size->width} * size->height > largest_map)
        return usage_error(fmt::format(
            "'{}' is not a map's size; write WIDTHxHEIGHT, at most 2^30 pixels in all", text));
    return *size;
}

Result<int> parse_levels(std::string_view text) {
    if (text == "auto") return -1;
    return parse_integer_in(text, 0, 30).map_error([&](Error error) {
        error.message += ", or auto";
        return error;
    });
}

Result<int> parse_choice(std::string_view text, const std::vector<std::string>& names) {
    for (std::size_t i = 0; i < names.size(); ++i)
        if (names[i] == text) return static_cast<int>(i);
    return usage_error(fmt::format("'{}' is not known; use {}", text, fmt::join(names, ", ")));
}

void add_context(CLI::App& app, std::string& context) {
    app.add_option("--context", context,
                   "OpenGL by osmesa (no display, no GPU) or egl (a GPU without a display) "
                   "(osmesa)")
        ->type_name("osmesa|egl");
}

}  // namespace wavefog::cli
