#include "fit/choose.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "bench/variant.h"

namespace wavefog::cli {
namespace {

// Pixels of a camera's view and of all cameras' main views: the truth takes microseconds a pixel.
constexpr double kViewPixels = 30000, kAllPixels = 60000;
// Dropped details may use this share of the error, the method the rest.
constexpr double kMapShare = 0.7;
// If unseen pixels err more than allowed, the search's limit falls by as much and a margin, within
// these, so often.
constexpr double kMargin = 0.95, kTighten = 0.6;
constexpr int kTries = 4;
// Times this close are noise: the least memory decides.
constexpr double kClose = 1.25;

Size view_size(const Size& size, std::size_t cameras) {
    const double pixels = std::min(kViewPixels, kAllPixels / double(cameras));
    const double scale =
        std::min(1.0, std::sqrt(pixels / (double(size.width) * double(size.height))));
    return {std::max(int(size.width * scale), 1), std::max(int(size.height * scale), 1)};
}

std::string maps_text(const FitMaps& maps) {
    std::string text;
    for (const Fog& fog : maps.fogs)
        text += fmt::format("{}{}x{} {}", text.empty() ? "" : " + ", fog.decomposition.width,
                            fog.decomposition.height, basis_name(fog.degree()));
    for (const Formula& formula : maps.formulas)
        text += fmt::format("{}{}", text.empty() ? "" : " + ", formula.name);
    return text;
}

Facts row_of(const FitMaps& maps, const Method& method, const Worst& worst) {
    return {{"method", method.name()},
            {"mu", method.mu},
            {"fog", maps_text(maps)},
            {"max_dT", worst.error},
            {"worst_view", worst.view}};
}

Facts kept_row(const FitSearch& search, const FitSetting& setting) {
    Facts row = row_of(search.maps()[setting.maps], setting.method, setting.worst);
    row["ms"] = setting.ms;
    row["gpu_bytes"] = setting.pass.bytes();
    return row;
}

/// The settings in the order in which they are to be chosen.
std::vector<FitSetting*> by_preference(FitSearch& search, const std::optional<double>& target_ms) {
    std::vector<FitSetting*> order;
    for (FitSetting& setting : search.settings()) order.push_back(&setting);
    const double least = order.empty() ? 0 : order.front()->ms;
    // A scene that needs no map shall have none, whatever a map of one pixel takes.
    const auto close = std::stable_partition(order.begin(), order.end(), [&](const auto* s) {
        return s->ms <= kClose * least || search.maps()[s->maps].fogs.empty();
    });
    // The simplest formula comes first. Of one memory and map, what errs more does less work; noise
    // shall not decide.
    const auto less = [](const auto* a, const auto* b) {
        return std::tuple(a->pass.bytes(), a->maps, -a->worst.error, a->method.mu) <
               std::tuple(b->pass.bytes(), b->maps, -b->worst.error, b->method.mu);
    };
    std::stable_sort(order.begin(), close, less);
    if (target_ms)
        std::stable_sort(order.begin(), order.end(), [&](const auto* a, const auto* b) {
            const bool a_fits = a->ms <= *target_ms, b_fits = b->ms <= *target_ms;
            if (a_fits != b_fits) return a_fits;
            if (!a_fits) return a->ms < b->ms;
            if (a->worst.error != b->worst.error) return a->worst.error < b->worst.error;
            return less(a, b);
        });
    return order;
}

/// Why the chosen maps and method, and not less: one sentence each.
std::vector<std::string> reasons(const FitSearch& search, const FitSetting& chosen) {
    std::vector<std::string> why = {fmt::format(
        "dropped details may take {:.0f} % of the error, the method the rest", 100 * kMapShare)};
    why.insert(why.end(), search.why().begin(), search.why().end());
    const FitMaps& maps = search.maps()[chosen.maps];
    why.insert(why.end(), maps.why.begin(), maps.why.end());
    for (const FitMiss& miss : search.misses()) {
        if (miss.maps != chosen.maps) continue;
        const std::string mu =
            miss.method.kind == MethodKind::exact ? fmt::format(", mu {}", miss.method.mu) : "";
        why.push_back(fmt::format("{}{}: |dT| {:.1e} ({}), too much", miss.method.name(), mu,
                                  miss.worst.error, miss.worst.view));
    }
    return why;
}

FitChoice choice_of(const FitSearch& search, const FitSetting& setting) {
    FitChoice choice;
    choice.maps = search.maps()[setting.maps];
    choice.method = setting.method;
    choice.ms = setting.ms;
    choice.before_ms = search.before().ms;
    choice.gpu_bytes = setting.pass.bytes();
    choice.before_gpu_bytes = search.before().pass.bytes();
    choice.why = reasons(search, setting);
    choice.formulas = choice.maps.formulas;
    for (const FitSetting& kept : search.settings())
        if (choice.formulas.empty() && search.maps()[kept.maps].fogs.empty())
            choice.formulas = search.maps()[kept.maps].formulas;
    for (const FitSetting& kept : search.settings()) choice.kept.push_back(kept_row(search, kept));
    for (const FitMiss& miss : search.misses())
        choice.missed.push_back(row_of(search.maps()[miss.maps], miss.method, miss.worst));
    return choice;
}

/// Over the views that are not tuned on, up to the first that errs more than `limit`.
Result<Worst> unseen_error(const Gl& gl, FogPass& pass, const FitViews& views, double limit) {
    const Result<Worst> held_out = largest_error(gl, pass, views.held_out, limit);
    if (!held_out || held_out->error > limit) return held_out;
    const Result<Worst> whole = largest_error(gl, pass, views.whole, limit);
    if (!whole || whole->error > held_out->error) return whole;
    return held_out;
}

}  // namespace

Result<FitViews> fit_views(const Gl& gl, const Scene& scene, const Size& size) {
    const Result<std::vector<Fog>> truth = undecomposed(scene.fogs);
    if (!truth) return tl::unexpected(truth.error());
    const Size small = view_size(size, cameras_of(scene).size());
    auto tuning = make_views(gl, scene, *truth, tuning_cameras(scene), small);
    if (!tuning) return tl::unexpected(tuning.error());
    auto held_out = make_views(gl, scene, *truth, held_out_cameras(scene), small);
    if (!held_out) return tl::unexpected(held_out.error());
    auto whole = make_whole_views(gl, scene, *truth, size);
    if (!whole) return tl::unexpected(whole.error());
    return FitViews{*std::move(tuning), *std::move(held_out), *std::move(whole)};
}

Result<FitChoice> choose(const Gl& gl, const Scene& scene, const FitViews& views,
                         const FitGoal& goal) {
    double allowed = goal.max_error;
    std::optional<FitChoice> best;
    std::vector<std::string> refused;
    for (int attempt = 0; attempt < kTries; ++attempt) {
        FitSearch search(gl, scene, views.tuning);
        if (auto ok = search.simplify(allowed * kMapShare); !ok) return tl::unexpected(ok.error());
        if (auto ok = search.try_methods(allowed); !ok) return tl::unexpected(ok.error());
        if (auto ok = search.time(goal.size, goal.target_ms.value_or(0)); !ok)
            return tl::unexpected(ok.error());
        // Of the first map that was refused: less detail dropped might keep the error in its time.
        double missed_ms = 0, missed_error = 0, missed_tuning = 0;
        for (FitSetting* setting : by_preference(search, goal.target_ms)) {
            const FitMaps& maps = search.maps()[setting->maps];
            const Result<Worst> unseen = unseen_error(gl, setting->pass, views, goal.max_error);
            if (!unseen) return tl::unexpected(unseen.error());
            if (unseen->error > goal.max_error) {
                refused.push_back(
                    fmt::format("{}, mu {}, {}: |dT| {:.1e} where not tuned ({}), "
                                "too much",
                                setting->method.name(), setting->method.mu, maps_text(maps),
                                unseen->error, unseen->view));
                if (missed_error == 0 && !maps.fogs.empty()) {
                    missed_ms = setting->ms;
                    missed_error = unseen->error;
                    missed_tuning = setting->worst.error;
                }
                continue;
            }
            if (!best || setting->ms < best->ms) best = choice_of(search, *setting);
            if (missed_error > 0 && !goal.target_ms && setting->ms > kClose * missed_ms) break;
            best->why.insert(best->why.end(), refused.begin(), refused.end());
            return *std::move(best);
        }
        // As much below as it was above, and below what it errs itself so that it is not found
        // again.
        if (missed_error > 0)
            allowed = std::clamp(
                kMargin * std::min(allowed * goal.max_error / missed_error, missed_tuning),
                kTighten * allowed, kMargin * allowed);
        else
            allowed *= kTighten;
        refused.push_back(fmt::format("so searched for |dT| {:.2e} next", allowed));
    }
    if (best) {
        refused.pop_back();
        best->why.insert(best->why.end(), refused.begin(), refused.end());
        return *std::move(best);
    }
    return data_error(fmt::format(
        "no setting keeps |dT| below {}: float32 itself errs up to 2e-6; allow a larger "
        "--max-error",
        goal.max_error));
}

}  // namespace wavefog::cli
