// Fogs given by formulas, from a scene file.
#pragma once

#include "json_reader.h"
#include "wavefog/fogmap/model_motion.h"

namespace wavefog::detail {

/// [red, green, blue], unchecked.
Channels read_channels(const JsonValue& value);

/// A fog entry whose "model" is neither "wavelet" nor "particles"; throws JsonFailure.
FogModel read_model(const JsonValue& value);

/// Its "wind", and if it has "shapes" all of these in place of one.
ModelMotion read_motion(const JsonValue& value);

}  // namespace wavefog::detail
