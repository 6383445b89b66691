// Fills the table of method radial: one invocation a column.
// Defines: FOG_DEGREE, FOG_PROFILE, FOG_REPEAT.
layout(local_size_x = 32) in;

#include "fog_block.glsl"

uniform sampler2D fog_cells;  // atlas of cell polynomials
uniform sampler2D radial_table;
layout(RADIAL_FORMAT) writeonly uniform image2D radial_image;

#include "fog_ray.glsl"
#include "fog_cell.glsl"
#include "fog_exact.glsl"
#include "fog_radial.glsl"

void radial_store(int column, int row, vec4 means) {
    imageStore(radial_image, ivec2(column, row), means);
}

#include "fog_radial_fill.glsl"

void main() {
    int column = int(gl_GlobalInvocationID.x);
    if (column < radial.size.x) {
        radial_fill(column);
    }
}
