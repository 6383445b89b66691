// The shadows that meshes throw: a depth map seen from the sun, drawn once for a static scene.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "wavefog/gpu/objects.h"

namespace wavefog {

/// Instance attributes of scene_mesh.vert.
struct InstanceData {
    float placement[4];  ///< metres from the scene's origin; scale
    float turn[3];       ///< cos and sin of the turn about y; visible part of the sun
};

struct MeshOnGpu {
    VertexArray array;
    Buffer vertices, indices, instances;
    GLsizei count = 0, instance_count = 0;
    double longest_edge = 0;  ///< of a triangle, the mesh's units

    void draw(const Gl& gl) const {
        gl.BindVertexArray(array.name());
        gl.DrawElementsInstanced(GL_TRIANGLES, count, GL_UNSIGNED_INT, nullptr, instance_count);
    }
};

struct SunShadow {
    Texture depth;     ///< DEPTH_COMPONENT32F with comparison; empty: no shadows
    double texel = 0;  ///< metres
    /// Metres from the scene's origin -> shadow map, all in [0,1].
    Eigen::Matrix4d map_from_origin = Eigen::Matrix4d::Identity();
};

/// `bounds` holds all instances, metres from the scene's origin.
Result<SunShadow> draw_sun_shadow(const Gl& gl, const std::vector<MeshOnGpu>& meshes,
                                  const Eigen::AlignedBox3d& bounds, const Eigen::Vector3d& to_sun);

}  // namespace wavefog
