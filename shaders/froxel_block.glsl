// Uniform block of the froxel volume. One definition: GLSL reads it as a std140 block, C++ (with GLM)
// as a struct; every member is a vec4 or an ivec4, so both layouts are the same.
#ifdef __cplusplus
struct FroxelBlock {
#else
layout(std140) uniform FroxelBlock {
#endif
    // The point of the view at NDC (x, y) and `depth` metres, relative to the eye in world metres, is
    //   start + axis depth + (right x + up y) (start.w + axis.w depth).
    vec4 start;          // xyz: where depth 0 is at NDC 0; w: 1 if orthographic
    vec4 axis;           // xyz: per metre of depth at NDC 0; w: 1 if perspective
    vec4 right;          // xyz: half an image width (for each metre of depth in perspective)
    vec4 up;             // xyz: half an image height
    vec4 slices;         // x: near, m; y: log2(far / near) / slices; z: end of the first slice, m;
                         // w: longest sky ray, m
    vec4 depths;         // 1 / depth (perspective) or depth (orthographic) at buffer depth x: 0, y: 1;
                         // z: buffer depth of the sky
    vec4 pixel;          // xy: 1 / size in pixels
    vec4 colour;         // rgb: L_fog, linear
    ivec4 size;          // xyz: tiles across, tiles up, slices
#ifdef __cplusplus
};
#else
} froxel;
#endif
