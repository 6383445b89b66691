// Flags that change what of a scene is drawn, shared by the commands that draw.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "options.h"
#include "wavefog/fogmap/scene.h"

namespace wavefog::cli {

struct SceneOptions {
    std::filesystem::path input;
    std::vector<std::filesystem::path> fogs;
    std::optional<Size> size;
    std::optional<Method> method;
    std::optional<double> mu;
    std::optional<std::string> camera;
    std::string context = "osmesa";
    int supersample = 1;

    /// All files that are read.
    std::vector<std::filesystem::path> inputs() const;
};

/// Adds SCENE and the flags, from --fog to --supersample.
void add_scene_options(CLI::App& app, SceneOptions& options);

/// The input is there and is no fog.
Result<void> check_scene(const SceneOptions& options);

/// The scene as the flags change it.
Result<Scene> load_scene(const SceneOptions& options);

}  // namespace wavefog::cli
