#include "bench/table_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace wavefog::cli {

std::string short_number(const std::optional<double>& value) {
    if (!value) return "-";
    const double size = std::abs(*value);
    return fmt::format("{:.{}f}", *value, size < 9.995 ? 2 : size < 99.95 ? 1 : 0);
}

std::string error_number(const std::optional<double>& value) {
    return value ? fmt::format("{:.1e}", *value) : "-";
}

namespace {

/// A bar inside a Markdown cell would end it.
std::string escaped(const std::string& cell) {
    std::string text;
    for (const char c : cell) {
        if (c == '|') text += '\\';
        text += c;
    }
    return text;
}

}  // namespace

std::string Table::text(bool markdown) const {
    std::vector<std::vector<std::string>> rows = rows_;
    if (markdown)
        for (auto& row : rows)
            for (auto& cell : row) cell = escaped(cell);
    std::vector<std::size_t> widths;
    // Counts characters, not bytes: all of ours are one column wide.
    const auto width = [](const std::string& cell) {
        return std::size_t(std::count_if(cell.begin(), cell.end(), [](char c) {
            return (static_cast<unsigned char>(c) & 0xC0) != 0x80;
        }));
    };
    for (const auto& row : rows)
        for (std::size_t i = 0; i < row.size(); ++i) {
            if (widths.size() <= i) widths.push_back(3);
            widths[i] = std::max(widths[i], width(row[i]));
        }
    const auto left = [&](std::size_t column) {
        return column == 0 || (column < rows[0].size() && rows[0][column].empty());
    };
    std::string text;
    for (std::size_t r = 0; r < rows.size(); ++r) {
        std::string line = markdown ? "|" : "";
        for (std::size_t i = 0; i < widths.size(); ++i) {
            const std::string cell = i < rows[r].size() ? rows[r][i] : std::string();
            const std::string space(widths[i] - width(cell), ' ');
            if (markdown || i > 0) line += ' ';
            line += left(i) ? cell : space;
            line += left(i) ? space : cell;
            line += markdown ? " |" : " ";
        }
        line.erase(line.find_last_not_of(' ') + 1);
        text += line + '\n';
        if (markdown && r == 0) {
            text += '|';
            for (std::size_t i = 0; i < widths.size(); ++i) {
                text += ' ';
                text.append(left(i) ? widths[i] : widths[i] - 1, '-');
                text += left(i) ? " |" : ": |";
            }
            text += '\n';
        }
    }
    return text;
}

std::string rows_text(const std::vector<Row>& rows, bool markdown) {
    std::string text;
    for (std::size_t begin = 0; begin < rows.size();) {
        std::size_t end = begin;
        bool levels_differ = false, mus_differ = false;
        for (; end < rows.size() && rows[end].group == rows[begin].group; ++end) {
            levels_differ |= rows[end].levels != rows[begin].levels;
            mus_differ |= rows[end].mu != rows[begin].mu;
        }
        const Row& first = rows[begin];
        text += fmt::format(
            "{}{}: {}, {}x{}, {}, family {}, {} levels, drawn at {}x{}\n\n", begin > 0 ? "\n" : "",
            first.scene, first.map, first.map_width, first.map_height, first.basis, first.family,
            levels_differ ? "several" : std::to_string(first.levels), first.width, first.height);
        std::vector<std::string> header = {"method"};
        if (levels_differ) header.push_back("levels");
        if (mus_differ) header.push_back("μ");
        for (const char* name : {"ms", "[5 %, 95 %]", "fps", "× homogeneous", "max |ΔT|", "bound",
                                 "99 % |ΔT|", "PSNR, dB", "SSIM", "KiB"})
            header.push_back(name);
        Table table(header);
        for (std::size_t i = begin; i < end; ++i) {
            const Row& row = rows[i];
            std::vector<std::string> cells = {row.method};
            if (levels_differ) cells.push_back(std::to_string(row.levels));
            if (mus_differ) cells.push_back(fmt::format("{}", row.mu));
            cells.push_back(short_number(row.ms_median));
            cells.push_back(
                fmt::format("[{}, {}]", short_number(row.ms_p05), short_number(row.ms_p95)));
            cells.push_back(short_number(row.fps));
            cells.push_back(short_number(row.ratio_homogeneous));
            cells.push_back(error_number(row.max_dT));
            cells.push_back(error_number(row.bound_dT));
            cells.push_back(error_number(row.p99_dT));
            cells.push_back(row.psnr ? fmt::format("{:.1f}", *row.psnr) : "-");
            cells.push_back(row.ssim ? fmt::format("{:.4f}", *row.ssim) : "-");
            cells.push_back(row.bytes ? fmt::format("{:.0f}", double(*row.bytes) / 1024) : "-");
            table.add(std::move(cells));
        }
        text += table.text(markdown);
        begin = end;
    }
    return text;
}

}  // namespace wavefog::cli
