#include "bench/resolution.h"

#include <fmt/format.h>

#include <algorithm>

#include "bench/table_text.h"

namespace wavefog::cli {
namespace {

constexpr int kSides[] = {512, 256, 128};

std::vector<FogSampling> samplings(const Method& method) {
    std::vector<FogSampling> all = {{}};
    for (const auto upsample : {FogSampling::Upsample::aware, FogSampling::Upsample::average})
        for (const int side : kSides) all.push_back({side, side, upsample, false});
    if (method.kind != MethodKind::radial) all.push_back({0, 0, {}, true});
    return all;
}

/// What follows the "@".
std::string sampling_of(const Row& row) {
    const auto at = row.method.find('@');
    return at == std::string::npos ? "" : row.method.substr(at + 1);
}

std::string base_of(const Row& row) {
    return row.method.substr(0, row.method.find('@'));
}

/// The row of the same scene and method that has fog in every pixel, if it was measured.
const Row* every_pixel(const std::vector<Row>& rows, const Row& row) {
    const auto found = std::find_if(rows.begin(), rows.end(), [&](const Row& other) {
        return other.group == row.group && other.method == base_of(row) && other.ms_median;
    });
    return found == rows.end() ? nullptr : &*found;
}

std::optional<double> relative_cost(const std::vector<Row>& rows, const Row& row) {
    const Row* full = every_pixel(rows, row);
    if (full == nullptr || !row.ms_median) return std::nullopt;
    return *row.ms_median / *full->ms_median;
}

/// Which curve of a chart a row belongs to.
std::string curve_of(const Row& row) {
    const std::string sampling = sampling_of(row);
    if (sampling.empty()) return "every pixel";
    if (sampling == "vertices") return sampling;
    return sampling.find(":average") == std::string::npos ? "aware" : "average";
}

/// "256²" of "256x256:average".
std::string size_of(const Row& row) {
    const std::string sampling = sampling_of(row);
    return sampling.substr(0, sampling.find('x')) + "²";
}

Figure figure_of(const std::vector<Row>& rows, const Row& full) {
    Figure figure;
    figure.id = fmt::format("resolution-{}-{}", full.group, full.method);
    std::replace_if(
        figure.id.begin(), figure.id.end(), [](unsigned char c) { return std::isalnum(c) == 0; },
        '-');
    figure.title = "Fog in fewer places than pixels: " + full.scene;
    figure.subtitle = fmt::format("{}×{} pixels, {}; reduced pictures of 512², 256² and 128²",
                                  full.width, full.height, full.method);
    figure.x.label = "cost of the fog pass, × fog in every pixel";
    figure.y.label = "error of transmittance in 99 % of the pixels, |ΔT|";
    figure.levels.push_back({kVisibleError, "least visible\nerror, 1/510"});
    figure.top_label = "milliseconds";
    figure.top_factor = *full.ms_median;
    for (const char* name : {"aware", "average", "vertices"}) {
        Curve curve{name, name, Curve::Style::line, {}};
        for (const Row& row : rows) {
            const auto cost = relative_cost(rows, row);
            if (row.group != full.group || base_of(row) != full.method || curve_of(row) != name ||
                !cost || !row.p99_dT)
                continue;
            curve.points.emplace_back(*cost, *row.p99_dT);
            figure.notes.push_back(
                {*cost, *row.p99_dT, curve.key == "vertices" ? "vertices" : size_of(row), name});
        }
        if (!curve.points.empty()) figure.curves.push_back(std::move(curve));
    }
    return figure;
}

}  // namespace

Result<std::vector<Group>> plan_resolution(const std::vector<BenchScene>& scenes, const Size& size,
                                           const std::vector<Method>& methods) {
    std::vector<Group> groups;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        auto variant = make_variant(scenes[i], {});
        if (!variant) return tl::unexpected(variant.error());
        Group group{scenes[i].name, i, size, {*std::move(variant)}, {}};
        for (Method method : methods)
            for (const FogSampling& sampling : samplings(method)) {
                method.sampling = sampling;
                group.cases.push_back({0, method});
            }
        groups.push_back(std::move(group));
    }
    return groups;
}

std::string resolution_text(const std::vector<Row>& rows, bool markdown) {
    Table table({"scene, fog in", "ms", "× every pixel", "max |ΔT|", "99 % |ΔT|", "PSNR, dB"});
    for (const Row& row : rows) {
        const auto cost = relative_cost(rows, row);
        if (!cost || row.method == homogeneous_method().name()) continue;
        const std::string curve = curve_of(row);
        const bool reduced = curve == "aware" || curve == "average";
        table.add({fmt::format("{}, {}, {}", row.scene, base_of(row),
                               reduced ? size_of(row) + " " + curve : curve),
                   short_number(row.ms_median), short_number(cost), error_number(row.max_dT),
                   error_number(row.p99_dT), row.psnr ? fmt::format("{:.1f}", *row.psnr) : "-"});
    }
    return table.text(markdown);
}

std::vector<Figure> resolution_figures(const std::vector<Row>& rows) {
    std::vector<Figure> figures;
    for (const Row& row : rows)
        if (sampling_of(row).empty() && row.ms_median && row.p99_dT &&
            row.method != homogeneous_method().name())
            figures.push_back(figure_of(rows, row));
    return figures;
}

}  // namespace wavefog::cli
