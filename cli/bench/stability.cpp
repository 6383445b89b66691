#include "bench/stability.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "bench/progress.h"

namespace wavefog::cli {

Grid<float> hard_edged_map(int size) {
    Random random(11);
    Grid<float> map = Grid<float>::Zero(size, size);
    for (int disc = 0; disc < 14; ++disc) {
        const double x = random.uniform(0, size), z = random.uniform(0, size);
        const double radius = random.uniform(0.04, 0.14) * size;
        for (int j = 0; j < size; ++j)
            for (int i = 0; i < size; ++i)
                if (std::hypot(i - x, j - z) < radius) map(j, i) = 1;
    }
    return map;
}

Result<Fog> study_fog(const Grid<float>& map, const FogOptions& options, double metres,
                      double extinction) {
    Result<Fog> fog = make_fog(map, options);
    if (!fog) return fog;
    fog->rect = {-metres / 2, -metres / 2, metres / 2, metres / 2};
    fog->extinction = extinction;
    return fog;
}

std::vector<Segment> random_segments(int count, double metres, unsigned seed) {
    Random random(seed);
    std::vector<Segment> segments;
    const double half = metres / 2;
    for (int i = 0; i < count; ++i) {
        Segment s{{random.uniform(-half, half), random.uniform(1, 3), random.uniform(-half, half)},
                  {random.uniform(-half, half), random.uniform(1, 3), random.uniform(-half, half)}};
        if (i < count / 4) s.p.z() = s.o.z() + 1e-3 * s.p.z();
        segments.push_back(s);
    }
    return segments;
}

Result<void> study_stability(Context& context, Results& results) {
    using Figures = Result<std::vector<Figure>>;
    const auto one = [](Result<Figure> figure) -> Figures {
        return std::move(figure).map([](Figure f) { return std::vector<Figure>{std::move(f)}; });
    };
    const std::pair<const char*, std::function<Figures()>> studies[] = {
        {"condition of the transform", [] { return Figures(study_transforms()); }},
        {"dropped levels", study_dropped_levels},
        {"path-integral tables", [&] { return one(study_tables()); }},
        {"march", study_march},
        {"world offset", [&] { return one(study_world_offset()); }},
        {"thin bank", [&] { return one(study_thin_bank(context)); }},
        {"separable fog", [&] { return one(study_separable()); }}};
    const double count = double(std::size(studies));
    double done = 0;
    for (const auto& [name, study] : studies) {
        // No estimate: the studies differ too much.
        show_progress_line(done++ / count, 0, name);
        Figures figures = study();
        if (figures)
            std::move(figures->begin(), figures->end(), std::back_inserter(results.figures));
        else
            results.skipped.push_back(std::string(name) + ": " + figures.error().message);
    }
    clear_progress_line();
    return {};
}

}  // namespace wavefog::cli
