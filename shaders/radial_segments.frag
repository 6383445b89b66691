// Fills the table of method radial without compute shaders, first step: each texel walks from the row
// before to its own. radial_scan.frag joins what they find.
// Defines: FOG_DEGREE, FOG_PROFILE, FOG_REPEAT.
precision highp float;
precision highp int;
precision highp sampler2D;

#include "fog_block.glsl"

uniform sampler2D fog_cells;  // atlas of cell polynomials
uniform sampler2D radial_table;

#define RADIAL_SEGMENTS
#include "fog_ray.glsl"
#include "fog_cell.glsl"
#include "fog_exact.glsl"
#include "fog_radial.glsl"

layout(location = 0) out vec4 result;

void radial_store(int column, int row, vec3 integrals) {
    result = vec4(integrals, 0.0f);
}

#include "fog_radial_fill.glsl"

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    int layer = texel.y / radial.size.z;
    int row = texel.y - layer * radial.size.z;
    // Rows that the table has no use for: finite, as the look-up's filter may touch them.
    result = vec4(0.0f);
    if (row < radial.size.y) {
        radial_walk(texel.x, texel.y - row, radial.size.w + layer, row, row + 1);
    }
}
