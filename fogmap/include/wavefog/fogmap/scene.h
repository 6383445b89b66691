// Scene files (JSON, strict keys): camera, terrain, meshes, sky and fogs.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "wavefog/fogmap/fog.h"
#include "wavefog/fogmap/fog_file.h"
#include "wavefog/fogmap/image.h"
#include "wavefog/fogmap/map_sequence.h"
#include "wavefog/fogmap/model_motion.h"
#include "wavefog/fogmap/models.h"
#include "wavefog/fogmap/particles.h"
#include "wavefog/wavelet/path_table.h"

namespace wavefog {

/// Depth conventions and projections. Distances in metres.
struct Camera {
    enum class Projection { perspective, orthographic };
    enum class Depth { standard, reversed };
    Projection projection = Projection::perspective;
    Depth depth = Depth::standard;
    Eigen::Vector3d eye{0, 2, 0};
    Eigen::Vector3d target{0, 2, -1};
    Eigen::Vector3d up{0, 1, 0};
    double fov_y_deg = 50;
    double ortho_height = 100;  ///< full height of the view volume, metres
    double near_plane = 0.1;
    double far_plane = 4000;  ///< may be infinity (JSON: "infinite") for perspective
    Eigen::Vector2d lens_shift{
        0, 0};                ///< off-axis: shift of the image plane in units of its half size
    double pixel_aspect = 1;  ///< width of a pixel over its height; files have no key for it
};

/// A further view of a scene, by name.
struct NamedCamera {
    std::string name;
    Camera camera;
};

struct Sun {
    Eigen::Vector3d direction{0.4, 0.8, 0.2};  ///< towards the sun, normalised on load
    Eigen::Vector3d colour{1, 1, 1};
};

struct Terrain {
    std::filesystem::path heightmap;
    Rect rect;
    double height_min = 0,
           height_max = 0;  ///< metres for the picture's 0 and 1 (or its min and max)
};

struct MeshInstance {
    std::filesystem::path file;  ///< glTF (.glb, .gltf) or OBJ
    Eigen::Vector3d translate{0, 0, 0};
    double scale = 1;
    double rotate_y_deg = 0;
    bool on_terrain = false;  ///< translate.y is measured from the terrain
};

/// Ways to evaluate the optical depth of the wavelet fog, and the baselines (design.md section 1).
enum class MethodKind {
    reference,
    exact,
    radial,
    paper,
    paper_scaling,
    march,
    froxel,
    homogeneous
};

/// Where a picture's fog is computed: in every pixel, or cheaper (paper 000, sections 4.1 to 4.3).
struct FogSampling {
    enum class Upsample {
        aware,   ///< the depth in a reduced pixel's middle; bilinear, less where ends lie apart
        average  ///< the mean of the depth buffer over a reduced pixel; bilinear (as published)
    };
    int width = 0, height = 0;  ///< of a reduced picture, at most the picture's own; 0: every pixel
    Upsample upsample = Upsample::aware;
    /// At the vertices of terrain and meshes, interpolated between them; in the sky's every pixel.
    bool vertices = false;

    bool every_pixel() const { return width == 0 && !vertices; }
    std::string name() const;  ///< "256x256:average", "vertices"; empty: every pixel
};

struct Method {
    MethodKind kind = MethodKind::exact;
    int samples = 32;  ///< march:N
    /// paper[:N[:perimeter]], paper-scaling[:N[:perimeter]]: samples an edge of the path-integral
    /// tables; 0: 2 for degree 0 and 1 (exact), 32 for degree 2.
    int table = 0;
    PathLayout layout = PathLayout::mean;
    int froxels[3] = {160, 90, 64};  ///< froxel:XxYxZ
    int radial[2] = {0, 0};          ///< radial[:AZIMUTHSxROWS]; 0: chosen for fog and picture
    bool radial_step = false;        ///< radial[:AZIMUTHSxROWS]:step: exact between rows
    double mu = 1;                   ///< [0,1], paper 004 eq. 12
    FogSampling sampling = {};       ///< @WxH[:average], @vertices
    std::string name() const;
};
/// Parses the names of design.md section 4 (march:N, froxel:XxYxZ, paper:N:perimeter, ...), each
/// with
/// "@" and a sampling or without; a usage error lists them.
Result<Method> parse_method(const std::string& text);
/// A usage error if the method cannot be sampled as it asks for.
Result<void> check_sampling(const Method& method);

struct Scene {
    int width = 800, height = 600;
    Camera camera;
    std::vector<NamedCamera> cameras;      ///< further ones, their names differ
    Eigen::Vector3d sky{0.55, 0.65, 0.8};  ///< linear colour
    Sun sun;
    std::optional<Terrain> terrain;
    std::vector<MeshInstance> meshes;
    Eigen::Vector3d fog_colour{0.8, 0.82, 0.85};
    std::vector<Fog> fogs;         ///< maps: "model": "wavelet"
    std::vector<FogModel> models;  ///< formulas, in closed form whatever the method; at time 0
    std::vector<ModelMotion> model_motions;  ///< of `models`, in their order
    std::vector<MapSequence> sequences;      ///< which `fogs` have a map that changes
    std::vector<ParticleSource> particles;
    Method method;
};

/// Reads a scene and every fog in it; paths are relative to the scene file. Keys as in the fields
/// above, the camera's planes "near" and "far", for `cameras` those of the camera and "name";
/// `camera.eye` and `camera.target` are required, and with a fog's "image" also "rect" and
/// "extinction" (a fog "file" carries its own, which the scene may replace). Data errors name the
/// key ("scene.json: fog[0].height.scale: ...") or the line.
Result<Scene> load_scene(const std::filesystem::path& file);

/// The camera of `scene.cameras` with that name; a usage error lists the names there are.
Result<Camera> find_camera(const Scene& scene, const std::string& name);

/// Whether some fog is not seen by all colours alike.
bool coloured(const std::vector<Fog>& fogs, const std::vector<FogModel>& models,
              const std::vector<Channels>& particles = {});

/// What a scene's "fog" holds: all of it adds up.
struct SceneFogs {
    std::vector<Fog> fogs;
    std::vector<FogModel> models;
    std::vector<ModelMotion> model_motions;
    std::vector<MapSequence> sequences;
    std::vector<ParticleSource> particles;
    std::optional<Terrain> terrain;  ///< it and `meshes` are what the particles meet
    std::vector<MeshInstance> meshes;
};

/// A source of particles from JSON text, with the keys that it has in a scene. Data errors name
/// `place` and the key ("particles: rate is -1; ...").
Result<ParticleSource> parse_particles(const std::string& json, const std::string& place);

/// The fogs of a file that may be a scene, a fog file or an image (taken with make_fog's defaults
/// and an extinction of 1/m). `notes` as for load_fog().
Result<SceneFogs> load_fogs(const std::filesystem::path& file, LoadNotes* notes = nullptr);

}  // namespace wavefog
