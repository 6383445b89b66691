// One setting of a scene's fogs: map size, basis, family, form, levels.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "wavefog/fogmap/scene.h"

namespace wavefog::cli {

/// A scene as it was loaded, with the names that its rows carry.
struct BenchScene {
    std::string name;                    ///< of the file, without ".json"
    std::vector<std::string> map_names;  ///< of each map's picture, without its folder
    Scene scene;
    std::vector<Particle> particles;  ///< at time 0, when scenes are measured
};

Result<BenchScene> load_bench_scene(const std::filesystem::path& file);

/// What a variant changes of the scene's fogs; empty: as in the scene.
struct VariantOptions {
    std::optional<int> degree;
    std::optional<int> levels;
    std::optional<Form> form;
    std::optional<std::string> family;  ///< "": the basis's default
    std::optional<int> map_size;        ///< the first fog alone, by sized_map()
    std::optional<Profile> profile;
};

struct Variant {
    std::string map, basis, family, form;
    int map_width = 0, map_height = 0, levels = 0;
    std::vector<Fog> fogs;
    /// Equal for variants of a scene that have the same finest map and basis: the same truth.
    std::string truth_key;
};

/// Groups share it: maps are large.
Result<std::shared_ptr<const Variant>> make_variant(const BenchScene& scene,
                                                    const VariantOptions& options);

/// The variant's fogs without decomposition: what the truth is taken from.
Result<std::vector<Fog>> undecomposed(const std::vector<Fog>& fogs);

/// Mean of the map over each of width x height equal rectangles.
Grid<float> area_average(const Grid<float>& map, int width, int height);

/// The map at n x n pixels: averaged where it has more, mirrored at its edges where it has fewer,
/// so that its finest detail stays as rough as it is.
Grid<float> sized_map(const Grid<float>& map, int n);

}  // namespace wavefog::cli
