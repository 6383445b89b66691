#include "terrain_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <system_error>
#include <thread>

namespace wavefog {

namespace {

constexpr int max_vertices_a_side = 1024;

/// Heights at the vertices, metres above the origin, with steps dx and dz in metres.
struct VertexGrid {
    Grid<float> height;
    float dx = 1, dz = 1;
    float top = 0;

    int columns() const { return int(height.cols()); }
    int rows() const { return int(height.rows()); }
    /// Bilinear, in vertex units; the caller keeps 0 <= u <= columns-1, 0 <= v <= rows-1.
    float at(float u, float v) const {
        const int i = std::min(int(u), columns() - 2), j = std::min(int(v), rows() - 2);
        const float a = u - float(i), b = v - float(j);
        const float upper = height(j, i) + a * (height(j, i + 1) - height(j, i));
        const float lower = height(j + 1, i) + a * (height(j + 1, i + 1) - height(j + 1, i));
        return upper + b * (lower - upper);
    }
    bool inside(float u, float v) const {
        return u >= 0 && v >= 0 && u <= float(columns() - 1) && v <= float(rows() - 1);
    }
};

/// Runs body(row) for all rows on a few threads.
void parallel_rows(int rows, const std::function<void(int)>& body) {
    const unsigned count = std::clamp(std::thread::hardware_concurrency(), 1u, 16u);
    const auto share = [&](unsigned t) {
        for (int row = int(t); row < rows; row += int(count)) body(row);
    };
    std::vector<std::jthread> threads;
    threads.reserve(count);
    for (unsigned t = 1; t < count; ++t) {
        try {
            threads.emplace_back(share, t);
        } catch (const std::system_error&) {  // no more threads to be had
            share(t);
        }
    }
    share(0);
}

/// Marches towards the sun. The least angle between the ray and the ground below it decides: a
/// penumbra several times wider than the real sun's, so that no stair steps of the grid show.
float sun_visibility(const VertexGrid& grid, int i, int j, const Eigen::Vector3f& to_sun) {
    if (to_sun.y() <= 0) return 0;
    const float horizontal = std::hypot(to_sun.x(), to_sun.z());
    if (horizontal < 1e-4f) return 1;
    constexpr float penumbra = 0.035f;  // in tangents, about two degrees
    const float slope = to_sun.y() / horizontal;
    const float step_u = to_sun.x() / horizontal / grid.dx,
                step_v = to_sun.z() / horizontal / grid.dz;
    const float cell = std::min(grid.dx, grid.dz), start = grid.height(j, i);
    float clearance = 1;
    for (float distance = 1.5f * cell; clearance > -penumbra; distance += cell + 0.03f * distance) {
        const float u = float(i) + step_u * distance, v = float(j) + step_v * distance;
        const float ray = start + slope * distance;
        if (!grid.inside(u, v) || ray > grid.top + penumbra * distance) break;
        clearance = std::min(clearance, (ray - grid.at(u, v)) / distance);
    }
    const float t = std::clamp((clearance + penumbra) / (2 * penumbra), 0.0f, 1.0f);
    return t * t * (3 - 2 * t);
}

/// Cosine-weighted part of the sky above the horizon, from the horizon's angle in 12 directions.
float sky_visibility(const VertexGrid& grid, int i, int j) {
    constexpr int directions = 12;
    const float cell = std::min(grid.dx, grid.dz), start = grid.height(j, i);
    float sum = 0;
    for (int d = 0; d < directions; ++d) {
        // Turned from vertex to vertex, so that the few directions do not draw rays on slopes.
        const float turn = float((i * 5 + j * 3) % 7) / 7;
        const float angle = (float(d) + turn) * 2 * std::numbers::pi_v<float> / directions;
        const float step_u = std::cos(angle) / grid.dx, step_v = std::sin(angle) / grid.dz;
        float tangent = 0;
        for (float distance = 1.5f * cell; distance < 160 * cell; distance *= 1.6f) {
            const float u = float(i) + step_u * distance, v = float(j) + step_v * distance;
            if (!grid.inside(u, v)) break;
            tangent = std::max(tangent, (grid.at(u, v) - start) / distance);
        }
        sum += 1 / (1 + tangent * tangent);
    }
    return sum / directions;
}

/// A 3 x 3 binomial filter: takes out the noise that the turned directions leave.
Grid<float> smoothed(const Grid<float>& values) {
    const Eigen::Index rows = values.rows(), columns = values.cols();
    Grid<float> along(rows, columns), result(rows, columns);
    for (Eigen::Index i = 0; i < columns; ++i)
        along.col(i) = (values.col(std::max<Eigen::Index>(i - 1, 0)) + 2 * values.col(i) +
                        values.col(std::min(i + 1, columns - 1))) /
                       4;
    for (Eigen::Index j = 0; j < rows; ++j)
        result.row(j) = (along.row(std::max<Eigen::Index>(j - 1, 0)) + 2 * along.row(j) +
                         along.row(std::min(j + 1, rows - 1))) /
                        4;
    return result;
}

/// Vertices along a side of `pixels`, edge to edge: up to four a pixel within the limit.
int vertices_along(int pixels, int longer) {
    const int factor = max_vertices_a_side / longer;
    if (factor == 0) return std::max(2, int(std::int64_t(pixels) * max_vertices_a_side / longer));
    return pixels * std::min(factor, 4) + 1;
}

}  // namespace

float TerrainMesh::sun_at(double x, double z) const {
    const double u = std::clamp((x - rect.x0) / (rect.x1 - rect.x0), 0.0, 1.0) * (columns - 1);
    const double v = std::clamp((z - rect.z0) / (rect.z1 - rect.z0), 0.0, 1.0) * (rows - 1);
    const int i = std::min(int(u), columns - 2), j = std::min(int(v), rows - 2);
    const float a = float(u - i), b = float(v - j);
    const auto at = [this](int column, int row) {
        return vertices[std::size_t(row) * std::size_t(columns) + std::size_t(column)].sun;
    };
    return std::lerp(std::lerp(at(i, j), at(i + 1, j), a),
                     std::lerp(at(i, j + 1), at(i + 1, j + 1), a), b);
}

TerrainMesh build_terrain_mesh(const HeightField& field, const Eigen::Vector3d& to_sun) {
    TerrainMesh mesh;
    mesh.rect = field.rect();
    const Rect& rect = mesh.rect;
    const int longer = std::max(field.columns(), field.rows());
    const int columns = vertices_along(field.columns(), longer);
    const int rows = vertices_along(field.rows(), longer);
    mesh.columns = columns;
    mesh.rows = rows;
    const double dx = (rect.x1 - rect.x0) / (columns - 1), dz = (rect.z1 - rect.z0) / (rows - 1);
    mesh.origin = {(rect.x0 + rect.x1) / 2, 0, (rect.z0 + rect.z1) / 2};
    mesh.origin.y() = field.height(mesh.origin.x(), mesh.origin.z());

    VertexGrid grid;
    grid.height.resize(rows, columns);
    grid.dx = float(dx);
    grid.dz = float(dz);
    parallel_rows(rows, [&](int j) {
        for (int i = 0; i < columns; ++i)
            grid.height(j, i) =
                float(field.height(rect.x0 + i * dx, rect.z0 + j * dz) - mesh.origin.y());
    });
    grid.top = grid.height.maxCoeff();

    Grid<float> sky(rows, columns);
    mesh.vertices.resize(std::size_t(columns) * std::size_t(rows));
    const Eigen::Vector3f sun = to_sun.cast<float>();
    parallel_rows(rows, [&](int j) {
        for (int i = 0; i < columns; ++i) {
            TerrainVertex& vertex =
                mesh.vertices[std::size_t(j) * std::size_t(columns) + std::size_t(i)];
            vertex.position[0] = float(rect.x0 - mesh.origin.x() + i * dx);
            vertex.position[1] = grid.height(j, i);
            vertex.position[2] = float(rect.z0 - mesh.origin.z() + j * dz);
            const int left = std::max(i - 1, 0), right = std::min(i + 1, columns - 1);
            const int up = std::max(j - 1, 0), down = std::min(j + 1, rows - 1);
            const float slope_x =
                (grid.height(j, right) - grid.height(j, left)) / (float(right - left) * grid.dx);
            const float slope_z =
                (grid.height(down, i) - grid.height(up, i)) / (float(down - up) * grid.dz);
            const Eigen::Vector3f normal = Eigen::Vector3f(-slope_x, 1, -slope_z).normalized();
            std::copy_n(normal.data(), 3, vertex.normal);
            vertex.sun = sun_visibility(grid, i, j, sun);
            sky(j, i) = sky_visibility(grid, i, j);
        }
    });
    sky = smoothed(smoothed(sky));
    for (std::size_t k = 0; k < mesh.vertices.size(); ++k) mesh.vertices[k].ambient = sky.data()[k];

    mesh.indices.reserve(6 * std::size_t(columns - 1) * std::size_t(rows - 1));
    for (int j = 0; j + 1 < rows; ++j)
        for (int i = 0; i + 1 < columns; ++i) {
            const auto a = std::uint32_t(j * columns + i), b = a + 1;
            const auto c = a + std::uint32_t(columns), d = c + 1;
            // Split along the flatter diagonal, which keeps ridges and gullies sharp.
            const bool along_ad = std::abs(grid.height(j, i) - grid.height(j + 1, i + 1)) <
                                  std::abs(grid.height(j, i + 1) - grid.height(j + 1, i));
            if (along_ad)
                mesh.indices.insert(mesh.indices.end(), {a, c, d, a, d, b});
            else
                mesh.indices.insert(mesh.indices.end(), {a, c, b, b, c, d});
        }
    return mesh;
}

}  // namespace wavefog
