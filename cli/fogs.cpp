#include "fogs.h"

#include <algorithm>
#include <iterator>

#include "files.h"
#include "report.h"
#include "wavefog/gpu/obstacles.h"

namespace wavefog::cli {
namespace {

Result<SceneFogs> load_and_warn(const std::filesystem::path& file) {
    if (auto ok = check_input(file); !ok) return tl::unexpected(ok.error());
    LoadNotes notes;
    Result<SceneFogs> loaded = load_fogs(file, &notes);
    if (loaded && !notes.warning.empty()) warn(notes.warning);
    return loaded;
}

template <class T>
void append(std::vector<T>& to, std::vector<T>& from) {
    std::move(from.begin(), from.end(), std::back_inserter(to));
}

}  // namespace

Result<void> replace_fogs(const std::vector<std::filesystem::path>& files, Scene& scene) {
    if (!files.empty()) {
        scene.fogs.clear();
        scene.models.clear();
        scene.model_motions.clear();
        scene.sequences.clear();
        scene.particles.clear();
    }
    for (const std::filesystem::path& file : files) {
        Result<SceneFogs> loaded = load_and_warn(file);
        if (!loaded) return tl::unexpected(loaded.error());
        for (MapSequence& sequence : loaded->sequences) sequence.fog += scene.fogs.size();
        append(scene.sequences, loaded->sequences);
        append(scene.particles, loaded->particles);
        append(scene.fogs, loaded->fogs);
        append(scene.models, loaded->models);
        append(scene.model_motions, loaded->model_motions);
    }
    return {};
}

Result<Scene> load_grey_scene(const std::filesystem::path& file) {
    Result<Scene> scene = load_scene(file);
    if (scene && coloured(scene->fogs, scene->models, channels_of(scene->particles)))
        return data_error(file.string() +
                          ": a fog has \"channels\", and errors are measured for one colour; "
                          "remove the key to measure");
    return scene;
}

Result<std::vector<Particle>> particles_at(const std::vector<ParticleSource>& sources,
                                           const std::optional<Terrain>& terrain,
                                           const std::vector<MeshInstance>& meshes,
                                           double seconds) {
    if (sources.empty()) return std::vector<Particle>{};
    auto obstacles = scene_obstacles(terrain, meshes);
    if (!obstacles) return tl::unexpected(obstacles.error());
    return ParticleSystem(sources, *std::move(obstacles)).at(seconds);
}

Result<FogsAt> fogs_at(SceneFogs loaded, double seconds) {
    for (const MapSequence& sequence : loaded.sequences)
        if (auto ok = SequencePlayer(sequence).show(seconds, loaded.fogs[sequence.fog]); !ok)
            return tl::unexpected(ok.error());
    FogsAt fogs{seconds,
                std::move(loaded.fogs),
                models_at(std::move(loaded.models), loaded.model_motions, seconds),
                {},
                std::move(loaded.terrain)};
    auto particles = particles_at(loaded.particles, fogs.terrain, loaded.meshes, seconds);
    if (!particles) return tl::unexpected(particles.error());
    fogs.particles = *std::move(particles);
    return fogs;
}

Result<FogsAt> load_fogs_at(const std::filesystem::path& file, double seconds) {
    Result<SceneFogs> loaded = load_and_warn(file);
    if (!loaded) return tl::unexpected(loaded.error());
    return fogs_at(*std::move(loaded), seconds);
}

}  // namespace wavefog::cli
