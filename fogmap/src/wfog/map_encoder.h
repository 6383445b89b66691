// A grid of densities as streams that were decoded again and compared.
#pragma once

#include <vector>

#include "format.h"
#include "plane.h"
#include "samples.h"
#include "tile_errors.h"
#include "wavefog/fogmap/wfog.h"

namespace wavefog::wfog {

tl::unexpected<Error> broken_promise();

/// All of a fog that a file's head has, with the scale and the bounds at their defaults.
Head head_of(const Fog& fog);

/// Tiles of a map as integers. What the scale does not have, the check of the decoded bytes finds.
TileSource tiles_of(const Grid<float>& map, const Scale& scale);

/// Encodes a map; the errors are those of its tiles as decoded from the streams. `exact`: they must
/// be the map's own integers. `decoded`: gets the decoded map; or null.
Result<Errors> encode_map(const Grid<float>& map, const Scale& scale, const PlaneCoding& coding,
                          const WfogOptions& options, bool exact, Grid<float>* decoded,
                          PlaneStreams& streams);

}  // namespace wavefog::wfog
