// Strict parsing of command-line values: a whole finite number or an error, never half of one.
#pragma once

#include <CLI/CLI.hpp>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "wavefog/fogmap/fog.h"
#include "wavefog/wavelet/result.h"

namespace wavefog::cli {

/// A finite decimal number that fills the whole text; "nan", "inf", "1x" and "" are errors.
Result<double> parse_number(std::string_view text);

/// A number within [low, high].
Result<double> parse_number_in(std::string_view text, double low, double high);

/// A number above 0, or two with a slash between them: "0.004", "1/255".
Result<double> parse_fraction(std::string_view text);

/// A whole number within [low, high].
Result<int> parse_integer_in(std::string_view text, int low, int high);

/// `count` numbers with commas between them.
Result<std::vector<double>> parse_numbers(std::string_view text, std::size_t count);

/// "x0,z0,x1,z1" with x0 < x1 and z0 < z1.
Result<Rect> parse_rect(std::string_view text);

/// "uniform", "slab:BOTTOM,TOP", "exponential:BASE,SCALE" or "linear:BASE,TOP", and back.
Result<Profile> parse_profile(std::string_view text);
std::string profile_text(const Profile& profile);

struct Size {
    int width = 0, height = 0;
};
/// "800x600", each side within 1..16384.
Result<Size> parse_size(std::string_view text);

/// The same for a map: at most 2^30 pixels in all, what read_fogmap() takes, whatever its sides.
Result<Size> parse_map_size(std::string_view text);

/// "auto" (-1) or a whole number >= 0.
Result<int> parse_levels(std::string_view text);

/// One of `names`, as its index.
Result<int> parse_choice(std::string_view text, const std::vector<std::string>& names);

/// An option whose text goes through `parse`; an error becomes CLI11's, which exits with 2.
/// `target` is a T or a std::optional<T>.
template <class Target, class Parse>
CLI::Option* add_parsed(CLI::App& app, const std::string& flag, Target& target, Parse parse,
                        const std::string& value_name, const std::string& description) {
    return app
        .add_option_function<std::string>(
            flag,
            [&target, parse, flag](const std::string& text) {
                auto value = parse(text);
                if (!value) throw CLI::ValidationError(flag, value.error().message);
                target = *std::move(value);
            },
            description)
        ->type_name(value_name);
}

/// --context osmesa|egl, for create_context().
void add_context(CLI::App& app, std::string& context);

namespace detail {
template <class T>
struct Unwrapped {
    using type = T;
};
template <class T>
struct Unwrapped<std::optional<T>> {
    using type = T;
};
}  // namespace detail

/// A choice among named enum values, listed in the order of the enum.
template <class Target>
CLI::Option* add_choice(CLI::App& app, const std::string& flag, Target& target,
                        std::vector<std::string> names, const std::string& description) {
    using Enum = typename detail::Unwrapped<Target>::type;
    std::string value_name;
    for (const std::string& name : names) value_name += (value_name.empty() ? "" : "|") + name;
    const auto parse = [names = std::move(names)](const std::string& text) {
        return parse_choice(text, names).map([](int index) { return static_cast<Enum>(index); });
    };
    return add_parsed(app, flag, target, parse, value_name, description);
}

}  // namespace wavefog::cli
