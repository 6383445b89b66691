// Fogs given by formulas, from a scene file.
#pragma once

#include "json_reader.h"
#include "wavefog/fogmap/models.h"

namespace wavefog::detail {

/// [red, green, blue], unchecked.
Channels read_channels(const JsonValue& value);

/// A fog entry whose "model" is not "wavelet"; throws JsonFailure.
FogModel read_model(const JsonValue& value);

}  // namespace wavefog::detail
