// Second step of the froxel volume: in-scattered light and transmittance from the eye to the far end
// of every froxel. One invocation a column of the screen's tiles, front to back.
//
// Inside a slice the extinction is constant, and its light and transmittance are integrated in closed
// form, so that light + T L_fog stays L_fog whatever the slice's thickness (Hillaire, "Physically
// Based and Unified Volumetric Rendering in Frostbite", SIGGRAPH 2015). The path is Euclidean.
// With FROXEL_CHANNELS the transmittance of red, green and blue, which tell the light of a fog of one
// colour.
layout(local_size_x = 8, local_size_y = 8) in;

#include "froxel_grid.glsl"

#ifdef FROXEL_CHANNELS
layout(rgba32f) readonly uniform image3D froxel_extinction;  // 1/m, of red, green and blue
layout(rgba16f) writeonly uniform image3D froxel_volume;     // rgb: transmittance
#else
layout(r32f) readonly uniform image3D froxel_extinction;  // 1/m
layout(rgba16f) writeonly uniform image3D froxel_volume;  // rgb: light, a: transmittance
#endif

void main() {
    ivec2 tile = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(tile, froxel.size.xy))) {
        return;
    }
    float stretch = froxel_stretch(froxel_tile(tile));
    vec3 through = vec3(1.0f);
    vec3 light = vec3(0.0f);
    float from = 0.0f;
    for (int k = 0; k < froxel.size.z; ++k) {
        float to = froxel_depth(float(k + 1));
        vec4 kept = exp(-imageLoad(froxel_extinction, ivec3(tile, k)) * (to - from) * stretch);
#ifdef FROXEL_CHANNELS
        through *= kept.rgb;
        imageStore(froxel_volume, ivec3(tile, k), vec4(through, 1.0f));
#else
        light += through.x * (1.0f - kept.x) * froxel.colour.rgb;
        through *= kept.x;
        imageStore(froxel_volume, ivec3(tile, k), vec4(light, through.x));
#endif
        from = to;
    }
}
