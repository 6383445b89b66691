// Fewer coefficients, or none: levels left out, simpler bases, formulas in place of maps.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "fit/search.h"
#include "wavefog/fogmap/coarsen.h"

namespace wavefog::cli {
namespace {

// Levels to choose from: 1024 fine cells become one.
constexpr int kLevels = 10;

std::string error_words(const Worst& worst) {
    return fmt::format("|dT| {:.1e} ({})", worst.error, worst.view);
}

/// The maps decomposed anew, a degree at most; `family` "": the degree's own.
Result<std::vector<Fog>> decomposed(const FitMaps& base, int degree, const std::string& family) {
    std::vector<Fog> whole;
    for (const Fog& fog : base.fogs) {
        FogOptions options;
        options.degree = std::min(degree, fog.degree());
        options.levels = kLevels;
        options.boundary = fog.decomposition.boundary;
        if (options.degree == degree) options.family = family;
        if (options.family == "positive") options.form = Form::scaling;
        Result<Fog> made = fog_like(fog, map_of(fog), options);
        if (!made) return tl::unexpected(made.error());
        whole.push_back(*std::move(made));
    }
    return whole;
}

/// "fog 1" where there are several.
std::string name_of(const Scene& scene, std::size_t fog) {
    return scene.fogs.size() == 1 ? "the map" : fmt::format("fog {}", fog);
}

}  // namespace

std::size_t FitMaps::coefficients() const {
    std::size_t sum = 0;
    for (const Fog& fog : fogs)
        sum += std::size_t(fog.decomposition.width) * std::size_t(fog.decomposition.height);
    return sum;
}

Result<Worst> FitSearch::error_of(const FitMaps& maps, double limit) const {
    return largest_error(gl_, scene_, maps.fogs, maps.models, Method{}, tuning_, limit);
}

/// Leaves out finest levels of `whole` one by one, from those that `start` leaves out on.
Result<FitMaps> FitSearch::drop_levels(const std::vector<Fog>& whole, const FitMaps& start,
                                       double error) const {
    FitMaps maps = start;
    std::vector<std::string> stopped(whole.size());
    for (;;) {
        // Of the fogs that can lose a level more, the one that shows it least.
        std::optional<FitMaps> best;
        for (std::size_t i = 0; i < whole.size(); ++i) {
            // Another family may have left out more levels than this one has.
            if (maps.dropped[i] >= whole[i].decomposition.levels()) continue;
            FitMaps next = maps;
            Result<Fog> coarser = without_finest(whole[i], ++next.dropped[i]);
            if (!coarser) return tl::unexpected(coarser.error());
            next.fogs[i] = *std::move(coarser);
            const Result<Worst> worst = error_of(next, error);
            if (!worst) return tl::unexpected(worst.error());
            next.error = worst->error;
            stopped[i] =
                fmt::format("; without {} {}, too much", next.dropped[i], error_words(*worst));
            if (next.error <= error && (!best || next.error < best->error)) best = std::move(next);
        }
        if (!best) break;
        maps = *std::move(best);
    }
    maps.why = start.why;
    for (std::size_t i = 0; i < whole.size(); ++i) {
        const Decomposition<float>& d = whole[i].decomposition;
        const std::string what =
            maps.dropped[i] == 0
                ? std::string("no level of detail left out")
                : fmt::format("without the finest {} of {} levels ({}x{} left)", maps.dropped[i],
                              d.levels(), maps.fogs[i].decomposition.width,
                              maps.fogs[i].decomposition.height);
        maps.why.push_back(fmt::format("{}, {}, family {}: {}, |dT| {:.1e}{}",
                                       name_of(scene_, maps.which[i]), basis_name(d.degree()),
                                       d.family.name(), what, maps.error, stopped[i]));
    }
    return maps;
}

/// The family of a degree that keeps the fewest coefficients.
Result<FitMaps> FitSearch::best_family(const FitMaps& base, int degree, double error) const {
    const Result<std::vector<Fog>> whole = decomposed(base, degree, "");
    if (!whole) return tl::unexpected(whole.error());
    FitMaps start = base;
    start.fogs = *whole;
    const Result<Worst> worst = error_of(start, error);
    if (!worst) return tl::unexpected(worst.error());
    start.error = worst->error;
    start.why.push_back(error_words(*worst));
    if (start.error > error) return start;
    start.why = base.why;
    Result<FitMaps> best = drop_levels(*whole, start, error);
    if (!best) return best;
    for (const Family& family : families(degree)) {
        if (!family.stable() || family == default_family(degree, Form::wavelet)) continue;
        const Result<std::vector<Fog>> other = decomposed(base, degree, family.name());
        if (!other) continue;  // this family does not know the map's border or size
        // From where the best has stopped: only one that leaves out more is of use.
        Result<FitMaps> made = drop_levels(*other, *best, error);
        if (!made) return made;
        if (made->coefficients() >= best->coefficients()) continue;
        made->why.erase(made->why.begin() + std::ptrdiff_t(base.why.size()),
                        made->why.begin() + std::ptrdiff_t(best->why.size()));
        best = std::move(made);
    }
    return best;
}

Result<void> FitSearch::add_simpler(const FitMaps& base, double error) {
    int highest = 0;
    for (const Fog& fog : base.fogs) highest = std::max(highest, fog.degree());
    for (int degree = highest; degree >= 0; --degree) {
        Result<FitMaps> maps = best_family(base, degree, error);
        if (!maps) return tl::unexpected(maps.error());
        if (maps->error > error) {
            why_.push_back(
                fmt::format("basis {}: {}, too much", basis_name(degree), maps->why.back()));
            continue;
        }
        const bool simpler =
            degree < highest ||
            std::any_of(maps->dropped.begin(), maps->dropped.end(), [](int n) { return n > 0; });
        if (simpler)
            maps_.push_back(*std::move(maps));
        else if (base.formulas.empty())
            maps_.front().why = maps->why;
    }
    return {};
}

/// Formulas in place of as many maps as they can stand for: once the simplest, once the most exact.
Result<void> FitSearch::add_formulas(double error) {
    const FormulaFit fit(scene_, tuning_);
    std::vector<std::string> said;
    for (const bool simplest : {true, false}) {
        FitMaps maps = maps_.front();
        for (std::size_t left = scene_.fogs.size(); left > 0; --left) {
            std::optional<Formula> best;
            for (const std::size_t fog : maps.which) {
                std::optional<Formula> own;
                for (Formula& formula : fit.fit(fog, maps.formulas)) {
                    if (simplest && maps.formulas.empty())
                        why_.push_back(fmt::format("{}: {} in its place: |dT| {:.1e}{}",
                                                   name_of(scene_, fog), formula.words,
                                                   formula.error,
                                                   formula.error > error ? ", too much" : ""));
                    if (formula.error > error) continue;
                    if (!own || (!simplest && formula.error < own->error)) own = formula;
                }
                if (own && (!best || own->error < best->error)) best = std::move(own);
            }
            if (!best) break;
            const auto place = std::find(maps.which.begin(), maps.which.end(), best->fog);
            maps.fogs.erase(maps.fogs.begin() + (place - maps.which.begin()));
            maps.which.erase(place);
            maps.dropped.pop_back();
            maps.models.push_back(best->model);
            maps.formulas.push_back(*std::move(best));
        }
        if (maps.formulas.empty()) return {};
        std::string words;
        for (const Formula& formula : maps.formulas) words += formula.words + '\n';
        if (!said.empty() && said.front() == words) return {};
        said.push_back(words);
        maps_.push_back(std::move(maps));
    }
    return {};
}

Result<void> FitSearch::simplify(double error) {
    FitMaps whole;
    whole.fogs = scene_.fogs;
    for (std::size_t i = 0; i < scene_.fogs.size(); ++i) whole.which.push_back(i);
    whole.dropped.assign(scene_.fogs.size(), 0);
    whole.models = scene_.models;
    maps_ = {std::move(whole)};
    why_.clear();
    if (auto ok = add_formulas(error); !ok) return ok;
    const std::size_t bases = maps_.size();
    for (std::size_t i = 0; i < bases; ++i) {
        const FitMaps base = maps_[i];
        if (base.fogs.empty()) continue;
        if (auto ok = add_simpler(base, error); !ok) return ok;
    }
    return {};
}

}  // namespace wavefog::cli
