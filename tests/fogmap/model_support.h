// Random fogs given by formulas, one of every kind, around an offset in the world.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "support/random.h"
#include "wavefog/fogmap/models.h"

namespace wavefog::test {

inline Eigen::Vector3d random_vector(Random& random, double size) {
    const double x = random.uniform(-size, size), y = random.uniform(-size, size);
    return {x, y, random.uniform(-size, size)};
}

inline Eigen::Vector3d random_direction(Random& random) {
    return Eigen::Vector3d(random.normal(), random.normal(), random.normal()).normalized();
}

inline Cosines random_cosines(Random& random) {
    Cosines fog;
    for (int i = 0; i < 4; ++i) {
        const double size = random.uniform(0.2, 3);
        fog.waves.push_back({random.uniform(-0.005, 0.005), size * random_direction(random),
                             random.uniform(0.02, 0.6), random.uniform(-9, 9)});
        fog.extinction += std::abs(fog.waves.back().extinction);
    }
    return fog;
}

// 0.8 - u + u^5 is the paper's; the others are not negative either, even ones repeat.
inline Polynomials random_polynomials(Random& random, const Eigen::Vector3d& offset) {
    using Outside = Polynomials::Outside;
    Polynomials fog;
    const auto add = [&](const std::vector<double>& c, const Eigen::Vector3d& direction,
                         Outside outside) {
        fog.terms.push_back({random.uniform(0.002, 0.01), c, direction,
                             offset + random_vector(random, 20), random.uniform(4, 25), outside});
    };
    add({0.8, -1, 0, 0, 0, 1}, {1, 0, 0}, Outside::repeat);
    add({0.8, -1, 0, 0, 0, 1}, random_direction(random), Outside::repeat);
    add({1, 0, -2, 0, 1}, {0, 1, 0}, Outside::zero);
    add({0.7, 0.3, 0, 0, 0, 0, 0, 0, 0.5, -0.3}, random_direction(random), Outside::zero);
    add({0.1, 0, 0, 0, 0, 0, 0, 0, 1}, {0, 0, 1}, Outside::repeat);
    return fog;
}

inline Potentials random_potentials(Random& random, const Eigen::Vector3d& offset) {
    using Kind = Potentials::Object::Kind;
    Potentials fog;
    const auto place = [&] { return Eigen::Vector3d(offset + random_vector(random, 25)); };
    for (const double extinction : {0.04, -0.004}) {
        const auto reach = [&] { return random.uniform(2, 12); };
        fog.objects.push_back({Kind::point, place(), {0, 0, 0}, 0, extinction, reach()});
        fog.objects.push_back({Kind::line, place(), place(), 0, extinction, reach()});
        fog.objects.push_back(
            {Kind::sphere, place(), {0, 0, 0}, random.uniform(1, 12), extinction, reach()});
    }
    fog.extinction = 3 * 0.004;
    return fog;
}

inline AxisTable random_table(Random& random, int count, double begin, double end,
                              bool repeat = false) {
    AxisTable table{{}, begin, end, repeat};
    for (int i = 0; i < count; ++i) table.values.push_back(random.uniform(0, 2));
    if (repeat) table.values.back() = table.values.front();
    return table;
}

/// Tables over 40 m around the offset; that of y ends with 0.
inline Separable random_separable(Random& random, const Eigen::Vector3d& offset, bool repeat) {
    Separable fog{0.03, {}, Separable::Integral::exact};
    for (std::size_t a = 0; a < 3; ++a) {
        const double at = offset[static_cast<Eigen::Index>(a)] + random.uniform(-2, 2);
        fog.axes[a] = random_table(random, 9, at - 20, at + 20, repeat && a != 1);
    }
    fog.axes[1].values.back() = 0;
    return fog;
}

/// One of each kind, halfspaces level and tilted, constant and linear, layers of two and four
/// points; extinctions make tau about 1 over 50 m.
inline std::vector<FogModel> random_models(Random& random,
                                           const Eigen::Vector3d& offset = {0, 0, 0}) {
    const double y = offset.y();
    return {Halfspace{{0, 1, 0}, offset + Eigen::Vector3d(0, 3, 0), 0.02, 0},
            Halfspace{{0, 1, 0}, offset + Eigen::Vector3d(0, 8, 0), 0, 0.002},
            Halfspace{random_direction(random), offset + random_vector(random, 10), 0.02, 0},
            Halfspace{random_direction(random), offset + random_vector(random, 10), 0.01, 0.001},
            Ramp{{{y + 2, 0.03}, {y + 9, 0}}},
            Ramp{{{y - 6, 0}, {y - 1, 0.05}, {y + 1, 0.05}, {y + 12, 0}}},
            ExponentialLayer{0.04, y + 1, 5},
            random_cosines(random),
            random_polynomials(random, offset),
            random_potentials(random, offset),
            random_separable(random, offset, false),
            Separable{0.02,
                      {AxisTable{}, random_table(random, 40, y - 12, y + 15), AxisTable{}},
                      Separable::Integral::exact},
            random_separable(random, offset, true)};
}

/// Halfspaces whose fog fraction is OpenGL's linear or exp2: parts of a ray do not add up in them.
inline std::vector<FogModel> random_fractions(Random& random,
                                              const Eigen::Vector3d& offset = {0, 0, 0}) {
    using enum Halfspace::Fraction;
    const Eigen::Vector3d level = offset + Eigen::Vector3d(0, 3, 0), up(0, 1, 0);
    const Eigen::Vector3d tilted = random_direction(random);
    return {Halfspace{up, level, 0.02, 0, linear},
            Halfspace{up, level, 0, 0.002, linear},
            Halfspace{tilted, offset + random_vector(random, 10), 0.02, 0, linear, 12},
            Halfspace{tilted, offset + random_vector(random, 10), 0.01, 0.001, linear},
            Halfspace{up, level, 0.02, 0, exp2},
            Halfspace{up, level, 0, 0.002, exp2},
            Halfspace{tilted, offset + random_vector(random, 10), 0.01, 0.001, exp2}};
}

/// Both.
inline std::vector<FogModel> all_models(Random& random, const Eigen::Vector3d& offset = {0, 0, 0}) {
    auto models = random_models(random, offset);
    for (FogModel& model : random_fractions(random, offset)) models.push_back(std::move(model));
    return models;
}

inline std::string kind_name(const FogModel& model) {
    constexpr const char* names[] = {"halfspace",   "ramp",       "exponential", "cosines",
                                     "polynomials", "potentials", "separable"};
    return names[model.index()];
}

using Segment3 = std::pair<Eigen::Vector3d, Eigen::Vector3d>;

/// Random, level, vertical, short and zero-length segments and grazing ones around y = 3 (the
/// first halfspace's plane), all near `offset`.
inline std::vector<Segment3> model_segments(Random& random, int count,
                                            const Eigen::Vector3d& offset = {0, 0, 0}) {
    std::vector<Segment3> segments;
    for (int i = 0; i < count; ++i) {
        const Eigen::Vector3d o = offset + random_vector(random, 40);
        Eigen::Vector3d p = offset + random_vector(random, 40);
        switch (i % 8) {
            case 1:  // level
                p.y() = o.y();
                break;
            case 2:  // vertical
                p.x() = o.x();
                p.z() = o.z();
                break;
            case 3:  // nearly level
                p.y() = o.y() + random.uniform(-1e-3, 1e-3);
                break;
            case 4:  // short
                p = o + 1e-3 * random_direction(random);
                break;
            case 5:  // of no length
                p = o;
                break;
            default:
                break;
        }
        segments.emplace_back(o, p);
        if (i % 8 == 6)  // grazing a level plane at y = 3
            segments.emplace_back(
                Eigen::Vector3d(o.x(), offset.y() + 3 + random.uniform(-1e-2, 1e-2), o.z()),
                Eigen::Vector3d(p.x(), offset.y() + 3 + random.uniform(-1e-2, 1e-2), p.z()));
    }
    return segments;
}

}  // namespace wavefog::test
