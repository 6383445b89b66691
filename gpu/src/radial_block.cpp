#include "radial_block.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "wavefog/gpu/pixel_rays.h"

namespace wavefog {
namespace {

using Eigen::Vector2d;
using Polygon = std::vector<Vector2d>;

// Azimuth coordinates (fog_radial.glsl). Tangents are 5 times finer this far from the axis,
// radians; bent ones 1.3 times coarser.
constexpr double kTangentLimit = 1.1, kBentLimit = 0.87, kBend = 0.28;

// Table sizes by measurement: the least for which |dT| stays below 1/510 over three real maps of 64
// pixels, extinction 0.12/m and cells of 6 m, from inside, from above and looking down. Between
// slabs two look-ups are subtracted.
struct Density {
    double columns, rows;  // a cell; columns at the far end
};
constexpr Density kUniform = {6, 4}, kInLayers = {12, 11};
// With the exact last step rows cost walks alone, and azimuths are worth what they cost: 1e-5
// there.
constexpr Density kWithStep = {24, 1};
// In a thin exponential layer, which a ray from above crosses within few cells, azimuths err most:
// 1.5e-2 with one a pixel on the valley seen from above, 3e-3 with four.
constexpr double kInPixel = 4;
constexpr double kFinerOutside = 4;
constexpr double kFullTurn = 6;  // columns a cell
constexpr int kLeastColumns = 256, kLeastRows = 64;
constexpr std::size_t kLargestTable = 16 << 20;  // bytes
// Rows lie by sqrt(L + r0), r0 this part of the whole length: 4 times finer at the eye than far
// away.
constexpr double kNearRows = 1.0 / 16;
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
        if ((da > 0 && db < 0) || (da < 0 && db > 0))
            kept.push_back(a + (b - a) * (da / (da - db)));
    }
    return kept;
}

/// The map's box as seen from the eye, counter-clockwise in (x, z).
Polygon fog_box(const FogFacts& fog, const Eigen::Vector3d& eye, double seconds) {
    const double margin_x = (fog.rect.x1 - fog.rect.x0) / fog.width * fog.degree / 2;
    const double margin_z = (fog.rect.z1 - fog.rect.z0) / fog.height * fog.degree / 2;
    const Eigen::Vector2d moved = wind_offset(fog.wind, fog.rect, fog.boundary, seconds);
    const double x0 = fog.rect.x0 - margin_x + moved.x() - eye.x();
    const double x1 = fog.rect.x1 + margin_x + moved.x() - eye.x();
    const double z0 = fog.rect.z0 - margin_z + moved.y() - eye.z();
    const double z1 = fog.rect.z1 + margin_z + moved.y() - eye.z();
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
        const double period = std::max(fog.rect.x1 - fog.rect.x0, fog.rect.z1 - fog.rect.z0);
        extent.farthest = std::min(limit, kPeriods * period);
        return extent;
    }
    const Polygon box = fog_box(fog, eye, seconds);
    Polygon seen = box;
    if (!view.full && view.last - view.first < std::numbers::pi) {
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
    const Eigen::Matrix4d to_clip = clip_from_eye(matrices);
    const Eigen::Matrix4d from_clip = eye_from_clip(matrices);
    RadialView view;
    view.pixel = 2 * std::tan(camera.fov_y_deg * std::numbers::pi / 360) / height;
    const Eigen::Vector3d forward = -matrices.view.row(2).head<3>().transpose();
    for (const double up : {1.0, -1.0}) {
        const Eigen::Vector4d c = to_clip * Eigen::Vector4d(0, up, 0, 0);
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
            const Eigen::Vector4d far_point =
                from_clip * Eigen::Vector4d(x, y, matrices.sky_depth, 1);
            const double angle = angle_from(view.axis, {far_point.x(), far_point.z()});
            view.first = std::min(view.first, angle);
            view.last = std::max(view.last, angle);
        }
    const bool level = std::abs(forward.y()) < 1e-9 && std::abs(matrices.view(0, 1)) < 1e-9;
    if (level) view.level_pixels = width;
    return view;
}

RadialView radial_union(const std::vector<RadialView>& views) {
    constexpr double kTurn = 2 * std::numbers::pi;
    RadialView all = views.front();
    const auto pixel_tangent = [](const RadialView& view) {
        return (std::tan(view.last) - std::tan(view.first)) / view.level_pixels;
    };
    bool full = false, one_axis = true, level = true;
    for (const RadialView& view : views) {
        full |= view.full;
        one_axis &= view.axis == all.axis;
        level &= view.level_pixels > 0;
        all.pixel = std::min(all.pixel, view.pixel);
    }
    if (full) return {.pixel = all.pixel};
    if (one_axis) {
        const double tangent = level ? pixel_tangent(all) : 0;
        for (const RadialView& view : views) {
            all.first = std::min(all.first, view.first);
            all.last = std::max(all.last, view.last);
            level = level && std::abs(pixel_tangent(view) - tangent) < 1e-6 * tangent;
        }
        all.level_pixels = level ? static_cast<int>(std::lround(
                                       (std::tan(all.last) - std::tan(all.first)) / tangent))
                                 : 0;
        return all;
    }
    // All azimuths but the widest gap between views.
    std::vector<std::pair<double, double>> arcs;
    double reach = -kTurn;
    for (const RadialView& view : views) {
        double begin = angle_from(all.axis, view.axis) + view.first;
        begin -= kTurn * std::floor(begin / kTurn);
        arcs.emplace_back(begin, begin + view.last - view.first);
        reach = std::max(reach, arcs.back().second - kTurn);
    }
    std::sort(arcs.begin(), arcs.end());
    double gap = 0, start = 0;
    for (const auto& [begin, end] : arcs) {
        if (begin - reach > gap) {
            gap = begin - reach;
            start = begin;
        }
        reach = std::max(reach, end);
    }
    if (gap < 1e-9) return {.pixel = all.pixel};
    const double half = (kTurn - gap) / 2;
    const Vector2d axis = Eigen::Rotation2Dd(start + half) * all.axis;
    return {.full = false, .axis = axis, .first = -half, .last = half, .pixel = all.pixel};
}

std::size_t RadialShape::bytes() const {
    return sizeof(float) * static_cast<std::size_t>(channels) * static_cast<std::size_t>(layers) *
           static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows);
}

RadialShape radial_shape(const FogFacts& fog, const Method& method, int sharing, int largest) {
    const int finest = static_cast<int>(fog.levels.size()) - 1;
    RadialShape shape;
    switch (fog.profile.kind) {
        case Profile::Kind::uniform:
        case Profile::Kind::slab:
            break;
        case Profile::Kind::linear:
            shape.channels = 2;
            break;
        case Profile::Kind::exponential:
            shape.channels = 4;
            break;
    }
    const bool layered = method.mu > 0 && method.mu < 1 && finest > 0;
    shape.layers = layered ? finest + 1 : 1;
    shape.step = method.radial_step;
    if (shape.step) {
        // Longer last steps cost what finer azimuths then gain.
        shape.columns = 4096;
        shape.rows = 256;
    }
    shape.finest = method.mu == 1 ? finest : 0;
    if (method.radial[0] > 0) {
        shape.columns = method.radial[0];
        shape.rows = method.radial[1];
        shape.fixed = true;
        return shape;
    }
    if (layered) shape.rows /= 2;
    const int wanted = std::min(shape.columns * sharing, std::max(largest, shape.columns));
    while (shape.bytes() > kLargestTable) shape.columns /= 2;
    while (2 * shape.columns <= wanted && 2 * shape.bytes() <= kLargestTable) shape.columns *= 2;
    return shape;
}

shader::RadialBlock radial_block(const FogFacts& fog, const Eigen::Vector3d& eye,
                                 const RadialView& view, double seconds, double limit,
                                 const RadialShape& shape) {
    const Extent extent = extent_of(fog, eye, view, seconds, limit);
    const double cell_x = (fog.rect.x1 - fog.rect.x0) / fog.width;
    const double cell_z = (fog.rect.z1 - fog.rect.z0) / fog.height;
    const double cell = std::min(cell_x, cell_z);
    const double length = std::max(extent.farthest - extent.nearest, 1e-3 * cell);

    const double widest = std::max(-extent.first, extent.last);
    const bool tangents = view.level_pixels > 0 && widest < kTangentLimit;
    const bool wide = !tangents && widest > kBentLimit;
    const double bend = tangents ? 0 : kBend;
    const double first = coordinate_of(extent.first, bend, wide);
    const double last = coordinate_of(extent.last, bend, wide);
    // Azimuth steps: part of a cell at the far end, but no finer than pixels.
    const double left = tangents ? std::tan(view.first) : 0;
    const double pixel = tangents ? (std::tan(view.last) - left) / view.level_pixels : view.pixel;
    const Density& per_cell = shape.step                                   ? kWithStep
                              : fog.profile.kind == Profile::Kind::uniform ? kUniform
                                                                           : kInLayers;
    const double least = shape.step && shape.channels == 4 && !tangents ? pixel / kInPixel : pixel;
    // A full turn of azimuths is dear.
    const double per_cell_far = shape.step && view.full ? kFullTurn : per_cell.columns;
    double step = std::max(cell / (per_cell_far * std::max(extent.farthest, cell)), least);
    // Seen from outside, rays graze the map's edges.
    if (extent.nearest > 0) step /= kFinerOutside;
    int columns = shape.columns;
    if (!shape.fixed)
        columns = std::clamp(static_cast<int>(std::ceil((last - first) / step)) + 1, kLeastColumns,
                             shape.columns);
    double begin = first;
    step = (last - first) / (columns - 1);
    const bool own_columns = tangents && step <= 1.01 * pixel;
    if (own_columns) {
        // One column a pixel column: nothing is interpolated across.
        const double from = std::floor((first - left) / pixel);
        begin = left + (from + 0.5) * pixel;
        columns = std::min(static_cast<int>(std::ceil((last - left) / pixel - from)), columns);
        step = pixel;
    }
    const double per_step = step > 0 ? 1 / step : 0;

    const int rows = shape.fixed ? shape.rows
                                 : std::clamp(static_cast<int>(per_cell.rows * length / cell),
                                              kLeastRows, shape.rows);
    const double r0 = length * kNearRows;
    const double per_row = (std::sqrt(length + r0) - std::sqrt(r0)) / (rows - 1);

    const auto vec = [](double x, double y, double z = 0, double w = 0) {
        return glm::vec4(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z),
                         static_cast<float>(w));
    };
    shader::RadialBlock block{};
    block.axis = vec(view.axis.x(), view.axis.y(), bend, wide);
    // Texel i holds column i: u = (i + 1/2) / width; rows likewise.
    const double width = shape.columns, height = shape.rows * shape.layers;
    block.azimuth = vec(begin, step, (0.5 - begin * per_step) / width, per_step / width);
    block.radius = vec(extent.nearest, length, r0, std::sqrt(r0));
    block.rows = vec(per_row, 0, (0.5 - std::sqrt(r0) / per_row) / height, 1 / per_row / height);
    block.edge = vec(0.5 / width, (columns - 0.5) / width, 1.0 / shape.layers, own_columns);
    block.cell = vec(cell_x, cell_z);
    const double seen = least_share(fog.channels) * fog.extinction * fog.density_scale;
    block.stop = vec(shape.stop() / std::max(seen, 1e-30), 0);
    block.size = {columns, rows, shape.rows, shape.finest};
    // Cells of level l - 1, twice as large as level l's, serve where they are small in the picture.
    const int finest = static_cast<int>(fog.levels.size()) - 1;
    for (int l = finest; l > 0; --l) {
        const double until = std::ldexp(std::max(cell_x, cell_z), finest - l + 1) / view.pixel;
        const double root = std::sqrt(std::clamp(until - extent.nearest, 0.0, length) + r0);
        const int row = static_cast<int>((root - std::sqrt(r0)) / per_row);
        block.level[l] = {view.pixel == 0 ? rows : std::min(row + 1, rows), 0, 0, 0};
    }
    block.level[0] = {rows, 0, 0, 0};
    return block;
}

}  // namespace wavefog
