// Method froxel:XxYxZ: the camera-aligned volume that engines ship, as a baseline to compare with.
#pragma once

#include "fog_uniforms.h"
#include "wavefog/gpu/fog_pass.h"

namespace wavefog {

/// One fog as the volume samples it; both are the FogTextures' own.
struct FroxelFog {
    const FogFacts* facts = nullptr;
    GLuint map = 0;
};

/// X x Y tiles of the screen times Z slices of view depth. Each frame, one sample of every fog at
/// each froxel's centre, an integral front to back along every column, and one trilinear look-up a
/// pixel (Wronski, "Volumetric Fog", SIGGRAPH 2014; per-slice integral of Hillaire, "Physically
/// Based and Unified Volumetric Rendering in Frostbite", SIGGRAPH 2015).
///
/// Slices are exponential from max(camera.near, 0.5 m) to where the fog ends inside the view, or to
/// the longest sky ray (the far plane, 1000 km without one) if that is nearer. The first slice
/// begins at the eye. An orthographic camera counts depth from its near plane, slices from 0.5 m.
///
/// What is not here: engines jitter the samples and blend them over frames. This is the error of
/// one still frame, as a fast camera or a cut shows it: banks thinner than a froxel are missed or
/// doubled, edges follow the tiles. The rule of mu does not apply.
class FroxelVolume {
  public:
    /// At least one fog. `coloured`: their channels count. A data error says when the context
    /// cannot hold the volume.
    static Result<FroxelVolume> create(const Gl& gl, std::vector<FroxelFog> fogs,
                                       const Method& method, const Eigen::Vector3d& fog_colour,
                                       bool coloured);

    /// Builds the volume for this camera, then draws the frame with it into `output`: colour, or
    /// the optical depth -log(T), at most 16.7 because T is stored as half floats; if coloured that
    /// of red, green and blue.
    void draw(const FrameTarget& frame, const Camera& camera, GLuint output, double seconds,
              bool colour) const;

    std::size_t bytes() const;  ///< of the volume's textures

  private:
    FroxelVolume(const Gl& gl, std::vector<FroxelFog> fogs, const Method& method,
                 const Eigen::Vector3d& fog_colour, bool coloured);
    Result<void> make_programs();
    Result<void> make_textures();
    void build(const Camera& camera, double seconds) const;
    GLenum extinction_format() const { return coloured_ ? GL_RGBA32F : GL_R32F; }

    const Gl* gl_;
    std::vector<FroxelFog> fogs_;
    int size_[3];
    Eigen::Vector3d fog_colour_;
    bool coloured_;
    std::vector<Program> density_;  ///< one a fog
    Program integrate_, apply_colour_, apply_tau_;
    Texture extinction_;  ///< R32F, coloured RGBA32F, 1/m
    Texture volume_;  ///< RGBA16F, in-scattered light and transmittance, coloured three of these
    Buffer fog_uniforms_, froxel_uniforms_;
    VertexArray vertices_;
};

}  // namespace wavefog
