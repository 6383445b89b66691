#include "report.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "options.h"

namespace wavefog::cli {
namespace {

std::string value_text(const Facts& value) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
    std::string text;
    if (value.is_object()) {
        for (const auto& [key, item] : value.items())
            text += (text.empty() ? "" : ", ") + key + " " + value_text(item);
        return text;
    }
    if (!value.is_array()) return value.dump();
    for (const Facts& item : value) text += (text.empty() ? "" : ", ") + value_text(item);
    return text;
}

/// "energy_share" is shown as "energy share".
std::string title_text(std::string key) {
    std::replace(key.begin(), key.end(), '_', ' ');
    return key;
}

/// Such lists are printed one a line.
bool is_sentence(const Facts& value) {
    return value.is_string() && value.get<std::string>().find(' ') != std::string::npos;
}

void print_table(const Facts& rows) {
    std::vector<std::vector<std::string>> columns;
    for (const auto& [key, value] : rows.front().items()) {
        std::vector<std::string> column = {title_text(key)};
        for (const Facts& row : rows) column.push_back(value_text(row.at(key)));
        columns.push_back(std::move(column));
    }
    for (std::size_t row = 0; row <= rows.size(); ++row) {
        for (const auto& column : columns) {
            const auto widest =
                std::max_element(column.begin(), column.end(),
                                 [](const auto& a, const auto& b) { return a.size() < b.size(); });
            fmt::print("  {:>{}}", column[row], widest->size());
        }
        fmt::print("\n");
    }
}

}  // namespace

void print_facts(const Facts& facts, bool as_json) {
    if (as_json) {
        fmt::print("{}\n", facts.dump(2));
        return;
    }
    std::size_t widest = 0;
    for (const auto& [key, value] : facts.items()) widest = std::max(widest, key.size());
    for (const auto& [key, value] : facts.items()) {
        if (value.is_array() && !value.empty() && value.front().is_object()) {
            fmt::print("{}:\n", title_text(key));
            print_table(value);
        } else if (value.is_array() && !value.empty() && is_sentence(value.front())) {
            fmt::print("{}:\n", title_text(key));
            for (const Facts& line : value) fmt::print("  {}\n", value_text(line));
        } else {
            fmt::print("{:<{}}  {}\n", title_text(key) + ":", widest + 1, value_text(value));
        }
    }
}

void warn(const std::string& message) {
    fmt::print(stderr, "wavefog: warning: {}\n", message);
}

Facts fog_facts(const Fog& fog) {
    const Decomposition<float>& d = fog.decomposition;
    return {{"size", {d.width, d.height}},
            {"basis", basis_name(d.degree())},
            {"family", d.family.name()},
            {"form", d.form == Form::wavelet ? "wavelet" : "scaling"},
            {"wrap", d.boundary == Boundary::zero ? "zero" : "repeat"},
            {"levels", d.levels()},
            {"rect", {fog.rect.x0, fog.rect.z0, fog.rect.x1, fog.rect.z1}},
            {"cell", {fog.cell_x(), fog.cell_z()}},
            {"extinction", fog.extinction},
            {"profile", profile_text(fog.profile)}};
}

Facts stream_facts(const LoadNotes& notes) {
    if (notes.of_levels == 0) return Facts::object();
    Facts facts = {{"stream_levels", notes.stream_levels}, {"of_stream_levels", notes.of_levels}};
    if (notes.stream_levels == notes.of_levels) facts["max_error"] = notes.max_error;
    return facts;
}

}  // namespace wavefog::cli
