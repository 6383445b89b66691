// Every variant of the fog shader that the GPU can be asked for, compiled as C++.
#include "fog_variants.h"

#include <array>

namespace wavefog::shader {
namespace {

// Names of FOG_PROFILE stand in fog_ray.glsl: uniform 0, slab 1, exponential 2, linear 3.
#define FOG_DEGREE 0
#define FOG_PROFILE 0
#define WAVEFOG_VARIANT v000
#include "fog_variant.inc"
#define FOG_DEGREE 0
#define FOG_PROFILE 1
#define WAVEFOG_VARIANT v010
#include "fog_variant.inc"
#define FOG_DEGREE 0
#define FOG_PROFILE 2
#define WAVEFOG_VARIANT v020
#include "fog_variant.inc"
#define FOG_DEGREE 0
#define FOG_PROFILE 3
#define WAVEFOG_VARIANT v030
#include "fog_variant.inc"
#define FOG_DEGREE 1
#define FOG_PROFILE 0
#define WAVEFOG_VARIANT v100
#include "fog_variant.inc"
#define FOG_DEGREE 1
#define FOG_PROFILE 1
#define WAVEFOG_VARIANT v110
#include "fog_variant.inc"
#define FOG_DEGREE 1
#define FOG_PROFILE 2
#define WAVEFOG_VARIANT v120
#include "fog_variant.inc"
#define FOG_DEGREE 1
#define FOG_PROFILE 3
#define WAVEFOG_VARIANT v130
#include "fog_variant.inc"
#define FOG_DEGREE 2
#define FOG_PROFILE 0
#define WAVEFOG_VARIANT v200
#include "fog_variant.inc"
#define FOG_DEGREE 2
#define FOG_PROFILE 1
#define WAVEFOG_VARIANT v210
#include "fog_variant.inc"
#define FOG_DEGREE 2
#define FOG_PROFILE 2
#define WAVEFOG_VARIANT v220
#include "fog_variant.inc"
#define FOG_DEGREE 2
#define FOG_PROFILE 3
#define WAVEFOG_VARIANT v230
#include "fog_variant.inc"
#define FOG_REPEAT
#define FOG_DEGREE 0
#define FOG_PROFILE 0
#define WAVEFOG_VARIANT v001
#include "fog_variant.inc"
#define FOG_DEGREE 0
#define FOG_PROFILE 1
#define WAVEFOG_VARIANT v011
#include "fog_variant.inc"
#define FOG_DEGREE 0
#define FOG_PROFILE 2
#define WAVEFOG_VARIANT v021
#include "fog_variant.inc"
#define FOG_DEGREE 0
#define FOG_PROFILE 3
#define WAVEFOG_VARIANT v031
#include "fog_variant.inc"
#define FOG_DEGREE 1
#define FOG_PROFILE 0
#define WAVEFOG_VARIANT v101
#include "fog_variant.inc"
#define FOG_DEGREE 1
#define FOG_PROFILE 1
#define WAVEFOG_VARIANT v111
#include "fog_variant.inc"
#define FOG_DEGREE 1
#define FOG_PROFILE 2
#define WAVEFOG_VARIANT v121
#include "fog_variant.inc"
#define FOG_DEGREE 1
#define FOG_PROFILE 3
#define WAVEFOG_VARIANT v131
#include "fog_variant.inc"
#define FOG_DEGREE 2
#define FOG_PROFILE 0
#define WAVEFOG_VARIANT v201
#include "fog_variant.inc"
#define FOG_DEGREE 2
#define FOG_PROFILE 1
#define WAVEFOG_VARIANT v211
#include "fog_variant.inc"
#define FOG_DEGREE 2
#define FOG_PROFILE 2
#define WAVEFOG_VARIANT v221
#include "fog_variant.inc"
#define FOG_DEGREE 2
#define FOG_PROFILE 3
#define WAVEFOG_VARIANT v231
#include "fog_variant.inc"
#undef FOG_REPEAT

using Run = float (*)(Evaluation, const Ray&, int);
constexpr std::array<std::array<std::array<Run, 2>, 4>, 3> kRuns = {{
    {{{{v000::run, v001::run}},
      {{v010::run, v011::run}},
      {{v020::run, v021::run}},
      {{v030::run, v031::run}}}},
    {{{{v100::run, v101::run}},
      {{v110::run, v111::run}},
      {{v120::run, v121::run}},
      {{v130::run, v131::run}}}},
    {{{{v200::run, v201::run}},
      {{v210::run, v211::run}},
      {{v220::run, v221::run}},
      {{v230::run, v231::run}}}},
}};

}  // namespace

float evaluate(int degree, int profile, bool repeat, Evaluation evaluation, const Ray& ray,
               int samples) {
    return kRuns[static_cast<std::size_t>(degree)][static_cast<std::size_t>(profile)]
                [repeat ? 1 : 0](evaluation, ray, samples);
}

}  // namespace wavefog::shader
