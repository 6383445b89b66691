// Looks for the cheapest maps and method that keep a scene's error.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "fit/views.h"

namespace wavefog::cli {

/// A scene's fogs simplified in one way.
struct FitMaps {
    std::vector<Fog> fogs;
    std::vector<int> dropped;  ///< finest levels left out, of each fog
    double error = 0;          ///< with nothing else approximated, over the tuning views
};

/// Maps and a method.
struct FitSetting {
    std::size_t maps = 0;  ///< index into FitSearch::maps()
    Method method;
    FogPass pass;
    double error = 0;  ///< over the tuning views
    std::optional<double> ms;
};

/// Tries settings on the tuning views. All errors are measured against the reference.
class FitSearch {
  public:
    FitSearch(const Gl& gl, const Scene& scene, const std::vector<View>& tuning)
        : gl_(gl), scene_(scene), tuning_(tuning) {}

    /// One simplification for each degree up to the fogs' own, which errs at most `error` by
    /// itself; the fogs as they are come first.
    Result<void> simplify(double error);
    /// Every method at every mu on all maps; keeps what errs at most `error`.
    Result<void> try_methods(double error);
    /// Milliseconds of each kept setting at `size` from the scene's camera, taking turns.
    Result<void> time(const Size& size);

    const std::vector<FitMaps>& maps() const { return maps_; }
    /// Fastest first once timed.
    std::vector<FitSetting>& settings() { return settings_; }

  private:
    Result<FitMaps> drop_levels(const std::vector<Fog>& whole, double error) const;

    const Gl& gl_;
    const Scene& scene_;
    const std::vector<View>& tuning_;
    std::vector<FitMaps> maps_;
    std::vector<std::vector<FogTextures>> textures_;  ///< of maps_
    std::vector<FitSetting> settings_;
};

}  // namespace wavefog::cli
