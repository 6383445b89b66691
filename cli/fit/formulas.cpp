#include "fit/formulas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "wavefog/fogmap/coarsen.h"
#include "wavefog/gpu/pixel_rays.h"

namespace wavefog::cli {
namespace {

constexpr std::size_t kSamples = 12000;
constexpr int kHeights = 17;  // planes tried before the search narrows
// Where an exponential profile has fallen to e^-4 no plane does better.
constexpr double kScales = 4;

/// Where f, which falls and then rises, is least.
double golden_section(double low, double high, int steps, const std::function<double(double)>& f) {
    constexpr double kRatio = 0.6180339887498949;
    double a = high - kRatio * (high - low), b = low + kRatio * (high - low);
    double at_a = f(a), at_b = f(b);
    for (int i = 0; i < steps; ++i) {
        if (at_a <= at_b) {
            high = b;
            b = a;
            at_b = at_a;
            a = high - kRatio * (high - low);
            at_a = f(a);
        } else {
            low = a;
            a = b;
            at_a = at_b;
            b = low + kRatio * (high - low);
            at_b = f(b);
        }
    }
    return at_a <= at_b ? a : b;
}

/// Scene files are read by people: no more digits than a fit can know.
double rounded(double value) {
    return std::stod(fmt::format("{:.9g}", value));
}

FogModel below(double y, double extinction) {
    return Halfspace{{0, 1, 0}, {0, y, 0}, extinction, 0};
}

FogModel everywhere(double extinction) {
    return Ramp{{{0, extinction}, {1, extinction}}};
}

/// Layers of the map's own height profile.
FogModel layers(const Profile& profile, double extinction) {
    switch (profile.kind) {
        case Profile::Kind::exponential:
            return ExponentialLayer{extinction, profile.base, profile.scale};
        case Profile::Kind::linear:
            return Ramp{{{profile.base, extinction}, {profile.top, 0}}};
        case Profile::Kind::slab: {
            // A ramp has no steps: its sides lean over a two-thousandth of its height.
            const double lean = (profile.top - profile.bottom) / 4000;
            return Ramp{{{profile.bottom - lean, 0},
                         {profile.bottom + lean, extinction},
                         {profile.top - lean, extinction},
                         {profile.top + lean, 0}}};
        }
        case Profile::Kind::uniform:
            break;
    }
    return everywhere(extinction);
}

std::string layers_words(const Profile& profile, double extinction) {
    switch (profile.kind) {
        case Profile::Kind::exponential:
            return fmt::format(
                "a layer of fog with extinction {:.4g}/m below y = {:.4g} m, a factor e less every "
                "{:.4g} m above",
                extinction, profile.base, profile.scale);
        case Profile::Kind::linear:
            return fmt::format(
                "a layer of fog with extinction {:.4g}/m below y = {:.4g} m, falling to 0 at "
                "{:.4g} m",
                extinction, profile.base, profile.top);
        case Profile::Kind::slab:
        case Profile::Kind::uniform:
            break;
    }
    return fmt::format("a layer of fog with extinction {:.4g}/m from y = {:.4g} m to {:.4g} m",
                       extinction, profile.bottom, profile.top);
}

}  // namespace

FormulaFit::FormulaFit(const Scene& scene, const std::vector<View>& views) : scene_(scene) {
    std::size_t pixels = 0;
    for (const View& view : views) pixels += view.truth.tau.size();
    const std::size_t stride = std::max<std::size_t>(1, pixels / kSamples);
    std::vector<double> total;
    std::vector<std::vector<double>> parts(scene.fogs.size());
    for (const View& view : views) {
        const PixelRays rays(view.camera, view.depth.width, view.depth.height);
        for (std::size_t i = 0; i < view.truth.tau.size(); i += stride) {
            const int x = int(i) % view.depth.width, y = int(i) / view.depth.width;
            const PixelRay ray = rays.at(x, y, double(view.depth.at(x, y, 0)));
            const Eigen::Vector3d path =
                (ray.end - ray.origin) * (ray.sky ? sky_limit(view.camera) : 1);
            samples_.push_back({ray.origin, ray.origin + path});
            total.push_back(view.truth.tau[i]);
            for (std::size_t f = 0; f < parts.size(); ++f) parts[f].push_back(view.parts[f].tau[i]);
        }
    }
    const auto array = [](const std::vector<double>& values) -> Eigen::ArrayXd {
        return Eigen::Map<const Eigen::ArrayXd>(values.data(), Eigen::Index(values.size()));
    };
    total_ = array(total);
    for (const auto& part : parts) parts_.push_back(array(part));
}

Eigen::ArrayXd FormulaFit::depths(const FogModel& model) const {
    Eigen::ArrayXd sum(Eigen::Index(samples_.size()));
    for (std::size_t i = 0; i < samples_.size(); ++i)
        sum[Eigen::Index(i)] = optical_depth(model, samples_[i].begin, samples_[i].end);
    return sum;
}

std::pair<double, double> FormulaFit::best_extinction(const Eigen::ArrayXd& unit,
                                                      const Eigen::ArrayXd& others,
                                                      double highest) const {
    const Eigen::ArrayXd rest = (-others).exp(), truth = (-total_).exp();
    // Of each pixel |T - T_true| falls and then rises with the extinction; so does their maximum.
    const auto error = [&](double k) {
        return (rest * (-k * unit).exp() - truth).abs().maxCoeff();
    };
    const double k = rounded(golden_section(0, highest, 50, error));
    return {k, error(k)};
}

std::vector<Formula> FormulaFit::fit(std::size_t fog, const std::vector<Formula>& replaced) const {
    const Fog& map = scene_.fogs[fog];
    const double highest = map.extinction * double(map_of(map).maxCoeff());
    Eigen::ArrayXd others = total_ - parts_[fog];
    for (const Formula& other : replaced) others += depths(other.model) - parts_[other.fog];

    std::vector<Formula> formulas = {{fog, kNoFog, "no fog", everywhere(0),
                                      ((-others).exp() - (-total_).exp()).abs().maxCoeff()}};
    const auto [constant, constant_error] = best_extinction(depths(everywhere(1)), others, highest);
    formulas.push_back({fog, "homogeneous",
                        fmt::format("homogeneous fog with extinction {:.4g}/m", constant),
                        everywhere(constant), constant_error});
    const Profile& profile = map.profile;
    if (profile.kind == Profile::Kind::uniform) return formulas;

    double low = profile.top, high = profile.top;  // of a slab
    if (profile.kind != Profile::Kind::slab) low = profile.base;
    if (profile.kind == Profile::Kind::exponential) high = profile.base + kScales * profile.scale;
    const auto error_below = [&](double y) {
        return best_extinction(depths(below(y, 1)), others, highest).second;
    };
    double plane = low;
    if (low < high) {
        const double step = (high - low) / (kHeights - 1);
        double least = error_below(plane);
        for (int i = 1; i < kHeights; ++i)
            if (const double made = error_below(low + i * step); made < least) {
                least = made;
                plane = low + i * step;
            }
        plane = rounded(golden_section(std::max(low, plane - step), std::min(high, plane + step),
                                       12, error_below));
    }
    const auto [halved, halved_error] = best_extinction(depths(below(plane, 1)), others, highest);
    formulas.push_back(
        {fog, "halfspace",
         fmt::format("halfspace fog below y = {:.4g} m with extinction {:.4g}/m", plane, halved),
         below(plane, halved), halved_error});
    const auto [layered, layered_error] =
        best_extinction(depths(layers(profile, 1)), others, highest);
    formulas.push_back(
        {fog, "layers", layers_words(profile, layered), layers(profile, layered), layered_error});
    return formulas;
}

Facts formula_json(const FogModel& model) {
    if (const auto* plane = std::get_if<Halfspace>(&model))
        return {{"model", "halfspace"},
                {"normal", {0, 1, 0}},
                {"point", {0, plane->point.y(), 0}},
                {"extinction", plane->extinction}};
    if (const auto* layer = std::get_if<ExponentialLayer>(&model))
        return {{"model", "layers"},
                {"profile", "exponential"},
                {"extinction", layer->extinction},
                {"base", layer->base},
                {"scale", layer->scale}};
    Facts points = Facts::array();
    for (const Ramp::Point& point : std::get<Ramp>(model).points)
        points.push_back({point.y, point.extinction});
    return {{"model", "layers"}, {"profile", "ramp"}, {"points", points}};
}

}  // namespace wavefog::cli
