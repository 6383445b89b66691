// The fog post-process for one fog, or for all that formulas give (fog_models.glsl): depth (and
// colour) in, fogged colour or optical depth out.
// Defines: FOG_DEGREE, FOG_PROFILE, FOG_REPEAT, FOG_SKIP, FOG_METHOD, FOG_PAPER_SCALING,
// RADIAL_LAYERED, RADIAL_STEP, FOG_PARTICLES, FOG_MODEL_KINDS: fog_optical_depth.glsl; FOG_CHANNELS: red,
// green and blue see shares of each fog (paper 001, eq. 9); FOG_OUTPUT_TAU writes optical depth instead
// of colour; FOG_PREVIOUS_TAU adds the optical depth of the fogs drawn before; FOG_SKY_ONLY leaves out
// pixels that show a surface.
precision highp float;
precision highp int;
precision highp sampler2D;

#include "fog_optical_depth.glsl"
#include "fog_blend.glsl"

uniform sampler2D scene_depth;
uniform sampler2D previous_tau;

layout(location = 0) out vec4 result;

float pixel_optical_depth(vec2 pixel, float depth) {
    bool sky = depth == view.pixel.z;
    // A whole number: what follows has no rounding of its own to multiply.
    vec2 place = 2.0f * pixel - view.pixel.xy;

    vec3 start = vec3(0.0f);
    vec3 path;
    vec3 shared_place = vec3(0.0f);
    vec2 reach = vec2(0.0f);
    if (view.pixel.w != 0.0f) {
        vec2 ndc = place / view.pixel.xy;
        vec4 front = view.depth0[0] * ndc.x + view.depth0[1] * ndc.y + view.depth0[2];
        vec4 back = view.depth1[0] * ndc.x + view.depth1[1] * ndc.y + view.depth1[2];
        vec4 surface = front * (1.0f - depth) + back * depth;
        vec4 near_point = view.pixel.z == 0.0f ? back : front;
        vec4 far_point = view.pixel.z == 0.0f ? front : back;
        start = near_point.xyz;
        path = (sky ? far_point.xyz : surface.xyz) - start;
    } else {
        // A ray that grazes a plane multiplies the rounding of its direction: each coordinate is
        // good to float32's last digit even where it is nearly 0.
        vec3 high = view.ray_high[0].xyz * place.x + view.ray_high[1].xyz * place.y + view.ray_high[2].xyz;
        vec3 low = view.ray_low[0].xyz * place.x + view.ray_low[1].xyz * place.y + view.ray_low[2].xyz;
        shared_place = vec3(place, 1.0f);
        reach.x =
            sky ? 1.0f : 1.0f / (view.depth0[2].w * (1.0f - depth) + view.depth1[2].w * depth);
#ifdef FOG_PARTICLES
        reach.y = sky ? 0.0f : particle_reach_rest(reach.x, depth);
#endif
        path = (high + low) * reach.x;
    }
    float metres = length(path);
    if (sky) {
        float farthest = fog_sky_limit();
        path *= farthest / metres;
        reach.x = farthest / metres;
        metres = farthest;
    }
    return fog_optical_depth(start, path, metres, sky, shared_place, reach, ivec2(pixel));
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float depth = texelFetch(scene_depth, pixel, 0).x;
#ifdef FOG_SKY_ONLY
    if (depth != view.pixel.z) {
        discard;
    }
#endif
    FOG_TAU tau = pixel_optical_depth(gl_FragCoord.xy, depth)
#ifdef FOG_CHANNELS
                  * view.channels.rgb
#endif
        ;
#ifdef FOG_PREVIOUS_TAU
    tau += fog_texel_tau(texelFetch(previous_tau, pixel, 0));
#endif
    result = fog_result(tau, pixel, view.fog_colour.rgb);
}
