#include "rays.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <string_view>

#include "options.h"

namespace wavefog::cli {
namespace {

// Fourth powers of lengths must stay below float32's largest number.
constexpr double kFarthest = 1e9;
constexpr std::array<const char*, 6> columns = {"ox", "oy", "oz", "px", "py", "pz"};

std::string_view trimmed(std::string_view text) {
    const auto begin = text.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return {};
    return text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

std::vector<std::string_view> fields_of(std::string_view line) {
    std::vector<std::string_view> fields;
    for (;;) {
        const auto end = line.find(',');
        fields.push_back(trimmed(line.substr(0, end)));
        if (end == std::string_view::npos) return fields;
        line.remove_prefix(end + 1);
    }
}

bool is_header(const std::vector<std::string_view>& fields) {
    for (const std::string_view field : fields)
        if (field.empty() || parse_number(field)) return false;
    return true;
}

}  // namespace

Result<RayTable> read_rays(std::istream& input, const std::string& name) {
    RayTable table;
    std::string line;
    bool first = true;
    for (std::size_t number = 1; std::getline(input, line); ++number) {
        if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
        const std::string_view row = trimmed(line);
        if (row.empty()) continue;
        const auto fields = fields_of(row);
        if (fields.size() != columns.size())
            return data_error(
                fmt::format("{}: line {} has {} column{}; write ox,oy,oz,px,py,pz in every line",
                            name, number, fields.size(), fields.size() == 1 ? "" : "s"));
        if (first && is_header(fields)) {
            table.header = row;
            first = false;
            continue;
        }
        first = false;
        std::array<double, columns.size()> values{};
        for (std::size_t c = 0; c < columns.size(); ++c) {
            const Result<double> value = parse_number(fields[c]);
            if (!value)
                return data_error(fmt::format("{}: line {}, column {} ({}): {}", name, number,
                                              c + 1, columns[c], value.error().message));
            if (std::abs(*value) > kFarthest)
                return data_error(
                    fmt::format("{}: line {}, column {} ({}): {} m is farther than "
                                "float32 methods reach; stay within {} m",
                                name, number, c + 1, columns[c], *value, kFarthest));
            values[c] = *value;
        }
        table.rays.push_back({{values[0], values[1], values[2]},
                              {values[3], values[4], values[5]},
                              std::string(row)});
    }
    if (input.bad()) return data_error(name + ": cannot be read to its end; check the file");
    if (table.rays.empty())
        return data_error(name + ": holds no rays; write rows ox,oy,oz,px,py,pz in metres");
    return table;
}

}  // namespace wavefog::cli
