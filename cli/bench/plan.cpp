#include "bench/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "bench/models.h"
#include "bench/paper_tables.h"
#include "bench/resolution.h"
#include "bench/scale.h"

namespace wavefog::cli {
namespace {

// The chart's picture: froxels cost the same at any size, so a small one would wrong them.
constexpr Size chart_size = {800, 600};

const std::vector<double> chart_mus = {1, 0.95, 0.9, 0.8, 0.6, 0.4, 0.2, 0};

/// What does not depend on mu is measured once.
bool uses_mu(MethodKind kind) {
    return kind == MethodKind::exact || kind == MethodKind::radial || kind == MethodKind::paper ||
           kind == MethodKind::paper_scaling;
}

std::vector<Method> methods_named(std::initializer_list<const char*> names) {
    std::vector<Method> methods;
    for (const char* name : names) methods.push_back(*parse_method(name));
    return methods;
}

void add_cases(Group& group, std::size_t variant, const std::vector<Method>& methods,
               const std::vector<double>& mus) {
    for (Method method : methods)
        for (std::size_t i = 0; i < (uses_mu(method.kind) ? mus.size() : 1); ++i) {
            method.mu = uses_mu(method.kind) ? mus[i] : 1;
            group.cases.push_back({variant, method});
        }
}

Group start_group(const std::vector<BenchScene>& scenes, std::size_t scene, const Size& size) {
    return {scenes[scene].name, scene, size, {}, {}};
}

/// One variant a level count (the scene's own without --levels), all methods and mus on each.
Result<std::vector<Group>> plan_list(const std::vector<BenchScene>& scenes,
                                     const PlanOptions& options, const std::vector<Method>& methods,
                                     const std::vector<double>& mus) {
    std::vector<Group> groups;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        const Scene& scene = scenes[i].scene;
        Group group =
            start_group(scenes, i, options.size.value_or(Size{scene.width, scene.height}));
        std::vector<VariantOptions> variants(std::max<std::size_t>(options.levels.size(), 1));
        for (std::size_t k = 0; k < options.levels.size(); ++k)
            variants[k].levels = options.levels[k];
        for (const VariantOptions& wanted : variants) {
            auto variant = make_variant(scenes[i], wanted);
            if (!variant) return tl::unexpected(variant.error());
            group.variants.push_back(*std::move(variant));
            add_cases(group, group.variants.size() - 1, methods, mus);
        }
        groups.push_back(std::move(group));
    }
    return groups;
}

/// Every method swept over its knob: N, table sizes, the grid of froxels, mu, and the number of
/// levels at mu 0.
Result<std::vector<Group>> plan_chart(const std::vector<BenchScene>& scenes,
                                      const PlanOptions& options) {
    const auto wavelet_methods = options.methods.empty()
                                     ? methods_named({"exact", "paper", "paper-scaling"})
                                     : options.methods;
    const auto baselines = options.methods.empty() ? methods_named({"radial:128x32",
                                                                    "radial:256x64",
                                                                    "radial:512x128",
                                                                    "radial:1024x256",
                                                                    "radial:2048x512",
                                                                    "radial:512x64:step",
                                                                    "radial:1024x128:step",
                                                                    "radial:2048x256:step",
                                                                    "radial:4096x256:step",
                                                                    "march:4",
                                                                    "march:8",
                                                                    "march:16",
                                                                    "march:32",
                                                                    "march:64",
                                                                    "march:128",
                                                                    "march:256",
                                                                    "march:512",
                                                                    "froxel:80x45x32",
                                                                    "froxel:160x90x64",
                                                                    "froxel:240x135x64",
                                                                    "froxel:320x180x128"})
                                                   : std::vector<Method>{};
    const auto mus = options.mus.empty() ? chart_mus : options.mus;
    const auto levels = options.levels.empty() ? std::vector<int>{3, 1, 2, 4, 5} : options.levels;
    std::vector<Group> groups;
    for (std::size_t i = 0; i < scenes.size(); ++i) {
        Group group = start_group(scenes, i, options.size.value_or(chart_size));
        for (std::size_t k = 0; k < levels.size(); ++k) {
            VariantOptions wanted;
            wanted.levels = levels[k];
            auto variant = make_variant(scenes[i], wanted);
            if (!variant) return tl::unexpected(variant.error());
            group.variants.push_back(*std::move(variant));
            // The whole sweep over mu at the first level count, the ends of it at the others.
            add_cases(group, k, wavelet_methods, k == 0 ? mus : std::vector<double>{0.6, 0});
            if (k == 0) add_cases(group, 0, baselines, {1});
        }
        groups.push_back(std::move(group));
    }
    return groups;
}

template <class T, class Parse>
Result<std::vector<T>> parse_list(const std::string& text, Parse parse) {
    std::vector<T> values;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, ',');) {
        Result<T> value = parse(part);
        if (!value) return tl::unexpected(value.error());
        values.push_back(*std::move(value));
    }
    if (values.empty()) return usage_error("an empty list; write values with commas between them");
    return values;
}

}  // namespace

Result<std::vector<Group>> plan(const std::vector<BenchScene>& scenes, const PlanOptions& options,
                                std::vector<std::string>& cut) {
    const auto methods =
        options.methods.empty()
            ? methods_named({"radial", "radial:step", "exact", "march:32", "march:256"})
            : options.methods;
    switch (options.preset) {
        case Preset::chart:
            return plan_chart(scenes, options);
        case Preset::paper_tables:
            for (std::size_t i = 1; i < scenes.size(); ++i)
                cut.push_back(
                    fmt::format("{}: paper-tables measures one scene, the first", scenes[i].name));
            return plan_paper_tables(scenes.front(), options.size.value_or(Size{800, 600}));
        case Preset::scale:
            return plan_scale(scenes, options.size.value_or(Size{800, 600}),
                              options.methods.empty()
                                  ? methods_named({"radial", "radial:step", "exact", "march:32"})
                                  : options.methods,
                              options.mus.empty() ? std::vector<double>{1, 0.95} : options.mus);
        case Preset::resolution:
            return plan_resolution(
                scenes, options.size.value_or(Size{800, 600}),
                options.methods.empty() ? methods_named({"exact"}) : options.methods);
        case Preset::models:
            return plan_models(scenes, options.size.value_or(Size{800, 600}));
        default:
            return plan_list(scenes, options, methods,
                             options.mus.empty() ? std::vector<double>{1} : options.mus);
    }
}

double preset_seconds(Preset preset) {
    switch (preset) {
        case Preset::chart:
        case Preset::paper_tables:
        case Preset::scale:
            return 780;  // with loading and drawing below a quarter of an hour
        default:
            return 0;
    }
}

Result<std::vector<Method>> parse_methods(const std::string& text) {
    return parse_list<Method>(text, [](const std::string& part) -> Result<Method> {
        Result<Method> method = parse_method(part);
        if (method && method->kind == MethodKind::reference)
            return usage_error("reference is what the others are measured against; leave it out");
        return method;
    });
}

Result<std::vector<double>> parse_mus(const std::string& text) {
    return parse_list<double>(text,
                              [](const std::string& part) { return parse_number_in(part, 0, 1); });
}

Result<std::vector<int>> parse_level_list(const std::string& text) {
    return parse_list<int>(text,
                           [](const std::string& part) { return parse_integer_in(part, 0, 30); });
}

}  // namespace wavefog::cli
