// A rendered scene that the fog pass reads: linear colour and 32-bit float depth.
#pragma once

#include <memory>
#include <vector>

#include "wavefog/fogmap/image.h"
#include "wavefog/fogmap/scene.h"
#include "wavefog/gpu/objects.h"

namespace wavefog {

/// Colour (RGBA16F) and depth (DEPTH_COMPONENT32F) of one frame.
struct FrameTarget {
    int width = 0, height = 0;
    Texture colour;
    Texture depth;
    Framebuffer framebuffer;
};

/// `framebuffer` is empty if the driver cannot hold the size (GL_MAX_TEXTURE_SIZE, memory).
FrameTarget make_frame_target(const Gl& gl, int width, int height);

/// Camera matrices in double. Clip depth is mapped to [0,1] with glClipControl(GL_LOWER_LEFT,
/// GL_ZERO_TO_ONE), so `depth` textures hold clip z / w; reversed and infinite planes keep
/// precision.
struct CameraMatrices {
    Eigen::Matrix4d view;        ///< world -> view, view looks along -z
    Eigen::Matrix4d projection;  ///< view -> clip, z in [0,1]
    double sky_depth = 1;        ///< depth of the cleared background: 1, or 0 when reversed
};
CameraMatrices camera_matrices(const Camera& camera, int width, int height);

/// Draws terrain, meshes and sky of a scene with its sun, all static: what does not depend on the
/// camera (smooth normals, ambient occlusion, sun visibility, shadow map) is computed once.
/// World coordinates may be large: the eye is subtracted in double before anything is a float.
class SceneRenderer {
  public:
    /// A data error names the height map or mesh file that cannot be read.
    static Result<SceneRenderer> create(const Gl& gl, const Scene& scene);
    SceneRenderer(SceneRenderer&&) noexcept;
    SceneRenderer& operator=(SceneRenderer&&) noexcept;
    ~SceneRenderer();

    /// Sets the viewport, depth and clip-control state that it needs; leaves `target` bound.
    void draw(const FrameTarget& target, const Camera& camera) const;

    /// Draws terrain and meshes alone into the bound framebuffer of `width` x `height` pixels,
    /// whose depth is cleared, with programs of the caller's vertex shader
    /// (shaders/fog_vertex.vert). Leaves the depth test off.
    void draw_vertices(const Camera& camera, int width, int height, GLuint terrain_program,
                       GLuint mesh_program) const;

  private:
    struct Impl;
    explicit SceneRenderer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// Reads a texture back, row 0 at the top. `channels` 1 or 4; depth textures give 1.
Image read_texture(const Gl& gl, GLuint texture, int width, int height, int channels,
                   bool depth = false);

}  // namespace wavefog
