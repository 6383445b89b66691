// Where froxels are: tiles of the screen times slices of view depth.
//
// Slices are exponential, near (far / near)^(k / slices), as in Wronski, "Volumetric Fog" (SIGGRAPH
// 2014); the first one starts at depth 0 instead of `near`, so that no fog is lost before it.
#include "froxel_block.glsl"

vec3 froxel_offset(vec2 ndc) {
    return froxel.right.xyz * ndc.x + froxel.up.xyz * ndc.y;
}

// World metres from the eye.
vec3 froxel_point(vec2 ndc, float depth) {
    return froxel.start.xyz + froxel.axis.xyz * depth +
           froxel_offset(ndc) * (froxel.start.w + froxel.axis.w * depth);
}

// Metres of path for each metre of view depth.
float froxel_stretch(vec2 ndc) {
    return length(froxel.axis.xyz + froxel_offset(ndc) * froxel.axis.w);
}

// NDC of a tile's centre.
vec2 froxel_tile(ivec2 tile) {
    return (vec2(tile) + 0.5f) * 2.0f / vec2(froxel.size.xy) - 1.0f;
}

// View depth of a slice coordinate, from 1 on; slice k lies between k and k + 1.
float froxel_depth(float slice) {
    return froxel.slices.x * exp2(slice * froxel.slices.y);
}
float froxel_slice(float depth) {
    return log2(depth / froxel.slices.x) / froxel.slices.y;
}
