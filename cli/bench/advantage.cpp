#include "bench/advantage.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "bench/table_text.h"

namespace wavefog::cli {
namespace {

constexpr double kErrors[] = {1e-1, 1e-2, 1e-3, 1e-4, 1e-5};
constexpr double kTimes = 5;

bool takes_samples(const Row& row) {
    const std::string base = method_base(row.method);
    return base == "march" || base == "froxel";
}

/// The cheapest row that errs at most `error`, if there is one.
template <class Wanted>
const Row* cheapest(const std::vector<Row>& rows, double error, Wanted wanted) {
    const Row* best = nullptr;
    for (const Row& row : rows)
        if (wanted(row) && row.ratio_homogeneous && row.max_dT && *row.max_dT <= error &&
            (best == nullptr || *row.ratio_homogeneous < *best->ratio_homogeneous))
            best = &row;
    return best;
}

std::string name_of(const Row* row) {
    return row == nullptr ? "none" : setting_name(*row);
}

std::string cost_of(const Row* row) {
    return row == nullptr ? "-" : short_number(row->ratio_homogeneous);
}

}  // namespace

bool is_ours(const Row& row) {
    const std::string base = method_base(row.method);
    return base == "exact" || base == "radial";
}

std::string advantage_text(const std::vector<Row>& rows, bool markdown) {
    Table table({"scene, max |ΔT| at most", "ours", "× homogeneous", "march or froxel",
                 "× homogeneous", "times faster"});
    for (const std::vector<Row>& group : groups_of(rows)) {
        for (const double error : kErrors) {
            const Row* ours = cheapest(group, error, is_ours);
            const Row* theirs = cheapest(group, error, takes_samples);
            const bool both = ours != nullptr && theirs != nullptr;
            table.add(
                {fmt::format("{}, {:.0e}", group.front().scene, error), name_of(ours),
                 cost_of(ours), name_of(theirs), cost_of(theirs),
                 both ? short_number(*theirs->ratio_homogeneous / *ours->ratio_homogeneous) : "-"});
        }
    }
    return table.text(markdown);
}

Curve five_times_ours(const std::vector<Row>& group) {
    std::vector<Row> ours;
    std::copy_if(group.begin(), group.end(), std::back_inserter(ours), [](const Row& row) {
        return is_ours(row) && row.ratio_homogeneous && row.max_dT;
    });
    std::stable_sort(ours.begin(), ours.end(), [](const Row& a, const Row& b) {
        return *a.ratio_homogeneous < *b.ratio_homogeneous;
    });
    Curve curve{"5 × ours", "five times", Curve::Style::plain, {}};
    for (const Row& row : ours) {
        // A staircase: errors between two settings cost what the better one costs.
        if (!curve.points.empty() && *row.max_dT >= curve.points.back().second) continue;
        const double cost = kTimes * *row.ratio_homogeneous;
        if (!curve.points.empty()) curve.points.emplace_back(cost, curve.points.back().second);
        curve.points.emplace_back(cost, *row.max_dT);
    }
    return curve;
}

}  // namespace wavefog::cli
