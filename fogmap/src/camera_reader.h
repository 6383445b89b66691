// Cameras, from scene and camera files.
#pragma once

#include <initializer_list>
#include <string_view>

#include "json_reader.h"
#include "wavefog/fogmap/scene.h"

namespace wavefog::detail {

/// An object with the keys of Camera's fields ("near", "far" for the planes) and `more` of the
/// caller's. Throws JsonFailure.
Camera read_camera(const JsonValue& value, std::initializer_list<std::string_view> more = {});

}  // namespace wavefog::detail
