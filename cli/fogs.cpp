#include "fogs.h"

#include <algorithm>
#include <iterator>

#include "files.h"
#include "report.h"

namespace wavefog::cli {

Result<void> replace_fogs(const std::vector<std::filesystem::path>& files, Scene& scene) {
    if (!files.empty()) {
        scene.fogs.clear();
        scene.models.clear();
        scene.model_winds.clear();
    }
    for (const std::filesystem::path& file : files) {
        if (auto ok = check_input(file); !ok) return ok;
        LoadNotes notes;
        Result<SceneFogs> loaded = load_fogs(file, &notes);
        if (!loaded) return tl::unexpected(loaded.error());
        if (!notes.warning.empty()) warn(notes.warning);
        std::move(loaded->fogs.begin(), loaded->fogs.end(), std::back_inserter(scene.fogs));
        std::move(loaded->models.begin(), loaded->models.end(), std::back_inserter(scene.models));
        std::move(loaded->model_winds.begin(), loaded->model_winds.end(),
                  std::back_inserter(scene.model_winds));
    }
    return {};
}

Result<Scene> load_grey_scene(const std::filesystem::path& file) {
    Result<Scene> scene = load_scene(file);
    if (scene && coloured(scene->fogs, scene->models))
        return data_error(file.string() +
                          ": a fog has \"channels\", and errors are measured for one colour; "
                          "remove the key to measure");
    return scene;
}

}  // namespace wavefog::cli
