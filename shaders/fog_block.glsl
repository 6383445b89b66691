// Uniform blocks of the fog pass. One definition: GLSL reads it as std140 blocks, C++ (with GLM) as
// structs. Every member is a vec4, an ivec4 or an array of them, so both layouts are the same.
#define FOG_MAX_LEVELS 16

#ifdef __cplusplus
struct FogBlock {
#else
layout(std140) uniform FogBlock {
#endif
    ivec4 base;                    // xy: finest cell (u, v) that the eye's fraction counts from; z: J
    vec4 eye;                      // xy: eye in finest cells from `base`; z: eye's height eta
    vec4 scale;                    // xy: finest cells per metre; z: eta per metre; w: extinction of
                                   // density 1 in the cell texture, 1/m
    vec4 limit;                    // x: optical depth at which a walk stops; y: mean density;
                                   // z: longest sky ray, m
    ivec4 size;                    // xy: finest cells of the box (or of one period); zw: map pixels
    ivec4 level[FOG_MAX_LEVELS];   // l: xy first texel in the atlas, zw cells
    vec4 reach[FOG_MAX_LEVELS];    // l: x = mu^l (paper 004, eq. 12), y = 1 - mu^l
#ifdef __cplusplus
};
#else
} fog;
#endif

// Methods paper and paper-scaling: packed coefficients and path-integral tables.
#ifdef __cplusplus
struct PaperBlock {
#else
layout(std140) uniform PaperBlock {
#endif
    ivec4 place[FOG_MAX_LEVELS];   // l: xy texel of index (0, 0) in the packed atlas
    ivec4 range[FOG_MAX_LEVELS];   // l: first index x, z and one past the last; a repeated map's period
    ivec4 first_block;             // of phi phi, phi psi, psi phi, psi psi
    ivec4 pieces;                  // x: of phi in half cells, y: of psi; z: first piece of psi
    ivec4 table;                   // x: bilinear patches a row; y: 1 for the perimeter layout;
                                   // z, w: first piece and translates that phi and psi cover together
#ifdef __cplusplus
};
#else
} paper;
#endif

// Method radial: what the table's columns and rows stand for (fog_radial.glsl).
#ifdef __cplusplus
struct RadialBlock {
#else
layout(std140) uniform RadialBlock {
#endif
    vec4 axis;     // xy: horizontal unit vector (x, z) of azimuth coordinate 0; z: bend of the
                   // coordinate; w: 1 to count from the nearest of four axes
    vec4 azimuth;  // coordinate of column 0, and per column; zw: texture u = z + w coordinate
    vec4 radius;   // x: distance of row 0, m; y: of the last row less that; z: r0 and w: sqrt(r0) of
                   // the rows' spacing, sqrt(L + r0) - sqrt(r0) = row * rows.x
    vec4 rows;     // x: see above; zw: texture v = z + w sqrt(L + r0)
    vec4 edge;     // xy: least and largest texture u; z: texture v from one level's rows to the next's;
                   // w: 1 if every pixel column has a column of its own
    vec4 cell;     // xy: metres a finest cell
    vec4 stop;     // x: integral at which a column of a uniform fog ends, metres of density 1
    ivec4 size;    // x: columns, y: rows; z: rows from one level's to the next's; w: finest level of
                   // the first table
    ivec4 level[FOG_MAX_LEVELS];  // l: x: one past the last row that reads level l's grid
#ifdef __cplusplus
};
#else
} radial;
#endif

// The eye's rays. A clip-space point (x, y, depth, 1) comes back to camera-relative world metres as
// the homogeneous point (1 - depth) * near(x, y) + depth * far(x, y): no cancellation at any depth
// convention, unlike one inverse matrix applied to 2 * depth - 1.
#ifdef __cplusplus
struct ViewBlock {
#else
layout(std140) uniform ViewBlock {
#endif
    vec4 pixel;          // xy: size in pixels; z: depth of the sky; w: 1 if orthographic
    vec4 depth0[3];      // homogeneous point at depth 0: [0] x + [1] y + [2]
    vec4 depth1[3];      // the same at depth 1
    vec4 ray_high[3];    // perspective: the ray's direction is [0] x + [1] y + [2], x and y twice the
    vec4 ray_low[3];     // pixel less the size; the sum of both, the first without any rounding
    vec4 depth_line;     // perspective: a surface lies 1 / (a + b depth) times its ray's direction
                         // away; a = x + y, b = z + w, in two parts each
    vec4 fog_colour;     // rgb, linear
    ivec4 samples;       // x: N of march:N
    vec4 channels;       // rgb: how much of this fog each sees (FOG_CHANNELS)
#ifdef __cplusplus
};
#else
} view;
#endif
