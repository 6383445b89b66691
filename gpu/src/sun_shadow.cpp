#include "sun_shadow.h"

#include <algorithm>

#include "wavefog/gpu/uniforms.h"

namespace wavefog {

Result<SunShadow> draw_sun_shadow(const Gl& gl, const std::vector<MeshOnGpu>& meshes,
                                  const Eigen::AlignedBox3d& bounds,
                                  const Eigen::Vector3d& to_sun) {
    constexpr int size = 4096;
    constexpr double margin = 8;  // texels that stay empty, wider than the filter

    // Axes of the map: two across the light, one along it.
    Eigen::Matrix3d axes;
    const Eigen::Vector3d across = to_sun.unitOrthogonal();
    axes.row(0) = across;
    axes.row(1) = to_sun.cross(across);
    axes.row(2) = -to_sun;
    Eigen::AlignedBox3d box;
    for (int corner = 0; corner < 8; ++corner)
        box.extend(axes * bounds.corner(Eigen::AlignedBox3d::CornerType(corner)));
    const double side = std::max({box.sizes().x(), box.sizes().y(), 1e-3});

    SunShadow shadow;
    shadow.texel = side / (size - 2 * margin);
    const double width = shadow.texel * size;
    // The ground below the meshes may lie beyond the box's far face; it is lit by what is nearer,
    // so the map reaches twice as deep.
    const double depth = std::max(2 * box.sizes().z(), 1e-3) + width;
    const double near = box.min().z() - 2 * shadow.texel;
    Eigen::Matrix4d& map = shadow.map_from_origin;
    map.setIdentity();
    map.row(0).head<3>() = axes.row(0) / width;
    map.row(1).head<3>() = axes.row(1) / width;
    map.row(2).head<3>() = axes.row(2) / depth;
    map(0, 3) = 0.5 - box.center().x() / width;
    map(1, 3) = 0.5 - box.center().y() / width;
    map(2, 3) = -near / depth;
    Eigen::Matrix4d clip = Eigen::Matrix4d::Identity();  // [0,1] -> clip x and y in [-1,1]
    clip(0, 0) = clip(1, 1) = 2;
    clip(0, 3) = clip(1, 3) = -1;

    shadow.depth = make_texture_2d(gl, GL_DEPTH_COMPONENT32F, size, size, GL_DEPTH_COMPONENT,
                                   GL_FLOAT, nullptr);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL);
    auto framebuffer = make_framebuffer(gl, 0, shadow.depth.name());
    if (!framebuffer) return tl::unexpected(framebuffer.error());
    auto program = build_program(gl, "scene_mesh.vert", "scene_mesh.frag", {"SHADOW"});
    if (!program) return tl::unexpected(program.error());

    gl.BindFramebuffer(GL_FRAMEBUFFER, framebuffer->name());
    gl.Viewport(0, 0, size, size);
    gl.ClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    gl.Disable(GL_CULL_FACE);
    gl.Disable(GL_SCISSOR_TEST);
    gl.Enable(GL_DEPTH_TEST);
    gl.DepthMask(GL_TRUE);
    gl.DepthFunc(GL_LESS);
    gl.ClearDepth(1);
    gl.Clear(GL_DEPTH_BUFFER_BIT);
    gl.UseProgram(program->name());
    set_uniform(gl, program->name(), "clip_from_eye", Eigen::Matrix4d(clip * map));
    set_uniform(gl, program->name(), "origin_from_eye", Eigen::Vector3d(0, 0, 0));
    for (const MeshOnGpu& mesh : meshes) mesh.draw(gl);
    gl.BindVertexArray(0);
    gl.BindFramebuffer(GL_FRAMEBUFFER, 0);
    return shadow;
}

}  // namespace wavefog
