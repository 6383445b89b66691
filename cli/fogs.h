// The fogs that a command is given: those of --fog, and all that a file holds at a time.
#pragma once

#include <filesystem>
#include <vector>

#include "wavefog/fogmap/scene.h"

namespace wavefog::cli {

/// Puts the fogs of these files (fog files, scenes, pictures) in place of the scene's own, if there
/// are any files; warns of those that end early.
Result<void> replace_fogs(const std::vector<std::filesystem::path>& files, Scene& scene);

/// A scene whose transmittance is one number a pixel: a data error if a fog has channels.
Result<Scene> load_grey_scene(const std::filesystem::path& file);

/// The fogs of a file at a time: maps that change show their picture, formulas stand where wind has
/// taken them, particles have met the scene's ground and meshes.
struct FogsAt {
    double seconds = 0;
    std::vector<Fog> fogs;  ///< their own wind has still to move them: Reference(fog, seconds)
    std::vector<FogModel> models;
    std::vector<Particle> particles;
    std::optional<Terrain> terrain;

    bool coloured() const { return wavefog::coloured(fogs, models, channels_of(particles)); }
};

/// The particles of sources at a time, where ground and meshes have stopped them.
Result<std::vector<Particle>> particles_at(const std::vector<ParticleSource>& sources,
                                           const std::optional<Terrain>& terrain,
                                           const std::vector<MeshInstance>& meshes, double seconds);

/// Of a scene, a fog file or a picture; warns of one that ends early.
Result<FogsAt> load_fogs_at(const std::filesystem::path& file, double seconds);

/// The same of fogs that are loaded.
Result<FogsAt> fogs_at(SceneFogs fogs, double seconds);

}  // namespace wavefog::cli
