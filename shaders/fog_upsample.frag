// Fog of a reduced picture, brought to full resolution and blended with the scene.
// Defines: FOG_UPSAMPLE, one of the three below; FOG_CHANNELS, FOG_OUTPUT_TAU: fog_blend.glsl.
// In: reduced_tau, optical depth of the reduced pixels, and reduced_depth, where their rays end (values
// of the depth buffer, as scene_depth).
precision highp float;
precision highp int;
precision highp sampler2D;

#define FOG_UPSAMPLE_NONE 0     // reduced_tau is as large as the picture
#define FOG_UPSAMPLE_AVERAGE 1  // bilinear
#define FOG_UPSAMPLE_AWARE 2    // bilinear, less where a reduced pixel lies at another distance

#include "fog_blend.glsl"

uniform sampler2D reduced_tau;
uniform sampler2D reduced_depth;
uniform sampler2D scene_depth;
uniform vec2 reduced_pixel;  // pixels across and up one reduced pixel
uniform vec3 nearness_at;    // 1 / (distance along the view axis) at depth 0 and at depth 1, z: 1; or
                             // without perspective the distance itself, z: 0
uniform float sky_depth;
uniform vec3 fog_colour;

layout(location = 0) out vec4 result;

#if FOG_UPSAMPLE == FOG_UPSAMPLE_AWARE
// Ends farther apart than this share of their distance are two surfaces.
#define FOG_OTHER_SURFACE 0.1f

// Sky ends at most here, 1/m.
#define FOG_LEAST_NEARNESS 1e-6f

float nearness_of(float depth) {
    float nearness = nearness_at.x * (1.0f - depth) + nearness_at.y * depth;
    return max(nearness, FOG_LEAST_NEARNESS);
}

// How much the ends of two rays lie apart, 0 to 1: relative to the farther one. Nothing is like the sky
// but the sky.
float fog_apart(float depth, float other) {
    float a = nearness_of(depth);
    float b = nearness_of(other);
    return (depth == sky_depth) == (other == sky_depth) ? abs(a - b) / max(a, b) : 1.0f;
}

// The optical depth of a pixel by that of a reduced one: of equal mean extinction. Farther rays seldom
// stay in the fog of the nearer, and the sky's have most of theirs at their beginning.
FOG_TAU continued(ivec2 reduced, float depth, float other) {
    float ratio = nearness_of(other) / nearness_of(depth);
    ratio = nearness_at.z > 0.0f ? ratio : 1.0f / ratio;
    ratio = clamp(ratio, other == sky_depth ? 0.5f : 0.0f, 2.0f);
    return ratio * fog_texel_tau(texelFetch(reduced_tau, reduced, 0));
}

// Bilinear weights of the four reduced pixels around, divided by how far apart the ends lie (a joint
// bilateral filter). Where all four show other surfaces: of the sixteen around, the nearest in depth.
FOG_TAU upsampled(vec2 at, float depth) {
    ivec2 last = textureSize(reduced_tau, 0) - 1;
    vec2 place = at / reduced_pixel - 0.5f;
    ivec2 low = clamp(ivec2(floor(place)), ivec2(0), last);
    vec2 part = clamp(place - vec2(low), 0.0f, 1.0f);
    FOG_TAU sum = FOG_TAU(0.0f);
    float weights = 0.0f;
    float least = 1.0f;
    for (int k = 0; k < 4; ++k) {
        ivec2 corner = ivec2(k & 1, k >> 1);
        ivec2 reduced = min(low + corner, last);
        vec2 beside = vec2(1 - corner) + vec2(2 * corner - 1) * part;
        float other = texelFetch(reduced_depth, reduced, 0).x;
        float difference = fog_apart(depth, other);
        float weight = (beside.x * beside.y + 1e-3f) / (difference * difference + 1e-4f);
        sum += weight * continued(reduced, depth, other);
        weights += weight;
        least = min(least, difference);
    }
    if (least <= FOG_OTHER_SURFACE) {
        return sum / weights;
    }
    ivec2 nearest = low;
    for (int k = 0; k < 16; ++k) {
        ivec2 reduced = clamp(low + ivec2(k & 3, k >> 2) - 1, ivec2(0), last);
        float difference = fog_apart(depth, texelFetch(reduced_depth, reduced, 0).x);
        nearest = difference < least ? reduced : nearest;
        least = min(least, difference);
    }
    return continued(nearest, depth, texelFetch(reduced_depth, nearest, 0).x);
}
#endif

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
#if FOG_UPSAMPLE == FOG_UPSAMPLE_NONE
    FOG_TAU tau = fog_texel_tau(texelFetch(reduced_tau, pixel, 0));
#elif FOG_UPSAMPLE == FOG_UPSAMPLE_AVERAGE
    vec2 size = vec2(textureSize(reduced_tau, 0));
    FOG_TAU tau = fog_texel_tau(texture(reduced_tau, gl_FragCoord.xy / (reduced_pixel * size)));
#else
    FOG_TAU tau = upsampled(gl_FragCoord.xy, texelFetch(scene_depth, pixel, 0).x);
#endif
    result = fog_result(tau, pixel, fog_colour);
}
