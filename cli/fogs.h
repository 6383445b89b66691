// The fogs that --fog names.
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

}  // namespace wavefog::cli
