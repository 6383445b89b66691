#include "radial_block.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

namespace wavefog {
namespace {

using Eigen::Vector2d;
using Polygon = std::vector<Vector2d>;

// Azimuth coordinates (fog_radial.glsl). Tangents are 5 times finer this far from the axis, radians;
// bent ones 1.3 times coarser.
constexpr double kTangentLimit = 1.1, kBentLimit = 0.87, kBend = 0.28;
constexpr double kColumnsPerCell = 6, kRowsPerCell = 4;
constexpr int kLeastColumns = 64, kLeastRows = 64;
// A cell of the next level must be no larger than this part of a pixel.
constexpr double kDetail = 1;
// T = 9e-4 behind this much fog: a column ends there, its error below half of what can be seen.
constexpr double kStopRadial = 7;
// Repeated maps: periods until the mean along an azimuth is taken to stay.
constexpr double kPeriods = 16;

double cross(const Vector2d& a, const Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
}
/// Radians from `axis` towards (-z, x).
double angle_from(const Vector2d& axis, const Vector2d& d) {
    return std::atan2(cross(axis, d), axis.dot(d));
}

/// The part of a convex polygon where cross(edge, p) has the sign of `side` or is 0.
Polygon clip(const Polygon& polygon, const Vector2d& edge, double side) {
    Polygon kept;
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector2d &a = polygon[i], &b = polygon[(i + 1) % polygon.size()];
        const double da = side * cross(edge, a), db = side * cross(edge, b);
        if (da >= 0) kept.push_back(a);
        if ((da > 0 && db < 0) || (da < 0 && db > 0)) kept.push_back(a + (b - a) * (da / (da - db)));
    }
    return kept;
}

/// The map's box as seen from the eye, counter-clockwise in (x, z).
Polygon fog_box(const FogFacts& fog, const Eigen::Vector3d& eye, double seconds) {
    const double margin_x = (fog.rect.x1 - fog.rect.x0) / fog.width * fog.degree / 2;
    const double margin_z = (fog.rect.z1 - fog.rect.z0) / fog.height * fog.degree / 2;
    const double x0 = fog.rect.x0 - margin_x + fog.wind[0] * seconds - eye.x();
    const double x1 = fog.rect.x1 + margin_x + fog.wind[0] * seconds - eye.x();
    const double z0 = fog.rect.z0 - margin_z + fog.wind[1] * seconds - eye.z();
    const double z1 = fog.rect.z1 + margin_z + fog.wind[1] * seconds - eye.z();
    return {{x0, z0}, {x1, z0}, {x1, z1}, {x0, z1}};
}

bool holds_origin(const Polygon& polygon) {
    for (std::size_t i = 0; i < polygon.size(); ++i)
        if (cross(polygon[(i + 1) % polygon.size()] - polygon[i], -polygon[i]) < 0) return false;
    return true;
}

double distance_to(const Polygon& polygon) {
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < polygon.size(); ++i) {
        const Vector2d a = polygon[i], along = polygon[(i + 1) % polygon.size()] - a;
        const double squared = along.squaredNorm();
        const double t = squared > 0 ? std::clamp(-a.dot(along) / squared, 0.0, 1.0) : 0;
        least = std::min(least, (a + t * along).norm());
    }
    return least;
}

/// Azimuths (radians from the axis) and distances of the fog in view.
struct Extent {
    double first = -std::numbers::pi, last = std::numbers::pi;
    double nearest = 0, farthest = 0;
};

Extent extent_of(const FogFacts& fog, const Eigen::Vector3d& eye, const RadialView& view,
                 double seconds, double limit) {
    Extent extent;
    if (!view.full) {
        extent.first = view.first;
        extent.last = view.last;
    }
    if (fog.boundary == Boundary::repeat) {
        const double period =
            std::max(fog.rect.x1 - fog.rect.x0, fog.rect.z1 - fog.rect.z0);
        extent.farthest = std::min(limit, kPeriods * period);
        return extent;
    }
    const Polygon box = fog_box(fog, eye, seconds);
    Polygon seen = box;
    if (!view.full) {
        const Eigen::Rotation2Dd to_first(view.first), to_last(view.last);
        seen = clip(clip(seen, to_first * view.axis, 1), to_last * view.axis, -1);
    }
    for (const Vector2d& corner : seen) extent.farthest = std::max(extent.farthest, corner.norm());
    if (holds_origin(box) || seen.empty()) return extent;
    extent.nearest = distance_to(seen);
    // From outside, a convex box spans less than half a turn, and its corners bound it.
    const Vector2d middle = std::accumulate(box.begin(), box.end(), Vector2d(0, 0)).normalized();
    const double turn = angle_from(view.axis, middle);
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Vector2d& corner : box) {
        low = std::min(low, turn + angle_from(middle, corner));
        high = std::max(high, turn + angle_from(middle, corner));
    }
    if (low > -std::numbers::pi && high < std::numbers::pi) {
        extent.first = std::max(extent.first, low);
        extent.last = std::min(extent.last, high);
        if (extent.first > extent.last) extent.first = extent.last = 0;
    }
    return extent;
}

/// radial_coordinate() of fog_radial.glsl for an angle from the axis.
double coordinate_of(double angle, double bend, bool wide) {
    const double turns = wide ? std::round(angle / (std::numbers::pi / 2)) : 0;
    const double s = std::tan(angle - turns * (std::numbers::pi / 2));
    return s / (1 + bend * s * s) + turns * 2 / (1 + bend);
}

}  // namespace

RadialView radial_view(const CameraMatrices& matrices, const Camera& camera, int width,
                       int height) {
    Eigen::Matrix4d rotation = matrices.view;
    rotation.topRightCorner<3, 1>().setZero();
    const Eigen::Matrix4d clip_of = matrices.projection * rotation;
    const Eigen::Matrix4d from_clip = clip_of.inverse();
    RadialView view;
    view.pixel = 2 * std::tan(camera.fov_y_deg * std::numbers::pi / 360) / height;
    const Eigen::Vector3d forward = -rotation.row(2).head<3>().transpose();
    for (const double up : {1.0, -1.0}) {
        const Eigen::Vector4d c = clip_of * Eigen::Vector4d(0, up, 0, 0);
        if (c.w() >= 0 && std::abs(c.x()) <= c.w() && std::abs(c.y()) <= c.w()) return view;
    }
    const Vector2d along(forward.x(), forward.z());
    if (along.norm() < 1e-6) return view;
    view.axis = along.normalized();
    view.full = false;
    view.first = std::numbers::pi;
    view.last = -std::numbers::pi;
    for (const double x : {-1.0, 1.0})
        for (const double y : {-1.0, 1.0}) {
            const Eigen::Vector4d far_point = from_clip * Eigen::Vector4d(x, y, matrices.sky_depth, 1);
            const double angle = angle_from(view.axis, {far_point.x(), far_point.z()});
            view.first = std::min(view.first, angle);
            view.last = std::max(view.last, angle);
        }
    const bool level = std::abs(forward.y()) < 1e-9 && std::abs(rotation(0, 1)) < 1e-9;
    if (level) view.level_pixels = width;
    return view;
}

shader::RadialBlock radial_block(const FogFacts& fog, const Eigen::Vector3d& eye,
                                 const RadialView& view, double seconds, double limit,
                                 RadialSize size) {
    const Extent extent = extent_of(fog, eye, view, seconds, limit);
    const double cell = std::min((fog.rect.x1 - fog.rect.x0) / fog.width,
                                 (fog.rect.z1 - fog.rect.z0) / fog.height);
    const double length = std::max(extent.farthest - extent.nearest, 1e-3 * cell);
    const double widest = std::max(-extent.first, extent.last);
    const bool tangents = view.level_pixels > 0 && widest < kTangentLimit;
    const bool wide = !tangents && widest > kBentLimit;
    const double bend = tangents ? 0 : kBend;
    const double first = coordinate_of(extent.first, bend, wide);
    const double last = coordinate_of(extent.last, bend, wide);

    // Azimuth steps: part of a cell at the far end, but no finer than pixels.
    double step = cell / (kColumnsPerCell * std::max(extent.farthest, cell));
    const double left = tangents ? std::tan(view.first) : 0;
    const double pixel =
        tangents ? (std::tan(view.last) - left) / view.level_pixels : view.pixel;
    step = std::max(step, pixel);
    int columns = std::clamp(static_cast<int>(std::ceil((last - first) / step)) + 1, kLeastColumns,
                             kRadialLargest.columns);
    if (size.columns > 0) columns = size.columns;
    double begin = first;
    step = columns > 1 ? (last - first) / (columns - 1) : 0;
    if (tangents && step <= 1.01 * pixel) {
        // One column a pixel column: nothing is interpolated across.
        const double from = std::floor((first - left) / pixel);
        begin = left + (from + 0.5) * pixel;
        columns = std::min(static_cast<int>(std::ceil((last - left) / pixel - from)), columns);
        step = pixel;
    }

    const int rows = size.rows > 0 ? size.rows
                             : std::clamp(static_cast<int>(kRowsPerCell * length / cell), kLeastRows,
                                          kRadialLargest.rows);
    const double r0 = length / 16;
    const double per_row = (std::sqrt(length + r0) - std::sqrt(r0)) / (rows - 1);

    shader::RadialBlock block{};
    block.axis = {static_cast<float>(view.axis.x()), static_cast<float>(view.axis.y()),
                  static_cast<float>(bend), wide ? 1.0f : 0.0f};
    const double width = size.columns > 0 ? size.columns : kRadialLargest.columns;
    const double height = size.rows > 0 ? size.rows : kRadialLargest.rows;
    // Texel i holds column i: u = (i + 1/2) / width.
    block.azimuth = {static_cast<float>(begin), static_cast<float>(step),
                     static_cast<float>((0.5 - (step > 0 ? begin / step : 0)) / width),
                     static_cast<float>((step > 0 ? 1 / step : 0) / width)};
    block.radius = {static_cast<float>(extent.nearest), static_cast<float>(length),
                    static_cast<float>(r0), static_cast<float>(std::sqrt(r0))};
    block.rows = {static_cast<float>(per_row), 0,
                  static_cast<float>((0.5 - std::sqrt(r0) / per_row) / height),
                  static_cast<float>(1 / per_row / height)};
    block.edge = {static_cast<float>(0.5 / width), static_cast<float>((columns - 0.5) / width), 0, 0};
    block.stop = {static_cast<float>(kStopRadial / (fog.extinction * fog.density_scale)), 0, 0, 0};
    block.size = {columns, rows, 0, 0};
    // Cells of level l - 1, twice as large as level l's, serve where they are small in the picture.
    const int finest = static_cast<int>(fog.levels.size()) - 1;
    for (int l = finest; l >= 0; --l) {
        const double until = std::ldexp(cell, finest - l + 1) / (kDetail * view.pixel);
        const double root = std::sqrt(std::clamp(until - extent.nearest, 0.0, length) + r0);
        const int row = static_cast<int>((root - std::sqrt(r0)) / per_row);
        block.level[l] = {l == 0 || view.pixel == 0 ? rows : std::min(row + 1, rows), 0, 0, 0};
    }
    return block;
}

}  // namespace wavefog
