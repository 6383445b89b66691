#include "bench/models.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/table_text.h"

namespace wavefog::cli {
namespace {

/// Formulas look the same by every method; "formulas" in place of its name.
std::string method_of(const Row& row) {
    return row.map.empty() ? "formulas" : row.method;
}

bool is_baseline(const Row& row) {
    return row.method == homogeneous_method().name();
}

}  // namespace

Result<std::vector<Group>> plan_models(const std::vector<BenchScene>& scenes, const Size& size) {
    std::vector<Group> groups;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        auto variant = make_variant(scenes[i], {});
        if (!variant) return tl::unexpected(variant.error());
        Group group{scenes[i].name, i, size, {*std::move(variant)}, {}};
        group.cases.push_back({0, {.kind = MethodKind::exact}});
        if (!scenes[i].scene.fogs.empty()) group.cases.push_back({0, {.kind = MethodKind::radial}});
        groups.push_back(std::move(group));
    }
    return groups;
}

std::string models_text(const std::vector<Row>& rows, bool markdown) {
    Table table({"scene", "", "ms", "× homogeneous", "max |ΔT|", "99 % |ΔT|"});
    for (const Row& row : rows)
        if (!is_baseline(row))
            table.add({row.scene, method_of(row), short_number(row.ms_median),
                       short_number(row.ratio_homogeneous), error_number(row.max_dT),
                       error_number(row.p99_dT)});
    return table.text(markdown);
}

Figure models_figure(const std::vector<Row>& rows) {
    Figure figure;
    figure.id = "models";
    figure.title = "Every model of fog: cost against error";
    figure.subtitle = rows.empty() ? std::string()
                                   : fmt::format("each in its scene, {}×{} pixels",
                                                 rows.front().width, rows.front().height);
    figure.x.label = "cost of the fog pass, × homogeneous fog";
    figure.y.label = "largest error of transmittance, max |ΔT|";
    figure.levels.push_back({kVisibleError, "least visible\nerror, 1/510"});
    for (const auto& [name, key] :
         {std::pair{"formulas", "formulas"}, {"exact", "exact"}, {"radial", "radial"}}) {
        Curve curve{key == std::string("formulas") ? "formulas" : fmt::format("maps, {}", name),
                    key,
                    Curve::Style::points,
                    {}};
        for (const Row& row : rows) {
            if (is_baseline(row) || method_of(row) != name || !row.ratio_homogeneous || !row.max_dT)
                continue;
            curve.points.emplace_back(*row.ratio_homogeneous, *row.max_dT);
            figure.notes.push_back({*row.ratio_homogeneous, *row.max_dT, row.scene, key});
        }
        if (!curve.points.empty()) figure.curves.push_back(std::move(curve));
    }
    // The names of the lowest points stand below them.
    for (const Note& note : figure.notes) {
        figure.y.low = figure.y.low > 0 ? std::min(figure.y.low, note.y / 6) : note.y / 6;
        figure.y.high = std::max({figure.y.high, 2 * note.y, 2 * kVisibleError});
    }
    // From the top down; points that touch share a text, which names them in that order.
    std::stable_sort(figure.notes.begin(), figure.notes.end(),
                     [](const Note& a, const Note& b) { return a.y > b.y; });
    std::vector<Note> apart;
    for (const Note& note : figure.notes) {
        const auto touched = std::find_if(apart.begin(), apart.end(), [&](const Note& other) {
            return other.key == note.key && std::abs(std::log(other.x / note.x)) < 0.1 &&
                   other.y < 2 * note.y;
        });
        if (touched == apart.end()) {
            apart.push_back(note);
            continue;
        }
        touched->text += ", " + note.text;
        touched->y = note.y;
    }
    figure.notes = std::move(apart);
    return figure;
}

}  // namespace wavefog::cli
