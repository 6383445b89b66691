// Looks for the cheapest maps, formulas and method that keep a scene's error.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/formulas.h"
#include "fit/views.h"

namespace wavefog::cli {

/// A scene's fogs simplified in one way.
struct FitMaps {
    std::vector<Fog> fogs;           ///< the maps that are left
    std::vector<std::size_t> which;  ///< of the scene's, for each
    std::vector<int> dropped;        ///< finest levels left out, of each
    std::vector<Formula> formulas;   ///< in place of the other maps
    std::vector<FogModel> models;    ///< the scene's formulas and those
    double error = 0;                ///< with nothing else approximated, over the tuning views
    std::vector<std::string> why{};  ///< sentences: what each simplification costs

    std::size_t coefficients() const;
};

/// Maps and a method.
struct FitSetting {
    std::size_t maps = 0;  ///< index into FitSearch::maps()
    Method method;
    FogPass pass;
    Worst worst;    ///< over the tuning views
    double ms = 0;  ///< of the camera that takes longest, the least of its frames
};

/// A setting that errs too much.
struct FitMiss {
    std::size_t maps = 0;
    Method method;
    Worst worst;  ///< at least
};

/// Tries settings on the tuning views. All errors are measured against the reference.
class FitSearch {
  public:
    FitSearch(const Gl& gl, const Scene& scene, const std::vector<View>& tuning)
        : gl_(gl), scene_(scene), tuning_(tuning) {}

    /// The fogs as they are come first; then formulas in place of maps; then, for each degree up
    /// to the fogs' own, the fewest coefficients that err at most `error` by themselves.
    Result<void> simplify(double error);
    /// Every method at every mu on all maps; keeps what errs at most `error`.
    Result<void> try_methods(double error);
    /// Milliseconds of each kept setting at `size`, taking turns. What takes much longer than both
    /// the fastest and `target` is timed once.
    Result<void> time(const Size& size, double target);

    const std::vector<FitMaps>& maps() const { return maps_; }
    /// Fastest first once timed.
    std::vector<FitSetting>& settings() { return settings_; }
    const std::vector<FitSetting>& settings() const { return settings_; }
    const std::vector<FitMiss>& misses() const { return misses_; }
    /// The scene as it is written, once timed.
    const FitSetting& before() const { return *before_; }
    /// Sentences: which formulas and bases do not do.
    const std::vector<std::string>& why() const { return why_; }

  private:
    Result<void> add_formulas(double error);
    Result<void> add_simpler(const FitMaps& base, double error);
    Result<FitMaps> drop_levels(const std::vector<Fog>& whole, const FitMaps& start,
                                double error) const;
    Result<FitMaps> best_family(const FitMaps& base, int degree, double error) const;
    Result<Worst> error_of(const FitMaps& maps, double limit) const;

    const Gl& gl_;
    const Scene& scene_;
    const std::vector<View>& tuning_;
    std::vector<FitMaps> maps_;
    std::vector<std::vector<FogTextures>> textures_;  ///< of maps_
    std::vector<FitSetting> settings_;
    std::vector<FitMiss> misses_;
    std::optional<FitSetting> before_;
    std::vector<std::string> why_;
};

}  // namespace wavefog::cli
