// Fills the table of method radial: one invocation a column and, with mu < 1, a level.
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

void radial_store(int column, int row, vec3 means) {
    imageStore(radial_image, ivec2(column, row), vec4(means, 0.0f));
}

#include "fog_radial_fill.glsl"

void main() {
    int column = int(gl_GlobalInvocationID.x);
    int layer = int(gl_GlobalInvocationID.y);
    if (column < radial.size.x) {
        radial_walk(column, layer * radial.size.z, radial.size.w + layer, 0, radial.size.y);
    }
}
