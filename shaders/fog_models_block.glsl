// Uniform block of the fogs given by formulas (fog_models.glsl). One definition: GLSL reads it as a
// std140 block, C++ (with GLM) as a struct; every member is a vec4, an ivec4 or an array of them, so
// both layouts are the same. Metres from the eye on world axes, extinction in 1/m; what is periodic
// is reduced in double.
#define MODEL_MAX_HALFSPACES 8
#define MODEL_MAX_RAMPS 32
#define MODEL_MAX_EXPONENTIALS 8
#define MODEL_MAX_WAVES 64
#define MODEL_MAX_POLYNOMIALS 32
#define MODEL_MAX_OBJECTS 64
#define MODEL_MAX_SEPARABLES 8
#define MODEL_FRACTION_LINEAR 1.0f
#define MODEL_FRACTION_EXP2 2.0f
#define MODEL_SATURATED 200.0f  // optical depth of linear fog where it hides everything

// Which formulas fog_models() has. A rasteriser that masks lanes goes through a loop once, even if it is
// empty, so a program has those of its fogs alone.
#define MODEL_KIND_HALFSPACE 1
#define MODEL_KIND_FRACTION 2  // of halfspaces, linear or exp2
#define MODEL_KIND_RAMP 4
#define MODEL_KIND_EXPONENTIAL 8
#define MODEL_KIND_WAVE 16
#define MODEL_KIND_POLYNOMIAL 32
#define MODEL_KIND_OBJECT 64
#define MODEL_KIND_MEANS 128    // of separables, a product of means
#define MODEL_KIND_WALK 256     // of separables, the mean of the product
#ifndef FOG_MODEL_KINDS
#define FOG_MODEL_KINDS 511
#endif

#ifdef __cplusplus
struct ModelBlock {
#else
layout(std140) uniform ModelBlock {
#endif
    vec4 limit;        // x: longest sky ray, m; y: extinction everywhere, of all models; z: optical
                       // depth at which a walk stops
    ivec4 count;       // x: halfspaces, y: ramp pieces, z: exponentials, w: waves
    ivec4 count_more;  // x: polynomials, y: objects, z: separables, w: side of a tile of particles, pixels
    vec4 plane[MODEL_MAX_HALFSPACES];            // xyz: unit normal, w: the eye's height over it
    vec4 plane_density[MODEL_MAX_HALFSPACES];    // x: extinction, y: gradient, 1/m^2, z: 1 for the
                                                 // fraction linear, 2 for exp2, w: clear optical depth
    vec4 plane_high[MODEL_MAX_HALFSPACES];       // normal . ray of a pixel, as ViewBlock's ray_high
    vec4 plane_low[MODEL_MAX_HALFSPACES];
    vec4 ramp[MODEL_MAX_RAMPS];                  // x: low, y: high, z: extinction at low, w: slope
    vec4 exponential[MODEL_MAX_EXPONENTIALS];    // x: eye's eta, y: eta per metre, z: extinction
    vec4 wave[MODEL_MAX_WAVES];                  // xyz: turns per metre, w: turns at the eye
    vec4 wave_amplitude[MODEL_MAX_WAVES];        // x: extinction
    vec4 polynomial[MODEL_MAX_POLYNOMIALS];      // xyz: u per metre, w: the eye's u
    vec4 coefficients[3 * MODEL_MAX_POLYNOMIALS];  // ten times extinction, ascending; in the third
                                                 // z: mean, w: 1 if repeated
    vec4 object[MODEL_MAX_OBJECTS];              // xyz: point, w: radius
    vec4 object_axis[MODEL_MAX_OBJECTS];         // xyz: a line's direction, w: its length, else 0
    vec4 object_shape[MODEL_MAX_OBJECTS];        // x: extinction, y: 1 / reach
    vec4 separable[MODEL_MAX_SEPARABLES];        // x: extinction, y: 1 for the product of means
    vec4 separable_axis[3 * MODEL_MAX_SEPARABLES];   // x: eye's place in its cell, y: cells per metre,
                                                 // z: cells of the table, 0: none; w: 1 if repeated
    ivec4 separable_row[3 * MODEL_MAX_SEPARABLES];   // x: the eye's cell, y: row of model_tables
#ifdef __cplusplus
};
#else
} models;
#endif
