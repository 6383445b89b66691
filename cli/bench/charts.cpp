#include "bench/charts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "bench/advantage.h"
#include "bench/compression.h"
#include "bench/models.h"
#include "bench/resolution.h"

namespace wavefog::cli {
namespace {

/// Letters, digits and dashes only.
std::string file_name(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return std::isalnum(c) == 0; }, '-');
    return text;
}

std::string levels_text(int levels) {
    return fmt::format("{} level{}", levels, levels == 1 ? "" : "s");
}

/// What a point of a method's curve was set to.
std::string knob_text(const Row& row) {
    if (const auto colon = row.method.find(':'); colon != std::string::npos) {
        const std::string value = row.method.substr(colon + 1);
        return method_base(row.method) == "march" ? "N = " + value : value;
    }
    if (method_base(row.method) == "homogeneous") return "";
    return row.mu == 1 ? "μ = 1" : fmt::format("μ = {}, {}", row.mu, levels_text(row.levels));
}

/// Cost against error: all points of a method, and the curve of its best settings.
Figure error_figure(const std::vector<Row>& rows) {
    const Row& first = rows.front();
    Figure figure;
    figure.id = "error-" + file_name(first.group);
    figure.title = "Cost against error: " + first.scene;
    figure.subtitle =
        fmt::format("{}×{} {} map, {}×{} pixels; lines join each method's best settings",
                    first.map_width, first.map_height, first.basis, first.width, first.height);
    figure.x.label = "cost of the fog pass, × homogeneous fog";
    figure.y.label = "largest error of transmittance, max |ΔT|";
    figure.levels.push_back({kVisibleError, "least visible\nerror, 1/510"});
    if (first.ms_median) {
        figure.top_label = "milliseconds";
        figure.top_factor = *first.ms_median;
    }
    // Room for labels above the worst settings, which crowd at the top.
    figure.y.low = kVisibleError / 2;
    figure.y.high = kVisibleError;
    for (const Row& row : rows)
        if (row.max_dT && *row.max_dT > 0) {
            figure.y.low = std::min(figure.y.low, *row.max_dT / 2);
            figure.y.high = std::max(figure.y.high, *row.max_dT * 6);
        }
    std::vector<std::string> order;
    std::map<std::string, std::vector<Row>> by_method;
    for (const Row& row : rows) {
        if (!row.ratio_homogeneous || !row.max_dT) continue;
        const std::string base = method_base(row.method);
        if (!by_method.contains(base)) order.push_back(base);
        by_method[base].push_back(row);
    }
    for (const std::string& method : order) {
        std::vector<Row>& sweep = by_method[method];
        std::stable_sort(sweep.begin(), sweep.end(), [](const Row& a, const Row& b) {
            return *a.ratio_homogeneous < *b.ratio_homogeneous;
        });
        Curve best{method, method, Curve::Style::line, {}};
        Curve others{"", method, Curve::Style::points, {}};
        std::vector<const Row*> front;
        for (const Row& row : sweep) {
            if (front.empty() || *row.max_dT < *front.back()->max_dT) {
                front.push_back(&row);
                best.points.emplace_back(*row.ratio_homogeneous, *row.max_dT);
            } else {
                others.points.emplace_back(*row.ratio_homogeneous, *row.max_dT);
            }
        }
        figure.curves.push_back(std::move(best));
        if (!others.points.empty()) figure.curves.push_back(std::move(others));
        for (const Row* row : {front.front(), front.back()})
            if (!knob_text(*row).empty())
                figure.notes.push_back(
                    {*row->ratio_homogeneous, *row->max_dT, knob_text(*row), method});
        if (front.size() == 1 && !figure.notes.empty() && figure.notes.back().key == method)
            figure.notes.pop_back();
    }
    if (Curve bar = five_times_ours(rows); bar.points.size() > 1)
        figure.curves.push_back(std::move(bar));
    return figure;
}

/// Frames a second against mu, a curve a method and number of levels.
Figure speed_figure(const std::vector<Row>& rows) {
    const Row& first = rows.front();
    Figure figure;
    figure.id = "speed-" + file_name(first.group);
    figure.title = "Speed against detail: " + first.scene;
    // Room on the left for the level counts beside the points at mu = 0.
    figure.x = {"μ (1: all details along the whole ray, 0: none)", false, -0.17, 1.02, 0.2};
    figure.y.label = "frames a second (the fog pass alone)";
    figure.subtitle = fmt::format("{}×{} pixels", first.width, first.height);
    std::map<std::tuple<std::string, int, std::string, int>, Curve> curves;
    for (const Row& row : rows) {
        if (!row.fps) continue;
        Curve& curve = curves[{row.method, row.map_width, row.basis, row.levels}];
        curve.key = method_base(row.method);
        curve.name = fmt::format("{}, {} levels", row.method, row.levels);
        curve.points.emplace_back(row.mu, *row.fps);
    }
    for (auto& [key, curve] : curves) {
        if (curve.points.size() < 3) continue;
        std::sort(curve.points.begin(), curve.points.end());
        figure.notes.push_back({curve.points.front().first, curve.points.front().second,
                                levels_text(std::get<3>(key)), curve.key});
        figure.curves.push_back(std::move(curve));
    }
    // A key entry a method; the level counts stand beside the curves.
    for (std::size_t i = 0; i < figure.curves.size(); ++i) {
        const bool seen =
            std::any_of(figure.curves.begin(), figure.curves.begin() + std::ptrdiff_t(i),
                        [&](const Curve& c) { return c.key == figure.curves[i].key; });
        figure.curves[i].name = seen ? "" : figure.curves[i].key;
    }
    return figure;
}

}  // namespace

std::vector<Figure> figures_of(const Results& results) {
    if (results.preset() == "compression") return compression_figures(results.compression);
    if (results.preset() == "resolution") return resolution_figures(results.rows);
    if (results.preset() == "models") return {models_figure(results.rows)};
    std::vector<Figure> figures = results.figures;
    for (const std::vector<Row>& rows : groups_of(results.rows)) {
        const bool measured = std::any_of(rows.begin(), rows.end(),
                                          [](const Row& row) { return row.max_dT.has_value(); });
        if (!measured) continue;
        if (results.preset() != "paper-tables") figures.push_back(error_figure(rows));
        Figure speed = speed_figure(rows);
        if (!speed.curves.empty()) figures.push_back(std::move(speed));
    }
    return figures;
}

}  // namespace wavefog::cli
