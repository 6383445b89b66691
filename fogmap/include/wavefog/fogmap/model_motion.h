// Fogs given by formulas as time goes on: their wind, and shapes that turn into one another.
#pragma once

#include <vector>

#include "wavefog/fogmap/models.h"
#include "wavefog/fogmap/wind.h"

namespace wavefog {

/// What moves and changes a model. A formula that changes has shapes at times, of one kind and with
/// as many parts; between two its coefficients, places and sizes are linear in time (paper 000,
/// section 5), before the first and after the last it rests.
struct ModelMotion {
    struct Key {
        double seconds = 0;
        FogModel shape;
    };
    Wind wind;
    std::vector<Key> shapes;  ///< times ascend; none: the shape stays

    ModelMotion() = default;
    ModelMotion(Wind moving, std::vector<Key> changing = {})
        : wind(std::move(moving)), shapes(std::move(changing)) {}
};

/// The shape between `a` (share 0) and `b` (share 1), valid where both are: no constraint on a
/// model is broken by a mean of two that keep it. A polynomial's terms are mixed as functions, so
/// that no product of two mixed numbers bends what lies between. Channels are those of `a`.
FogModel interpolate(const FogModel& a, const FogModel& b, double share);

/// A data error if two valid shapes have no shapes between them, naming what differs: kind, number
/// of parts, a plane's or a polynomial's direction, a domain, the kind of an object.
Result<void> check_interpolable(const FogModel& a, const FogModel& b);

/// Models at a time, in their shapes and where their winds have taken them; those without a motion
/// of their own stay as they are.
std::vector<FogModel> models_at(std::vector<FogModel> models,
                                const std::vector<ModelMotion>& motions, double seconds);

}  // namespace wavefog
