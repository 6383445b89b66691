// The fog shader's maths in C++, one function a (basis, profile, wrap) variant.
#pragma once

#include "glsl_in_cpp.h"

namespace wavefog::shader {

/// A FogRay (shaders/fog_ray.glsl) without the variant's namespace.
struct Ray {
    vec2 origin{0}, slope{0};
    float eta = 0, rise = 0, metres = 0, passed = 0, last = 1;
};

enum class Evaluation {
    exact,
    march,
    homogeneous,
    paper,
    paper_scaling,
    radial,
    radial_layered,
    radial_step,
    radial_layered_step
};

/// The shader's defines: FOG_DEGREE, FOG_PROFILE, FOG_REPEAT, FOG_SKIP.
struct Variant {
    int degree = 0;
    int profile = 0;
    bool repeat = false;
    bool skip = false;
};

/// Optical depth of the ray with the uniforms of this thread.
float evaluate(const Variant& variant, Evaluation evaluation, const Ray& ray, int samples);

/// Fills radial_image, `layers` tables one below the other. Not for a variant with `skip`.
void fill_radial(const Variant& variant, int layers);

}  // namespace wavefog::shader
