// Sources of particles, from a scene file.
#pragma once

#include "json_reader.h"
#include "wavefog/fogmap/particles.h"

namespace wavefog::detail {

/// A fog entry whose "model" is "particles"; throws JsonFailure.
ParticleSource read_particles(const JsonValue& value);

}  // namespace wavefog::detail
