// Wind that changes in time, and where it has taken a fog.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "wavefog/fogmap/models.h"
#include "wavefog/wavelet/result.h"

namespace wavefog {

/// Velocity over the ground, linear between keys, that of the first and the last one before and
/// after. What it moves is at home at time 0. Position is a function of time, not a sum of steps:
/// frames can be computed in any order.
struct Wind {
    struct Key {
        double seconds = 0;
        double x = 0, z = 0;  ///< m/s along x and z
        bool operator==(const Key&) const = default;
    };
    std::vector<Key> keys;  ///< times ascend; none: calm

    Wind() = default;
    /// The same at all times.
    Wind(double x, double z) : keys{{0, x, z}} {}
    bool operator==(const Wind&) const = default;

    bool calm() const;
    bool constant() const { return keys.size() <= 1; }
    /// m/s along x and z.
    Eigen::Vector2d velocity(double seconds) const;
    /// Metres along x and z since time 0: the velocity's integral in closed form.
    Eigen::Vector2d offset(double seconds) const;
    /// A data error that names the key: "[1]: time is 3, after 5; ...".
    Result<void> validate() const;
};

/// The model where `metres` have taken it: planes and objects by their positions, waves by their
/// phases, polynomials and tables by their domains, which where they repeat move by part of a
/// period at most. Layers change with height alone and only move up or down.
FogModel moved(const FogModel& model, const Eigen::Vector3d& metres);

}  // namespace wavefog
