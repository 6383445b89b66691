// Every variant of the fog shader that the GPU can be asked for, compiled as C++.
#include "fog_variants.h"

// A variant need not use every parameter and function that its siblings do.
#pragma GCC diagnostic ignored "-Wunused-parameter"
#pragma GCC diagnostic ignored "-Wunused-function"

namespace wavefog::shader {
namespace {

using Run = float (*)(Evaluation, const Ray&, int);
using Fill = void (*)(int, int);

namespace zero {
#include "fog_variants_all.inc"
}
#define FOG_SKIP
namespace zero_skip {
#include "fog_variants_all.inc"
}
#define FOG_REPEAT
namespace repeat_skip {
#include "fog_variants_all.inc"
}
#undef FOG_SKIP
namespace repeat {
#include "fog_variants_all.inc"
}
#undef FOG_REPEAT

}  // namespace

float evaluate(const Variant& v, Evaluation evaluation, const Ray& ray, int samples) {
    const auto& runs = v.repeat ? (v.skip ? repeat_skip::kRuns : repeat::kRuns)
                                : (v.skip ? zero_skip::kRuns : zero::kRuns);
    return runs[v.degree][v.profile](evaluation, ray, samples);
}

void fill_radial(const Variant& v, int layers) {
    const auto fill = (v.repeat ? repeat::kFills : zero::kFills)[v.degree][v.profile];
    for (int layer = 0; layer < layers; ++layer)
        for (int column = 0; column < radial.size.x; ++column) fill(column, layer);
}

}  // namespace wavefog::shader
