// Last step of the froxel volume: one trilinear look-up a pixel, at its depth.
// In: depth and colour of the scene, the volume of froxel_integrate.comp. Out: fogged colour, or with
// FROXEL_OUTPUT_TAU the optical depth -log(T), with FROXEL_CHANNELS of red, green and blue.
precision highp float;
precision highp sampler2D;
precision highp sampler3D;

#include "froxel_grid.glsl"

uniform sampler2D scene_depth;
uniform sampler2D scene_colour;
uniform sampler3D froxel_volume;

layout(location = 0) out vec4 result;

#ifdef FROXEL_CHANNELS
#define FROXEL_CLEAR vec4(1.0f)  // rgb: transmittance
#else
#define FROXEL_CLEAR vec4(0.0f, 0.0f, 0.0f, 1.0f)  // rgb: in-scattered light; a: transmittance
#endif

vec4 look_up(vec2 at, float buffer_depth) {
    float depth = mix(froxel.depths.x, froxel.depths.y, buffer_depth);
    if (buffer_depth == froxel.depths.z) {
        depth = froxel.slices.w / froxel_stretch(2.0f * at - 1.0f);
    } else if (froxel.axis.w != 0.0f) {
        depth = 1.0f / depth;
    }
    // Texel k holds the integral to the end of slice k, which is slice coordinate k + 1. The first
    // slice begins with no fog at depth 0.
    float inside = clamp(depth / froxel.slices.z, 0.0f, 1.0f);
    float slice = froxel_slice(max(depth, froxel.slices.z));
    vec4 fog = textureLod(froxel_volume, vec3(at, (slice - 0.5f) / float(froxel.size.z)), 0.0f);
    return mix(FROXEL_CLEAR, fog, inside);
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    vec4 fog = look_up(gl_FragCoord.xy * froxel.pixel.xy, texelFetch(scene_depth, pixel, 0).x);
#ifdef FROXEL_CHANNELS
    vec3 through = fog.rgb;
    vec3 light = (1.0f - through) * froxel.colour.rgb;
#else
    vec3 through = vec3(fog.a);
    vec3 light = fog.rgb;
#endif
#ifdef FROXEL_OUTPUT_TAU
    // The volume's least transmittance above 0 is 2^-24.
    result = vec4(-log(clamp(through, 5.9604645e-8f, 1.0f)), 1.0f);
#else
    vec4 colour = texelFetch(scene_colour, pixel, 0);
    result = vec4(colour.rgb * through + light, colour.a);
#endif
}
