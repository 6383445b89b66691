// Second step of the froxel volume: in-scattered light and transmittance from the eye to the far end
// of every froxel. One invocation a column of the screen's tiles, front to back.
//
// Inside a slice the extinction is constant, and its light and transmittance are integrated in closed
// form, so that light + T L_fog stays L_fog whatever the slice's thickness (Hillaire, "Physically
// Based and Unified Volumetric Rendering in Frostbite", SIGGRAPH 2015). The path is Euclidean.
layout(local_size_x = 8, local_size_y = 8) in;

#include "froxel_grid.glsl"

layout(r32f) readonly uniform image3D froxel_extinction;  // 1/m
layout(rgba16f) writeonly uniform image3D froxel_volume;  // rgb: light, a: transmittance

void main() {
    ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(tile, froxel.size.xy))) {
        return;
    }
    float stretch = froxel_stretch(froxel_tile(tile));
    float through = 1.0f;
    vec3 light = vec3(0.0f);
    float from = 0.0f;
    for (int k = 0; k < froxel.size.z; ++k) {
        float to = froxel_depth(float(k + 1));
        float kept = exp(-imageLoad(froxel_extinction, ivec3(tile, k)).x * (to - from) * stretch);
        light += through * (1.0f - kept) * froxel.colour.rgb;
        through *= kept;
        imageStore(froxel_volume, ivec3(tile, k), vec4(light, through));
        from = to;
    }
}
