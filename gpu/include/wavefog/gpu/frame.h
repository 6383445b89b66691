// A rendered scene that the fog pass reads: linear colour and 32-bit float depth.
#pragma once

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

FrameTarget make_frame_target(const Gl& gl, int width, int height);

/// Camera matrices in double. Clip depth is mapped to [0,1] with glClipControl(GL_LOWER_LEFT,
/// GL_ZERO_TO_ONE), so `depth` textures hold clip z / w; reversed and infinite planes keep precision.
struct CameraMatrices {
    Eigen::Matrix4d view;        ///< world -> view, view looks along -z
    Eigen::Matrix4d projection;  ///< view -> clip, z in [0,1]
    double sky_depth = 1;        ///< depth of the cleared background: 1, or 0 when reversed
};
CameraMatrices camera_matrices(const Camera& camera, int width, int height);

/// Draws terrain, meshes and sky of a scene.
class SceneRenderer {
  public:
    static Result<SceneRenderer> create(const Gl& gl, const Scene& scene);
    SceneRenderer(SceneRenderer&&) noexcept;
    SceneRenderer& operator=(SceneRenderer&&) noexcept;
    ~SceneRenderer();

    void draw(const FrameTarget& target, const Camera& camera) const;

  private:
    struct Impl;
    explicit SceneRenderer(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// Reads a texture back, row 0 at the top. `channels` 1 or 4; depth textures give 1.
Image read_texture(const Gl& gl, GLuint texture, int width, int height, int channels, bool depth = false);

}  // namespace wavefog
