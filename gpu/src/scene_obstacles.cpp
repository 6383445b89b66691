#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numbers>

#include "mesh_file.h"
#include "wavefog/gpu/obstacles.h"
#include "wavefog/gpu/terrain.h"

namespace wavefog {
namespace {

using Eigen::Vector3d;

struct Triangle {
    Vector3d corner, side, other_side;
};

/// Where a segment meets a triangle, in (0, 1], or 2 (Moeller and Trumbore 1997).
double meeting(const Triangle& triangle, const Vector3d& from, const Vector3d& path) {
    const Vector3d h = path.cross(triangle.other_side);
    const double a = triangle.side.dot(h);
    if (a == 0) return 2;
    const Vector3d s = from - triangle.corner;
    const double u = s.dot(h) / a;
    const Vector3d q = s.cross(triangle.side);
    const double v = path.dot(q) / a, t = triangle.other_side.dot(q) / a;
    return u >= 0 && v >= 0 && u + v <= 1 && t > 0 && t <= 1 ? t : 2;
}

/// Triangles by the squares of the ground that they stand on.
class TriangleGrid {
  public:
    explicit TriangleGrid(std::vector<Triangle> triangles) : triangles_(std::move(triangles)) {
        for (const Triangle& t : triangles_) extend(bounds_, t);
        side_ = std::clamp(static_cast<int>(std::sqrt(double(triangles_.size()))), 1, 512);
        squares_.resize(static_cast<std::size_t>(side_ * side_));
        for (std::size_t i = 0; i < triangles_.size(); ++i) {
            Eigen::AlignedBox3d box;
            extend(box, triangles_[i]);
            for_squares(
                box, [&](std::size_t square) { squares_[square].push_back(static_cast<int>(i)); });
        }
    }

    std::optional<Contact> contact(const Vector3d& from, const Vector3d& to) const {
        Eigen::AlignedBox3d box(from);
        box.extend(to);
        if (!box.intersects(bounds_)) return std::nullopt;
        const Vector3d path = to - from;
        double first = 2;
        const Triangle* met = nullptr;
        for_squares(box, [&](std::size_t square) {
            for (const int i : squares_[square])
                if (const double t = meeting(triangles_[std::size_t(i)], from, path); t < first) {
                    first = t;
                    met = &triangles_[std::size_t(i)];
                }
        });
        if (!met) return std::nullopt;
        Vector3d normal = met->side.cross(met->other_side).normalized();
        if (normal.dot(path) > 0) normal = -normal;
        return Contact{from + first * path, normal};
    }

  private:
    static void extend(Eigen::AlignedBox3d& box, const Triangle& t) {
        box.extend(t.corner).extend(t.corner + t.side).extend(t.corner + t.other_side);
    }
    int index(double value, int axis) const {
        const double low = bounds_.min()[axis], size = bounds_.max()[axis] - low;
        return static_cast<int>(
            std::clamp((value - low) / (size > 0 ? size : 1) * side_, 0.0, double(side_ - 1)));
    }
    template <class Use>
    void for_squares(const Eigen::AlignedBox3d& box, const Use& use) const {
        for (int j = index(box.min().z(), 2); j <= index(box.max().z(), 2); ++j)
            for (int i = index(box.min().x(), 0); i <= index(box.max().x(), 0); ++i)
                use(static_cast<std::size_t>(j * side_ + i));
    }

    std::vector<Triangle> triangles_;
    Eigen::AlignedBox3d bounds_;
    int side_ = 1;
    std::vector<std::vector<int>> squares_;
};

std::optional<Contact> ground_contact(const HeightField& field, const Vector3d& from,
                                      const Vector3d& to) {
    const double over = to.y() - field.height(to.x(), to.z());
    if (over >= 0) return std::nullopt;
    const double before = std::max(from.y() - field.height(from.x(), from.z()), 0.0);
    Vector3d point = from + before / (before - over) * (to - from);
    point.y() = field.height(point.x(), point.z());
    constexpr double kApart = 0.1;  // metres
    const double slope_x =
        field.height(point.x() + kApart, point.z()) - field.height(point.x() - kApart, point.z());
    const double slope_z =
        field.height(point.x(), point.z() + kApart) - field.height(point.x(), point.z() - kApart);
    return Contact{point, Vector3d(-slope_x, 2 * kApart, -slope_z).normalized()};
}

}  // namespace

Result<Obstacle> scene_obstacles(const std::optional<Terrain>& terrain,
                                 const std::vector<MeshInstance>& meshes) {
    std::shared_ptr<const HeightField> field;
    if (terrain) {
        auto loaded = HeightField::load(*terrain);
        if (!loaded) return tl::unexpected(loaded.error());
        field = std::make_shared<const HeightField>(std::move(*loaded));
    }
    std::map<std::filesystem::path, MeshData> files;
    std::vector<Triangle> triangles;
    for (const MeshInstance& item : meshes) {
        if (!files.contains(item.file)) {
            auto data = load_mesh(item.file);
            if (!data) return tl::unexpected(data.error());
            files[item.file] = std::move(*data);
        }
        const MeshData& mesh = files[item.file];
        Vector3d place = item.translate;
        if (item.on_terrain && field) place.y() += field->height(place.x(), place.z());
        const Eigen::Matrix3d turn =
            item.scale *
            Eigen::AngleAxisd(item.rotate_y_deg * std::numbers::pi / 180, Vector3d::UnitY())
                .toRotationMatrix();
        const auto corner = [&](std::size_t i) -> Vector3d {
            const float* p = mesh.vertices[mesh.indices[i]].position;
            return place + turn * Vector3d(double(p[0]), double(p[1]), double(p[2]));
        };
        for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
            const Vector3d a = corner(i);
            triangles.push_back({a, corner(i + 1) - a, corner(i + 2) - a});
        }
    }
    std::shared_ptr<const TriangleGrid> grid;
    if (!triangles.empty()) grid = std::make_shared<const TriangleGrid>(std::move(triangles));
    if (!field && !grid) return Obstacle{};
    return Obstacle([field, grid](const Vector3d& from, const Vector3d& to) {
        const auto mesh = grid ? grid->contact(from, to) : std::nullopt;
        // What lies behind a triangle is not reached.
        const auto ground =
            field ? ground_contact(*field, from, mesh ? mesh->point : to) : std::nullopt;
        return ground ? ground : mesh;
    });
}

}  // namespace wavefog
