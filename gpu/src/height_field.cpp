#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "wavefog/gpu/terrain.h"

namespace wavefog {

namespace {

/// The step between neighbouring grey values of a picture with 8 bits or fewer, 0 for others: those
/// with more grey values, and those with so few that their cliffs may be meant.
float quantisation_step(const Grid<float>& values) {
    constexpr std::size_t least = 16, most = 256, pixels_a_value = 4;
    std::set<float> distinct;
    for (const float value : values.reshaped()) {
        distinct.insert(value);
        if (distinct.size() > most) return 0;
    }
    if (distinct.size() < least || distinct.size() * pixels_a_value > std::size_t(values.size()))
        return 0;
    float step = *distinct.rbegin() - *distinct.begin();
    for (auto value = std::next(distinct.begin()); value != distinct.end(); ++value)
        step = std::min(step, *value - *std::prev(value));
    return step;
}

/// Relaxes the plateaus of a quantised picture: every pass averages neighbours and puts the result
/// back to within half a step of the pixel, so slopes become straight and nothing else moves.
void smooth_steps(Grid<float>& values, float step) {
    const Grid<float> low = values - step / 2, high = values + step / 2;
    const Eigen::Index rows = values.rows(), columns = values.cols();
    constexpr int passes = 48;
    Grid<float> next(rows, columns);
    for (int pass = 0; pass < passes; ++pass) {
        for (Eigen::Index j = 0; j < rows; ++j) {
            const Eigen::Index up = std::max<Eigen::Index>(j - 1, 0),
                               down = std::min(j + 1, rows - 1);
            for (Eigen::Index i = 0; i < columns; ++i) {
                const Eigen::Index left = std::max<Eigen::Index>(i - 1, 0);
                const Eigen::Index right = std::min(i + 1, columns - 1);
                next(j, i) = (2 * values(j, i) + values(up, i) + values(down, i) + values(j, left) +
                              values(j, right)) /
                             6;
            }
        }
        values = next.max(low).min(high);
    }
}

std::array<double, 4> catmull_rom(double t) {
    return {t * (-0.5 + t * (1 - 0.5 * t)), 1 + t * t * (-2.5 + 1.5 * t),
            t * (0.5 + t * (2 - 1.5 * t)), t * t * (-0.5 + 0.5 * t)};
}

}  // namespace

Result<HeightField> HeightField::load(const Terrain& terrain) {
    const auto image = read_image(terrain.heightmap);
    if (!image) return tl::unexpected(image.error());
    Grid<float> values(image->height, image->width);
    const int colours = std::min(image->channels, image->channels >= 3 ? 3 : 1);
    for (int y = 0; y < image->height; ++y)
        for (int x = 0; x < image->width; ++x) {
            float sum = 0;
            for (int c = 0; c < colours; ++c) sum += image->at(x, y, c);
            if (!std::isfinite(sum))
                return data_error(fmt::format(
                    "{}: pixel ({}, {}) of the height map is not finite; replace such pixels",
                    terrain.heightmap.string(), x, y));
            values(y, x) = sum / float(colours);
        }
    const float low = values.minCoeff(), high = values.maxCoeff();
    if (const float step = quantisation_step(values); step > 0) smooth_steps(values, step);
    const double scale =
        high > low ? (terrain.height_max - terrain.height_min) / (double(high) - low) : 0;
    values = ((values - low).cast<double>() * scale + terrain.height_min).cast<float>();
    return HeightField(std::move(values), terrain.rect);
}

double HeightField::height(double x, double z) const {
    const double u = (x - rect_.x0) / (rect_.x1 - rect_.x0) * columns() - 0.5;
    const double v = (z - rect_.z0) / (rect_.z1 - rect_.z0) * rows() - 0.5;
    const double u_in = std::clamp(u, 0.0, double(columns() - 1));
    const double v_in = std::clamp(v, 0.0, double(rows() - 1));
    const int i = int(u_in), j = int(v_in);
    const auto weights_u = catmull_rom(u_in - i), weights_v = catmull_rom(v_in - j);
    double sum = 0;
    for (int b = 0; b < 4; ++b) {
        const Eigen::Index row = std::clamp(j + b - 1, 0, rows() - 1);
        double along = 0;
        for (int a = 0; a < 4; ++a)
            along += weights_u[std::size_t(a)] *
                     double(heights_(row, std::clamp(i + a - 1, 0, columns() - 1)));
        sum += weights_v[std::size_t(b)] * along;
    }
    return sum;
}

}  // namespace wavefog
