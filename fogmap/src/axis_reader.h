// Functions of one coordinate, from a scene file.
#pragma once

#include "json_reader.h"
#include "wavefog/fogmap/models.h"

namespace wavefog::detail {

/// {"values": [...], "begin", "end", "outside"}, or a function that is tabulated here: {"noise":
/// {...}, "begin", "end"}, {"cosine": share, "begin", "end"}, {"exponential": scale, "begin"}.
/// Throws JsonFailure; what validate() looks at is left to it.
AxisTable read_axis(const JsonValue& value);

}  // namespace wavefog::detail
