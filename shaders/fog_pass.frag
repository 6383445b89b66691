// The fog post-process for one fog, or for all that formulas give (fog_models.glsl): depth (and
// colour) in, fogged colour or optical depth out.
// Defines: FOG_DEGREE, FOG_PROFILE, FOG_REPEAT, FOG_SKIP, FOG_METHOD, FOG_PAPER_SCALING,
// RADIAL_LAYERED, RADIAL_STEP, FOG_PARTICLES; FOG_CHANNELS: red, green and blue see shares of each fog (paper
// 001, eq. 9); FOG_OUTPUT_TAU writes optical depth instead of colour; FOG_PREVIOUS_TAU adds the
// optical depth of the fogs drawn before.
// Blend: L = T L_scene + (1 - T) L_fog (paper 004, eq. 4), linear colours.
precision highp float;
precision highp int;
precision highp sampler2D;

#define FOG_METHOD_EXACT 0
#define FOG_METHOD_MARCH 1
#define FOG_METHOD_HOMOGENEOUS 2
#define FOG_METHOD_NONE 3
#define FOG_METHOD_PAPER 4
#define FOG_METHOD_RADIAL 5
#define FOG_METHOD_MODELS 6

#include "fog_block.glsl"

uniform sampler2D fog_cells;       // atlas of cell polynomials
uniform sampler2D fog_map;         // the map itself, for march:N
uniform sampler2D paper_bands;     // packed coefficients
uniform sampler2D paper_paths;     // path-integral table, whole paths
uniform sampler2D paper_partials;  // path-integral table, partial paths
uniform sampler2D radial_table;    // of method radial
uniform sampler2D scene_depth;
uniform sampler2D scene_colour;
uniform sampler2D previous_tau;
uniform sampler2D model_tables;    // of fogs from tabulated functions

#include "fog_ray.glsl"
#include "fog_cell.glsl"
#include "fog_exact.glsl"
#include "fog_baselines.glsl"
#if FOG_METHOD == FOG_METHOD_PAPER
#include "fog_paper.glsl"
#elif FOG_METHOD == FOG_METHOD_RADIAL
#include "fog_radial.glsl"
#elif FOG_METHOD == FOG_METHOD_MODELS
#include "fog_models_block.glsl"
#include "fog_models.glsl"
#ifdef FOG_PARTICLES
uniform sampler2D particle_tiles;  // where a tile's list begins and how long it is
uniform sampler2D particle_list;   // particles, tile by tile
#include "fog_particles.glsl"
#endif
#endif

layout(location = 0) out vec4 result;

float optical_depth(vec2 pixel, float depth) {
    bool sky = depth == view.pixel.z;
    // A whole number: what follows has no rounding of its own to multiply.
    vec2 place = 2.0f * pixel - view.pixel.xy;

    vec3 start = vec3(0.0f);
    vec3 path;
    vec3 shared_place = vec3(0.0f);
    float per_direction = 0.0f;
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
        per_direction =
            sky ? 1.0f : 1.0f / (view.depth0[2].w * (1.0f - depth) + view.depth1[2].w * depth);
        path = (high + low) * per_direction;
    }
    float metres = length(path);
    if (sky) {
#if FOG_METHOD == FOG_METHOD_MODELS
        float farthest = models.limit.x;
#else
        float farthest = fog.limit.z;
#endif
        path *= farthest / metres;
        per_direction = farthest / metres;
        metres = farthest;
    }
#if FOG_METHOD == FOG_METHOD_MODELS
    float tau = fog_models(start, path, metres, shared_place, per_direction);
#ifdef FOG_PARTICLES
    tau += fog_particles(ivec2(pixel), start, path, metres, shared_place, per_direction);
#endif
    return tau;
#elif FOG_METHOD == FOG_METHOD_HOMOGENEOUS
    return fog_homogeneous(metres);
#elif FOG_METHOD == FOG_METHOD_NONE
    return 0.0f;
#else
    FogRay ray;
    ray.origin = fog.eye.xy + start.xz * fog.scale.xy;
    ray.slope = path.xz * fog.scale.xy;
    ray.eta = fog.eye.z + start.y * fog.scale.z;
    ray.rise = path.y * fog.scale.z;
    ray.metres = metres;
    ray.passed = 0.0f;
    ray.last = 1.0f;
    ray.sky = sky;
#if FOG_METHOD == FOG_METHOD_EXACT
    return fog_exact(ray);
#elif FOG_METHOD == FOG_METHOD_PAPER
    return fog_paper(ray);
#elif FOG_METHOD == FOG_METHOD_RADIAL
    return fog_radial(ray);
#else
    return fog_march(ray, view.samples.x);
#endif
#endif
}

void main() {
    ivec2 pixel = ivec2(gl_FragCoord.xy);
    float tau = optical_depth(gl_FragCoord.xy, texelFetch(scene_depth, pixel, 0).x);
#ifdef FOG_CHANNELS
    vec3 taus = tau * view.channels.rgb;
#ifdef FOG_PREVIOUS_TAU
    taus += texelFetch(previous_tau, pixel, 0).xyz;
#endif
    vec3 opacity = vec3(fog_opacity(taus.x), fog_opacity(taus.y), fog_opacity(taus.z));
#else
#ifdef FOG_PREVIOUS_TAU
    tau += texelFetch(previous_tau, pixel, 0).x;
#endif
    vec3 taus = vec3(tau, 0.0f, 0.0f);
    vec3 opacity = vec3(fog_opacity(tau));
#endif
#ifdef FOG_OUTPUT_TAU
    result = vec4(taus, 1.0f);
#else
    vec4 colour = texelFetch(scene_colour, pixel, 0);
    result = vec4(mix(colour.rgb, view.fog_colour.rgb, opacity), colour.a);
#endif
}
