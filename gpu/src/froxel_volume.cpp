#include "froxel_volume.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "program_inputs.h"
#include "wavefog/gpu/pixel_rays.h"
#include "wavefog/gpu/uniforms.h"

namespace wavefog {

namespace shader {
#include "froxel_block.glsl"
}  // namespace shader

namespace {

// Engines begin the volume a little in front of the camera: slices nearer than that are wasted.
constexpr double kNearest = 0.5;
// Threads of a work group along x and y (froxel_*.comp).
constexpr int kGroup = 8;

constexpr GLuint kFogBinding = 0, kFroxelBinding = 1;
// Texture and image units of the shaders' uniforms.
constexpr GLint kDepthUnit = 0, kColourUnit = 1, kVolumeUnit = 2, kMapUnit = 3;
constexpr GLint kExtinctionImage = 0, kVolumeImage = 1;
constexpr UnitOf kSamplers[] = {{"scene_depth", kDepthUnit},
                                {"scene_colour", kColourUnit},
                                {"froxel_volume", kVolumeUnit},
                                {"fog_map", kMapUnit}};
constexpr UnitOf kImages[] = {{"froxel_extinction", kExtinctionImage},
                              {"froxel_volume", kVolumeImage}};
constexpr BindingOf kBlocks[] = {{"FogBlock", kFogBinding}, {"FroxelBlock", kFroxelBinding}};

/// Points with normal . point <= offset.
struct HalfSpace {
    Eigen::Vector3d normal;
    double offset;
};

/// Planes of the view's sides, of depth 0 and of `limit`; points are relative to the eye.
std::vector<HalfSpace> view_volume(const CameraMatrices& matrices, double near_depth,
                                   double limit) {
    const Eigen::Matrix4d clip = clip_from_eye(matrices);
    std::vector<HalfSpace> planes;
    for (int axis = 0; axis < 2; ++axis)
        for (const double sign : {1.0, -1.0}) {
            const Eigen::Vector4d row = (sign * clip.row(axis) - clip.row(3)).transpose();
            const double length = row.head<3>().norm();
            planes.push_back({row.head<3>() / length, -row.w() / length});
        }
    const Eigen::Vector3d forward = -matrices.view.row(2).head<3>().transpose();
    planes.push_back({-forward, -near_depth});
    planes.push_back({forward, near_depth + limit});
    return planes;
}

/// Adds the faces of the fog's box: its map unless that repeats, and its heights.
void add_fog_box(const FogFacts& fog, const Eigen::Vector3d& eye, double seconds,
                 std::vector<HalfSpace>& planes) {
    const auto between = [&](int axis, double low, double high) {
        const Eigen::Vector3d normal = Eigen::Vector3d::Unit(axis);
        if (std::isfinite(low)) planes.push_back({-normal, eye[axis] - low});
        if (std::isfinite(high)) planes.push_back({normal, high - eye[axis]});
    };
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (fog.boundary == Boundary::zero) {
        // The bilinear map ends half a pixel beyond the rectangle at every degree.
        const double x = 0.5 * (fog.rect.x1 - fog.rect.x0) / fog.width;
        const double z = 0.5 * (fog.rect.z1 - fog.rect.z0) / fog.height;
        const Eigen::Vector2d moved = wind_offset(fog.wind, fog.rect, fog.boundary, seconds);
        between(0, fog.rect.x0 + moved.x() - x, fog.rect.x1 + moved.x() + x);
        between(2, fog.rect.z0 + moved.y() - z, fog.rect.z1 + moved.y() + z);
    }
    const auto& profile = fog.profile;
    switch (profile.kind) {
        case Profile::Kind::uniform:
            break;
        case Profile::Kind::slab:
            between(1, profile.bottom, profile.top);
            break;
        case Profile::Kind::exponential:
            between(1, -kInfinity, profile.base + kEtaMax * profile.scale);
            break;
        case Profile::Kind::linear:
            between(1, -kInfinity, profile.top);
            break;
    }
}

/// The largest depth along `forward` in the intersection of the half spaces, which must be bounded;
/// minus infinity if it is empty. A linear function has its maximum at a corner, where three planes
/// meet, and a dozen planes have few.
double largest_depth(const std::vector<HalfSpace>& planes, const Eigen::Vector3d& forward) {
    double largest = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < planes.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            for (std::size_t k = 0; k < j; ++k) {
                Eigen::Matrix3d normals;
                normals << planes[i].normal.transpose(), planes[j].normal.transpose(),
                    planes[k].normal.transpose();
                if (std::abs(normals.determinant()) < 1e-12) continue;
                const Eigen::Vector3d corner =
                    normals.inverse() *
                    Eigen::Vector3d(planes[i].offset, planes[j].offset, planes[k].offset);
                const double slack = 1e-7 * (1 + corner.norm());
                const bool inside = std::all_of(planes.begin(), planes.end(), [&](const auto& p) {
                    return p.normal.dot(corner) <= p.offset + slack;
                });
                if (inside) largest = std::max(largest, forward.dot(corner));
            }
    return largest;
}

/// Where the last slice ends, in depth.
double far_depth(const std::vector<FroxelFog>& fogs, const Camera& camera,
                 const CameraMatrices& matrices, double near_depth, double nearest,
                 double seconds) {
    const Eigen::Vector3d forward = -matrices.view.row(2).head<3>().transpose();
    const auto view = view_volume(matrices, near_depth, sky_limit(camera));
    double farthest = 2 * nearest;
    for (const auto& fog : fogs) {
        auto planes = view;
        add_fog_box(*fog.facts, camera.eye, seconds, planes);
        farthest = std::max(farthest, largest_depth(planes, forward) - near_depth);
    }
    return farthest;
}

glm::vec4 to_vec4(const Eigen::Vector3d& v, double w) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()),
            static_cast<float>(w)};
}

shader::FroxelBlock froxel_block(const std::vector<FroxelFog>& fogs, const int (&size)[3],
                                 const Eigen::Vector3d& fog_colour, const Camera& camera, int width,
                                 int height, double seconds) {
    const auto matrices = camera_matrices(camera, width, height);
    const bool orthographic = camera.projection == Camera::Projection::orthographic;
    const bool reversed = camera.depth == Camera::Depth::reversed;
    const double near_depth = orthographic ? camera.near_plane : 0;
    const double nearest = orthographic ? kNearest : std::max(camera.near_plane, kNearest);
    const double farthest = far_depth(fogs, camera, matrices, near_depth, nearest, seconds);

    const Eigen::Matrix4d& p = matrices.projection;
    const Eigen::Vector3d right = matrices.view.row(0).head<3>().transpose() / p(0, 0);
    const Eigen::Vector3d up = matrices.view.row(1).head<3>().transpose() / p(1, 1);
    const Eigen::Vector3d forward = -matrices.view.row(2).head<3>().transpose();
    shader::FroxelBlock block{};
    if (orthographic) {
        block.start = to_vec4(near_depth * forward - p(0, 3) * right - p(1, 3) * up, 1);
        block.axis = to_vec4(forward, 0);
        block.depths = {0, static_cast<float>(camera.far_plane - camera.near_plane), 0, 0};
    } else {
        block.start = to_vec4(Eigen::Vector3d::Zero(), 0);
        block.axis = to_vec4(forward + p(0, 2) * right + p(1, 2) * up, 1);
        block.depths = {static_cast<float>(1 / camera.near_plane),
                        static_cast<float>(1 / camera.far_plane), 0, 0};
    }
    if (reversed) std::swap(block.depths.x, block.depths.y);
    block.depths.z = static_cast<float>(matrices.sky_depth);
    block.right = to_vec4(right, 0);
    block.up = to_vec4(up, 0);
    const double per_slice = std::log2(farthest / nearest) / size[2];
    block.slices = {static_cast<float>(nearest), static_cast<float>(per_slice),
                    static_cast<float>(nearest * std::exp2(per_slice)),
                    static_cast<float>(sky_limit(camera))};
    block.pixel = {static_cast<float>(1.0 / width), static_cast<float>(1.0 / height), 0, 0};
    block.colour = to_vec4(fog_colour, 1);
    block.size = {size[0], size[1], size[2], 0};
    return block;
}

void bind_texture(const Gl& gl, GLint unit, GLenum target, GLuint texture) {
    gl.ActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
    gl.BindTexture(target, texture);
}

/// Tells a freshly built program its units and blocks.
Result<Program> connect(const Gl& gl, Result<Program> program, bool compute) {
    if (!program) return program;
    connect_inputs(gl, *program, kSamplers, kBlocks);
    if (compute) connect_inputs(gl, *program, kImages, {});
    return program;
}

Texture make_volume(const Gl& gl, GLenum format, const int (&size)[3]) {
    GLuint name = 0;
    gl.GenTextures(1, &name);
    Texture texture(gl, name);
    gl.BindTexture(GL_TEXTURE_3D, name);
    gl.TexStorage3D(GL_TEXTURE_3D, 1, format, size[0], size[1], size[2]);
    for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
        gl.TexParameteri(GL_TEXTURE_3D, filter, GL_LINEAR);
    for (const GLenum wrap : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
        gl.TexParameteri(GL_TEXTURE_3D, wrap, GL_CLAMP_TO_EDGE);
    gl.BindTexture(GL_TEXTURE_3D, 0);
    return texture;
}

}  // namespace

FroxelVolume::FroxelVolume(const Gl& gl, std::vector<FroxelFog> fogs, const Method& method,
                           const Eigen::Vector3d& fog_colour, bool coloured)
    : gl_(&gl),
      fogs_(std::move(fogs)),
      size_{method.froxels[0], method.froxels[1], method.froxels[2]},
      fog_colour_(fog_colour),
      coloured_(coloured) {}

Result<FroxelVolume> FroxelVolume::create(const Gl& gl, std::vector<FroxelFog> fogs,
                                          const Method& method, const Eigen::Vector3d& fog_colour,
                                          bool coloured) {
    if (!has_compute(gl))
        return data_error(method.name() +
                          ": needs compute shaders (OpenGL 4.3), which this context lacks; use "
                          "exact or radial");
    FroxelVolume volume(gl, std::move(fogs), method, fog_colour, coloured);
    if (auto made = volume.make_textures(); !made) return tl::unexpected(made.error());
    if (auto made = volume.make_programs(); !made) return tl::unexpected(made.error());
    volume.fog_uniforms_ =
        make_buffer(gl, GL_UNIFORM_BUFFER, sizeof(shader::FogBlock), nullptr, GL_DYNAMIC_DRAW);
    volume.froxel_uniforms_ =
        make_buffer(gl, GL_UNIFORM_BUFFER, sizeof(shader::FroxelBlock), nullptr, GL_DYNAMIC_DRAW);
    volume.vertices_ = make_vertex_array(gl);
    return volume;
}

std::size_t FroxelVolume::bytes() const {
    const std::size_t texel = (coloured_ ? 4 : 1) * sizeof(float) + 4 * sizeof(std::uint16_t);
    return texel * static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
           static_cast<std::size_t>(size_[2]);
}

Result<void> FroxelVolume::make_textures() {
    GLint largest = 0;
    gl_->GetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &largest);
    if (std::max({size_[0], size_[1], size_[2]}) > largest)
        return data_error(
            fmt::format("froxel:{}x{}x{}: this context's volumes have at most {} texels a side; "
                        "use fewer froxels",
                        size_[0], size_[1], size_[2], largest));
    extinction_ = make_volume(*gl_, extinction_format(), size_);
    volume_ = make_volume(*gl_, GL_RGBA16F, size_);
    if (const GLenum error = gl_->GetError(); error != GL_NO_ERROR)
        return data_error(
            fmt::format("froxel:{}x{}x{}: the context refused a volume of {} bytes (GL error "
                        "0x{:x}); use fewer froxels",
                        size_[0], size_[1], size_[2], bytes(), error));
    return {};
}

Result<void> FroxelVolume::make_programs() {
    for (const auto& fog : fogs_) {
        std::vector<std::string> defines = {
            fmt::format("FOG_DEGREE {}", fog.facts->degree),
            fmt::format("FOG_PROFILE {}", profile_number(fog.facts->profile))};
        if (!density_.empty()) defines.push_back("FROXEL_ADD");
        if (coloured_) defines.push_back("FROXEL_CHANNELS");
        auto program =
            connect(*gl_, build_compute_program(*gl_, "froxel_density.comp", defines), true);
        if (!program) return tl::unexpected(program.error());
        density_.push_back(std::move(*program));
    }
    const std::vector<std::string> channels =
        coloured_ ? std::vector<std::string>{"FROXEL_CHANNELS"} : std::vector<std::string>{};
    const auto apply = [&](std::vector<std::string> defines) {
        defines.insert(defines.end(), channels.begin(), channels.end());
        return connect(
            *gl_, build_program(*gl_, "post_fullscreen.vert", "froxel_apply.frag", defines), false);
    };
    auto integrate =
        connect(*gl_, build_compute_program(*gl_, "froxel_integrate.comp", channels), true);
    auto colour = apply({}), tau = apply({"FROXEL_OUTPUT_TAU"});
    for (auto* program : {&integrate, &colour, &tau})
        if (!*program) return tl::unexpected(program->error());
    integrate_ = std::move(*integrate);
    apply_colour_ = std::move(*colour);
    apply_tau_ = std::move(*tau);
    return {};
}

void FroxelVolume::build(const Camera& camera, double seconds) const {
    const Gl& gl = *gl_;
    const auto groups = [](int count) {
        return static_cast<GLuint>((count + kGroup - 1) / kGroup);
    };
    const GLuint across = groups(size_[0]), up = groups(size_[1]);
    gl.BindImageTexture(kExtinctionImage, extinction_.name(), 0, GL_TRUE, 0, GL_READ_WRITE,
                        extinction_format());
    gl.BindImageTexture(kVolumeImage, volume_.name(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_RGBA16F);
    for (std::size_t i = 0; i < fogs_.size(); ++i) {
        upload_uniforms(gl, fog_uniforms_, kFogBinding,
                        fog_block(*fogs_[i].facts, camera.eye, 1, seconds, sky_limit(camera)));
        bind_texture(gl, kMapUnit, GL_TEXTURE_2D, fogs_[i].map);
        gl.UseProgram(density_[i].name());
        if (coloured_)
            set_uniform(gl, density_[i].name(), "channels",
                        Eigen::Vector3d(fogs_[i].facts->channels.data()));
        // Stores wait for the reads of the frame before and for the fog before.
        gl.MemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
        gl.DispatchCompute(across, up, static_cast<GLuint>(size_[2]));
    }
    gl.UseProgram(integrate_.name());
    gl.MemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
    gl.DispatchCompute(across, up, 1);
    gl.MemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    bind_texture(gl, kMapUnit, GL_TEXTURE_2D, 0);
    gl.BindImageTexture(kExtinctionImage, 0, 0, GL_FALSE, 0, GL_READ_ONLY, extinction_format());
    gl.BindImageTexture(kVolumeImage, 0, 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA16F);
}

void FroxelVolume::draw(const FrameTarget& frame, const Camera& camera, GLuint output,
                        double seconds, bool colour) const {
    const Gl& gl = *gl_;
    upload_uniforms(
        gl, froxel_uniforms_, kFroxelBinding,
        froxel_block(fogs_, size_, fog_colour_, camera, frame.width, frame.height, seconds));
    build(camera, seconds);
    gl.BindFramebuffer(GL_FRAMEBUFFER, output);
    gl.Viewport(0, 0, frame.width, frame.height);
    gl.Disable(GL_DEPTH_TEST);
    gl.Disable(GL_BLEND);
    gl.BindVertexArray(vertices_.name());
    gl.UseProgram((colour ? apply_colour_ : apply_tau_).name());
    bind_texture(gl, kDepthUnit, GL_TEXTURE_2D, frame.depth.name());
    bind_texture(gl, kColourUnit, GL_TEXTURE_2D, frame.colour.name());
    bind_texture(gl, kVolumeUnit, GL_TEXTURE_3D, volume_.name());
    gl.DrawArrays(GL_TRIANGLES, 0, 3);
    bind_texture(gl, kVolumeUnit, GL_TEXTURE_3D, 0);
    bind_texture(gl, kColourUnit, GL_TEXTURE_2D, 0);
    bind_texture(gl, kDepthUnit, GL_TEXTURE_2D, 0);
    gl.BindVertexArray(0);
    gl.UseProgram(0);
}

}  // namespace wavefog
