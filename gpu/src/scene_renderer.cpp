#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <new>
#include <numbers>
#include <optional>

#include "mesh_file.h"
#include "sun_shadow.h"
#include "terrain_mesh.h"
#include "wavefog/gpu/frame.h"
#include "wavefog/gpu/pixel_rays.h"
#include "wavefog/gpu/uniforms.h"

namespace wavefog {

namespace {

using Eigen::Matrix4d;
using Eigen::Vector3d;

struct TerrainOnGpu {
    VertexArray array;
    Buffer vertices, indices;
    GLsizei count = 0;
    Vector3d origin;
    double longest_edge = 0;  ///< of a triangle, metres
};

/// The longest side of the triangles.
template <class Vertex>
double longest_edge(const std::vector<Vertex>& vertices,
                    const std::vector<std::uint32_t>& indices) {
    const auto at = [&](std::size_t i) {
        return Eigen::Map<const Eigen::Vector3f>(vertices[indices[i]].position);
    };
    float square = 0;
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
        for (std::size_t k = 0; k < 3; ++k)
            square = std::max(square, (at(i + k) - at(i + (k + 1) % 3)).squaredNorm());
    return std::sqrt(double(square));
}

TerrainOnGpu upload(const Gl& gl, const TerrainMesh& mesh) {
    TerrainOnGpu terrain;
    terrain.origin = mesh.origin;
    terrain.count = GLsizei(mesh.indices.size());
    terrain.longest_edge = longest_edge(mesh.vertices, mesh.indices);
    terrain.array = make_vertex_array(gl);
    gl.BindVertexArray(terrain.array.name());
    terrain.vertices =
        make_buffer(gl, GL_ARRAY_BUFFER, mesh.vertices.size() * sizeof(TerrainVertex),
                    mesh.vertices.data(), GL_STATIC_DRAW);
    terrain.indices =
        make_buffer(gl, GL_ELEMENT_ARRAY_BUFFER, mesh.indices.size() * sizeof(std::uint32_t),
                    mesh.indices.data(), GL_STATIC_DRAW);
    constexpr GLsizei stride = sizeof(TerrainVertex);
    float_attribute(gl, 0, 3, stride, offsetof(TerrainVertex, position));
    float_attribute(gl, 1, 3, stride, offsetof(TerrainVertex, normal));
    float_attribute(gl, 2, 2, stride, offsetof(TerrainVertex, sun));
    gl.BindVertexArray(0);
    return terrain;
}

/// Planes around the view volume but for its far one: unit normals inwards, metres from the eye.
std::array<Eigen::Vector4f, 5> view_sides(const CameraMatrices& matrices, const Camera& camera) {
    const Matrix4d clip = clip_from_eye(matrices);
    const bool reversed = camera.depth == Camera::Depth::reversed;
    const Eigen::RowVector4d planes[] = {
        clip.row(3) + clip.row(0), clip.row(3) - clip.row(0), clip.row(3) + clip.row(1),
        clip.row(3) - clip.row(1),
        reversed ? Eigen::RowVector4d(clip.row(3) - clip.row(2)) : Eigen::RowVector4d(clip.row(2))};
    std::array<Eigen::Vector4f, 5> sides;
    for (std::size_t i = 0; i < sides.size(); ++i)
        sides[i] = (planes[i] / planes[i].head<3>().norm()).transpose().cast<float>();
    return sides;
}

MeshOnGpu upload(const Gl& gl, const MeshData& mesh, const std::vector<InstanceData>& instances) {
    MeshOnGpu group;
    group.count = GLsizei(mesh.indices.size());
    group.instance_count = GLsizei(instances.size());
    group.longest_edge = longest_edge(mesh.vertices, mesh.indices);
    group.array = make_vertex_array(gl);
    gl.BindVertexArray(group.array.name());
    group.vertices = make_buffer(gl, GL_ARRAY_BUFFER, mesh.vertices.size() * sizeof(MeshVertex),
                                 mesh.vertices.data(), GL_STATIC_DRAW);
    constexpr GLsizei stride = sizeof(MeshVertex);
    float_attribute(gl, 0, 3, stride, offsetof(MeshVertex, position));
    float_attribute(gl, 1, 3, stride, offsetof(MeshVertex, normal));
    float_attribute(gl, 2, 3, stride, offsetof(MeshVertex, colour));
    float_attribute(gl, 5, 3, stride, offsetof(MeshVertex, glow));
    group.instances = make_buffer(gl, GL_ARRAY_BUFFER, instances.size() * sizeof(InstanceData),
                                  instances.data(), GL_STATIC_DRAW);
    constexpr GLsizei instance_stride = sizeof(InstanceData);
    float_attribute(gl, 3, 4, instance_stride, offsetof(InstanceData, placement));
    float_attribute(gl, 4, 3, instance_stride, offsetof(InstanceData, turn));
    gl.VertexAttribDivisor(3, 1);
    gl.VertexAttribDivisor(4, 1);
    group.indices =
        make_buffer(gl, GL_ELEMENT_ARRAY_BUFFER, mesh.indices.size() * sizeof(std::uint32_t),
                    mesh.indices.data(), GL_STATIC_DRAW);
    gl.BindVertexArray(0);
    return group;
}

}  // namespace

struct SceneRenderer::Impl {
    const Gl* gl = nullptr;
    Vector3d origin{0, 0, 0};  ///< of the instances, world metres
    Vector3d sky, to_sun, sun_colour;
    std::optional<TerrainOnGpu> terrain;
    std::vector<MeshOnGpu> meshes;
    SunShadow shadow;
    Program terrain_program, mesh_program, sky_program;
    VertexArray no_attributes;

    Result<void> load(const Scene& scene);
    Result<void> load_meshes(const Scene& scene, const HeightField* field, const TerrainMesh* mesh);
    void set_light(GLuint program, const Vector3d& eye) const;
    void draw_sky(const FrameTarget& target, const Camera& camera) const;
    void draw_terrain(GLuint program, const CameraMatrices& matrices, const Vector3d& eye) const;
    void draw_meshes(GLuint program, const CameraMatrices& matrices, const Vector3d& eye) const;
};

Result<void> SceneRenderer::Impl::load(const Scene& scene) {
    sky = scene.sky;
    to_sun = scene.sun.direction.normalized();
    sun_colour = scene.sun.colour;
    no_attributes = make_vertex_array(*gl);

    const auto build = [this](Program& program, const char* vertex, const char* fragment) {
        auto built = build_program(*gl, vertex, fragment);
        if (built) program = std::move(*built);
        return built.map([](const Program&) {});
    };
    if (auto ok = build(terrain_program, "scene_terrain.vert", "scene_terrain.frag"); !ok)
        return ok;
    if (auto ok = build(mesh_program, "scene_mesh.vert", "scene_mesh.frag"); !ok) return ok;
    if (auto ok = build(sky_program, "post_fullscreen.vert", "scene_sky.frag"); !ok) return ok;

    std::optional<HeightField> field;
    std::optional<TerrainMesh> mesh;
    if (scene.terrain) {
        auto loaded = HeightField::load(*scene.terrain);
        if (!loaded) return tl::unexpected(loaded.error());
        field = std::move(*loaded);
        mesh = build_terrain_mesh(*field, to_sun);
        terrain = upload(*gl, *mesh);
        origin = terrain->origin;
    } else if (!scene.meshes.empty()) {
        origin = scene.meshes[0].translate;
    }
    return load_meshes(scene, field ? &*field : nullptr, mesh ? &*mesh : nullptr);
}

Result<void> SceneRenderer::Impl::load_meshes(const Scene& scene, const HeightField* field,
                                              const TerrainMesh* mesh) {
    struct Group {
        MeshData data;
        std::vector<InstanceData> instances;
    };
    std::map<std::filesystem::path, Group> groups;
    Eigen::AlignedBox3d bounds;  // around `origin`, metres
    for (const MeshInstance& item : scene.meshes) {
        auto [found, is_new] = groups.try_emplace(item.file);
        Group& group = found->second;
        if (is_new) {
            auto data = load_mesh(item.file);
            if (!data) return tl::unexpected(data.error());
            group.data = std::move(*data);
        }
        Vector3d place = item.translate;
        if (item.on_terrain && field) place.y() += field->height(place.x(), place.z());
        const float sun = mesh ? mesh->sun_at(place.x(), place.z()) : 1;
        place -= origin;
        const double angle = item.rotate_y_deg * std::numbers::pi / 180;
        group.instances.push_back(
            {{float(place.x()), float(place.y()), float(place.z()), float(item.scale)},
             {float(std::cos(angle)), float(std::sin(angle)), sun}});
        for (const MeshVertex& vertex : group.data.vertices) {
            const Eigen::Map<const Eigen::Vector3f> p(vertex.position);
            bounds.extend(place + item.scale * (Eigen::AngleAxisd(angle, Vector3d::UnitY()) *
                                                p.cast<double>()));
        }
    }
    for (const auto& [file, group] : groups) {
        meshes.push_back(upload(*gl, group.data, group.instances));
    }
    if (meshes.empty() || to_sun.y() <= 0) return {};
    auto drawn = draw_sun_shadow(*gl, meshes, bounds, to_sun);
    if (!drawn) return tl::unexpected(drawn.error());
    shadow = std::move(*drawn);
    return {};
}

void SceneRenderer::Impl::set_light(GLuint program, const Vector3d& eye) const {
    set_uniform(*gl, program, "to_sun", to_sun);
    set_uniform(*gl, program, "sun_colour", sun_colour);
    set_uniform(*gl, program, "sky_colour", sky);
    set_uniform(*gl, program, "shadow_texel", shadow.depth ? shadow.texel : 0.0);
    set_uniform(*gl, program, "shadow_map", 0);
    Matrix4d from_eye = Matrix4d::Identity();
    from_eye.topRightCorner<3, 1>() = eye - origin;
    set_uniform(*gl, program, "shadow_from_eye", Matrix4d(shadow.map_from_origin * from_eye));
    gl->ActiveTexture(GL_TEXTURE0);
    gl->BindTexture(GL_TEXTURE_2D, shadow.depth.name());
}

void SceneRenderer::Impl::draw_sky(const FrameTarget& target, const Camera& camera) const {
    const CameraMatrices m = camera_matrices(camera, target.width, target.height);
    const Eigen::Matrix3d world = m.view.topLeftCorner<3, 3>().transpose();
    // View-space ray of a pixel: the clip coordinates solved for z_view = -1.
    Vector3d centre(0, 0, -1), x(0, 0, 0), y(0, 0, 0);
    if (camera.projection == Camera::Projection::perspective) {
        const Matrix4d& p = m.projection;
        centre = {p(0, 2) / p(0, 0), p(1, 2) / p(1, 1), -1};
        x.x() = 1 / p(0, 0);
        y.y() = 1 / p(1, 1);
    }
    const GLuint program = sky_program.name();
    gl->UseProgram(program);
    set_uniform(*gl, program, "pixel_size",
                Eigen::Vector2d(2.0 / target.width, 2.0 / target.height));
    set_uniform(*gl, program, "direction_centre", Vector3d(world * centre));
    set_uniform(*gl, program, "direction_x", Vector3d(world * x));
    set_uniform(*gl, program, "direction_y", Vector3d(world * y));
    set_uniform(*gl, program, "to_sun", to_sun);
    set_uniform(*gl, program, "sun_colour", sun_colour);
    set_uniform(*gl, program, "sky_colour", sky);
    gl->BindVertexArray(no_attributes.name());
    gl->Disable(GL_DEPTH_TEST);
    gl->DepthMask(GL_FALSE);
    gl->DrawArrays(GL_TRIANGLES, 0, 3);
    gl->DepthMask(GL_TRUE);
    gl->Enable(GL_DEPTH_TEST);
}

// clip_from_eye() is the view's turn alone: the eye is subtracted from each object's origin in
// double.
void SceneRenderer::Impl::draw_terrain(GLuint program, const CameraMatrices& matrices,
                                       const Vector3d& eye) const {
    set_uniform(*gl, program, "clip_from_eye", clip_from_eye(matrices));
    set_uniform(*gl, program, "origin_from_eye", Vector3d(terrain->origin - eye));
    set_uniform(*gl, program, "longest_edge", terrain->longest_edge);
    gl->BindVertexArray(terrain->array.name());
    gl->DrawElements(GL_TRIANGLES, terrain->count, GL_UNSIGNED_INT, nullptr);
}

void SceneRenderer::Impl::draw_meshes(GLuint program, const CameraMatrices& matrices,
                                      const Vector3d& eye) const {
    set_uniform(*gl, program, "clip_from_eye", clip_from_eye(matrices));
    set_uniform(*gl, program, "origin_from_eye", Vector3d(origin - eye));
    for (const MeshOnGpu& mesh : meshes) {
        set_uniform(*gl, program, "longest_edge", mesh.longest_edge);
        mesh.draw(*gl);
    }
}

Result<SceneRenderer> SceneRenderer::create(const Gl& gl, const Scene& scene) {
    try {
        auto impl = std::make_unique<Impl>();
        impl->gl = &gl;
        if (auto loaded = impl->load(scene); !loaded) return tl::unexpected(loaded.error());
        return SceneRenderer(std::move(impl));
    } catch (const std::bad_alloc&) {
        return data_error("scene: not enough memory for its terrain and meshes; use smaller ones");
    }
}

SceneRenderer::SceneRenderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SceneRenderer::SceneRenderer(SceneRenderer&&) noexcept = default;
SceneRenderer& SceneRenderer::operator=(SceneRenderer&&) noexcept = default;
SceneRenderer::~SceneRenderer() = default;

void SceneRenderer::draw(const FrameTarget& target, const Camera& camera) const {
    const Gl& gl = *impl_->gl;
    const CameraMatrices m = camera_matrices(camera, target.width, target.height);
    gl.BindFramebuffer(GL_FRAMEBUFFER, target.framebuffer.name());
    gl.Viewport(0, 0, target.width, target.height);
    gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl.Disable(GL_BLEND);
    gl.Disable(GL_CULL_FACE);
    gl.Disable(GL_SCISSOR_TEST);
    gl.ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    gl.DepthMask(GL_TRUE);
    gl.DepthFunc(camera.depth == Camera::Depth::reversed ? GL_GREATER : GL_LESS);
    gl.ClearDepth(m.sky_depth);
    gl.ClearColor(0, 0, 0, 1);
    gl.Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    impl_->draw_sky(target, camera);

    if (impl_->terrain) {
        const GLuint program = impl_->terrain_program.name();
        gl.UseProgram(program);
        impl_->set_light(program, camera.eye);
        impl_->draw_terrain(program, m, camera.eye);
    }
    if (!impl_->meshes.empty()) {
        const GLuint program = impl_->mesh_program.name();
        gl.UseProgram(program);
        impl_->set_light(program, camera.eye);
        impl_->draw_meshes(program, m, camera.eye);
    }
    gl.BindVertexArray(0);
}

void SceneRenderer::draw_vertices(const Camera& camera, int width, int height,
                                  GLuint terrain_program, GLuint mesh_program) const {
    const Gl& gl = *impl_->gl;
    const CameraMatrices m = camera_matrices(camera, width, height);
    gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl.Disable(GL_CULL_FACE);
    gl.Enable(GL_DEPTH_TEST);
    gl.DepthMask(GL_TRUE);
    gl.DepthFunc(camera.depth == Camera::Depth::reversed ? GL_GREATER : GL_LESS);
    gl.ClearDepth(m.sky_depth);
    gl.Clear(GL_DEPTH_BUFFER_BIT);
    const auto use = [&](GLuint program) {
        gl.UseProgram(program);
        const auto sides = view_sides(m, camera);
        gl.Uniform4fv(gl.GetUniformLocation(program, "view_sides"), GLsizei(sides.size()),
                      sides.front().data());
    };
    if (impl_->terrain) {
        use(terrain_program);
        impl_->draw_terrain(terrain_program, m, camera.eye);
    }
    if (!impl_->meshes.empty()) {
        use(mesh_program);
        impl_->draw_meshes(mesh_program, m, camera.eye);
    }
    gl.BindVertexArray(0);
    gl.Disable(GL_DEPTH_TEST);
}

}  // namespace wavefog
