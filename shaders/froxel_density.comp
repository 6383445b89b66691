// First step of the froxel volume: the extinction of one fog, 1/m, sampled once at every froxel's
// centre. One invocation a froxel. Defines: FOG_DEGREE, FOG_PROFILE; FROXEL_ADD adds to the fogs
// before it; FROXEL_CHANNELS: red, green and blue see shares of each fog (paper 001, eq. 9).
layout(local_size_x = 8, local_size_y = 8) in;

#include "fog_block.glsl"
#include "froxel_grid.glsl"

#ifdef FROXEL_CHANNELS
layout(rgba32f) uniform image3D froxel_extinction;
uniform vec3 channels;
#else
layout(r32f) uniform image3D froxel_extinction;
const vec3 channels = vec3(1.0f);
#endif
uniform sampler2D fog_map;  // bilinear (nearest for Haar), zero border or repeat

#include "fog_ray.glsl"
#include "fog_baselines.glsl"

float extinction(vec3 point) {
    // As in fog_march: pixel i is centred at i + (d + 1) / 2 of the spline's causal coordinate.
    vec2 pixel = fog.eye.xy + point.xz * fog.scale.xy + vec2(fog.base.xy) - 0.5f * float(FOG_DEGREE);
    float eta = fog.eye.z + point.y * fog.scale.z;
    float height = fog_height(eta);
#if FOG_PROFILE == FOG_SLAB
    height = eta >= 0.0f && eta < 1.0f ? 1.0f : 0.0f;
#endif
    return max(texture(fog_map, pixel / vec2(fog.size.zw)).x, 0.0f) * height * fog.scale.w;
}

void main() {
    ivec3 cell = ivec3(gl_GlobalInvocationID);
    if (any(greaterThanEqual(cell, froxel.size.xyz))) {
        return;
    }
    float depth = cell.z == 0 ? 0.5f * froxel.slices.z : froxel_depth(float(cell.z) + 0.5f);
    vec4 sum = vec4(extinction(froxel_point(froxel_tile(cell.xy), depth)) * channels, 0.0f);
#ifdef FROXEL_ADD
    sum += imageLoad(froxel_extinction, cell);
#endif
    imageStore(froxel_extinction, cell, sum);
}
