// What a pixel shows behind its fog: L = T L_scene + (1 - T) L_fog (paper 004, eq. 4), linear colours.
// Defines: FOG_CHANNELS: red, green and blue have optical depths of their own (paper 001, eq. 9);
// FOG_OUTPUT_TAU: the optical depth instead of colour.

#include "fog_opacity.glsl"

#ifdef FOG_CHANNELS
#define FOG_TAU vec3
vec3 fog_opacities(vec3 tau) {
    return vec3(fog_opacity(tau.x), fog_opacity(tau.y), fog_opacity(tau.z));
}
vec4 fog_tau_texel(vec3 tau) {
    return vec4(tau, 1.0f);
}
vec3 fog_texel_tau(vec4 texel) {
    return texel.xyz;
}
#else
#define FOG_TAU float
vec3 fog_opacities(float tau) {
    return vec3(fog_opacity(tau));
}
vec4 fog_tau_texel(float tau) {
    return vec4(tau, 0.0f, 0.0f, 1.0f);
}
float fog_texel_tau(vec4 texel) {
    return texel.x;
}
#endif

#ifndef FOG_OUTPUT_TAU
uniform sampler2D scene_colour;
#endif

vec4 fog_result(FOG_TAU tau, ivec2 pixel, vec3 fog_colour) {
#ifdef FOG_OUTPUT_TAU
    return fog_tau_texel(tau);
#else
    vec4 colour = texelFetch(scene_colour, pixel, 0);
    return vec4(mix(colour.rgb, fog_colour, fog_opacities(tau)), colour.a);
#endif
}
