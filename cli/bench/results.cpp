#include "bench/results.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <type_traits>

namespace wavefog::cli {
namespace {

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};

/// JSON has no infinity and no NaN: such a figure counts as not measured.
template <class T>
Facts value_json(const T& value) {
    if constexpr (IsOptional<T>::value)
        return value ? value_json(*value) : Facts();
    else if constexpr (std::is_floating_point_v<T>)
        return std::isfinite(value) ? Facts(value) : Facts();
    else
        return value;
}

/// Reads `object[key]` into a string, a number or an optional, which results of an older version
/// may lack; throws the JSON library's errors.
template <class T>
void read_value(const Facts& object, const char* key, T& value) {
    if (IsOptional<T>::value && !object.contains(key)) return;
    const Facts& stored = object.at(key);
    if constexpr (IsOptional<T>::value) {
        if (stored.is_null())
            value.reset();
        else
            value = stored.get<typename T::value_type>();
    } else {
        value = stored.get<T>();
    }
}

Facts axis_json(const Axis& axis) {
    return {{"label", axis.label},
            {"log", axis.log},
            {"low", axis.low},
            {"high", axis.high},
            {"step", axis.step}};
}

Axis axis_from(const Facts& json) {
    return {json.at("label"), json.at("log"), json.at("low"), json.at("high"), json.at("step")};
}

constexpr const char* style_names[] = {"line", "points", "dashed", "plain"};

Curve::Style style_from(const std::string& name) {
    for (int i = 0; i < 4; ++i)
        if (name == style_names[i]) return static_cast<Curve::Style>(i);
    throw std::out_of_range("style '" + name + "' is not line, points, dashed or plain");
}

Facts figure_json(const Figure& figure) {
    Facts levels = Facts::array(), curves = Facts::array(), notes = Facts::array();
    for (const Level& level : figure.levels)
        levels.push_back({{"y", level.y}, {"label", level.label}});
    for (const Curve& curve : figure.curves) {
        Facts points = Facts::array();
        for (const auto& [x, y] : curve.points) points.push_back({value_json(x), value_json(y)});
        curves.push_back({{"name", curve.name},
                          {"key", curve.key},
                          {"style", style_names[static_cast<int>(curve.style)]},
                          {"points", points}});
    }
    for (const Note& note : figure.notes)
        notes.push_back({{"x", note.x}, {"y", note.y}, {"text", note.text}, {"key", note.key}});
    return {{"id", figure.id},
            {"title", figure.title},
            {"subtitle", figure.subtitle},
            {"x", axis_json(figure.x)},
            {"y", axis_json(figure.y)},
            {"top_label", figure.top_label},
            {"top_factor", figure.top_factor},
            {"levels", levels},
            {"curves", curves},
            {"notes", notes}};
}

Figure figure_from(const Facts& json) {
    Figure figure;
    figure.id = json.at("id");
    figure.title = json.at("title");
    figure.subtitle = json.at("subtitle");
    figure.x = axis_from(json.at("x"));
    figure.y = axis_from(json.at("y"));
    figure.top_label = json.at("top_label");
    figure.top_factor = json.at("top_factor");
    for (const Facts& level : json.at("levels"))
        figure.levels.push_back({level.at("y"), level.at("label")});
    for (const Facts& stored : json.at("curves")) {
        Curve curve{stored.at("name"), stored.at("key"), style_from(stored.at("style")), {}};
        for (const Facts& point : stored.at("points"))
            if (point.at(0).is_number() && point.at(1).is_number())
                curve.points.emplace_back(point.at(0), point.at(1));
        figure.curves.push_back(std::move(curve));
    }
    for (const Facts& note : json.at("notes"))
        figure.notes.push_back({note.at("x"), note.at("y"), note.at("text"), note.at("key")});
    return figure;
}

/// Quotes where commas or quotes ask for it (RFC 4180).
std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
    return quoted + "\"";
}

std::string csv_value(const Facts& value) {
    if (value.is_null()) return "";
    return value.is_string() ? csv_field(value.get<std::string>()) : value.dump();
}

}  // namespace

Facts to_json(const Results& results) {
    Facts rows = Facts::array(), figures = Facts::array();
    for (const Row& row : results.rows) {
        Facts json = Facts::object();
        for_each_column(row,
                        [&](const char* key, const auto& value) { json[key] = value_json(value); });
        rows.push_back(std::move(json));
    }
    for (const Figure& figure : results.figures) figures.push_back(figure_json(figure));
    return {{"provenance", results.provenance},
            {"rows", rows},
            {"figures", figures},
            {"compression", results.compression},
            {"ray_promise", results.ray_promise},
            {"motion", results.motion},
            {"cut", results.cut},
            {"skipped", results.skipped}};
}

Result<Results> read_results(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) return data_error(file.string() + ": cannot be opened; check the path");
    try {
        const Facts json = Facts::parse(stream);
        Results results;
        results.provenance = json.at("provenance");
        for (const Facts& stored : json.at("rows")) {
            Row row;
            for_each_column(row,
                            [&](const char* key, auto& value) { read_value(stored, key, value); });
            results.rows.push_back(std::move(row));
        }
        for (const Facts& figure : json.at("figures"))
            results.figures.push_back(figure_from(figure));
        results.compression = json.value("compression", Facts::array());
        results.ray_promise = json.value("ray_promise", Facts::array());
        results.motion = json.value("motion", Facts::array());
        results.cut = json.at("cut").get<std::vector<std::string>>();
        results.skipped = json.at("skipped").get<std::vector<std::string>>();
        return results;
    } catch (const std::exception& error) {
        return data_error(
            fmt::format("{}: not a results file of wavefog bench ({}); make it with "
                        "`wavefog bench SCENE.json -o DIR`",
                        file.string(), error.what()));
    }
}

std::string rows_csv(const std::vector<Row>& rows) {
    std::string text;
    const Row header;
    for_each_column(header, [&](const char* key, const auto&) {
        if (!text.empty()) text += ',';
        text += key;
    });
    text += '\n';
    for (const Row& row : rows) {
        bool first = true;
        for_each_column(row, [&](const char*, const auto& value) {
            if (!first) text += ',';
            text += csv_value(value_json(value));
            first = false;
        });
        text += '\n';
    }
    return text;
}

std::string figures_csv(const std::vector<Figure>& figures) {
    std::string text = "figure,curve,x,y\n";
    for (const Figure& figure : figures)
        for (const Curve& curve : figure.curves)
            for (const auto& [x, y] : curve.points)
                text += fmt::format("{},{},{},{}\n", csv_field(figure.id),
                                    csv_field(curve.name.empty() ? curve.key : curve.name),
                                    csv_value(value_json(x)), csv_value(value_json(y)));
    return text;
}

std::vector<std::vector<Row>> groups_of(const std::vector<Row>& rows) {
    std::vector<std::vector<Row>> groups;
    for (const Row& row : rows) {
        if (groups.empty() || groups.back().front().group != row.group) groups.emplace_back();
        groups.back().push_back(row);
    }
    return groups;
}

std::string setting_name(const Row& row) {
    std::string name = row.method;
    if (row.mu < 1) name += fmt::format(", μ {}", row.mu);
    if (row.reused.value_or(false)) name += ", reused";
    return name;
}

std::string method_base(const std::string& method) {
    return method.substr(0, method.find_first_of(":@"));
}

}  // namespace wavefog::cli
