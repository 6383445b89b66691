// Formulas that say what a map says.
#pragma once

#include <string>
#include <vector>

#include "fit/views.h"
#include "report.h"

namespace wavefog::cli {

/// The name of the formula that is 0 everywhere.
inline constexpr const char* kNoFog = "no fog";

/// A fog in closed form in place of a map, its extinction fitted.
struct Formula {
    std::size_t fog = 0;  ///< of the scene's maps
    std::string name;     ///< kNoFog, homogeneous, halfspace or layers
    std::string words;    ///< "halfspace fog below y = 8 m with extinction 0.03/m"
    FogModel model;
    double error = 0;  ///< over a sample of the tuning views' pixels, the other fogs as they are
};

/// Fits formulas to a sample of the views' pixels.
class FormulaFit {
  public:
    FormulaFit(const Scene& scene, const std::vector<View>& views);

    /// No fog, homogeneous fog, a halfspace and layers, the simplest first, each with the
    /// extinction (and the halfspace's height) of the least error. `others` already replace other
    /// maps.
    std::vector<Formula> fit(std::size_t fog, const std::vector<Formula>& others) const;

  private:
    struct Sample {
        Eigen::Vector3d begin, end;  ///< `end` for fogs without a border
    };
    /// Optical depth of every sample.
    Eigen::ArrayXd depths(const FogModel& model) const;
    /// The extinction in [0, highest] of the least error, and that error.
    std::pair<double, double> best_extinction(const Eigen::ArrayXd& unit,
                                              const Eigen::ArrayXd& others, double highest) const;

    const Scene& scene_;
    std::vector<Sample> samples_;
    Eigen::ArrayXd total_;               ///< true optical depth
    std::vector<Eigen::ArrayXd> parts_;  ///< of each map
};

/// A formula as an entry of a scene's "fog": those that FormulaFit makes.
Facts formula_json(const FogModel& model);

}  // namespace wavefog::cli
