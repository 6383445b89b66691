// Fills the table of method radial without compute shaders, second step, drawn as often as it takes:
// joins the integrals of RADIAL_JOINED groups of `radial_scan.x` rows that end at each row. Row 0 holds
// what the means begin with and is joined to nothing.
// Defines: FOG_PROFILE, RADIAL_JOINED.
precision highp float;
precision highp int;
precision highp sampler2D;

#include "fog_block.glsl"

uniform sampler2D radial_sums;  // of the step before
uniform ivec2 radial_scan;      // x: rows a group; y: 1 in the last step, which makes means of the sums

#include "fog_ray.glsl"
#include "fog_radial_rows.glsl"

layout(location = 0) out vec4 result;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    int row = texel.y - texel.y / radial.size.z * radial.size.z;
    vec3 sum = texelFetch(radial_sums, texel, 0).xyz;
    if (row > 0) {
        vec2 spacing = radial_spacing();
        float along = radial_distance(spacing, row);
        for (int i = 1; i < RADIAL_JOINED; ++i) {
            int back = i * radial_scan.x;
            if (back >= row) {
                break;
            }
            vec3 before = texelFetch(radial_sums, ivec2(texel.x, texel.y - back), 0).xyz;
            sum = radial_join(before, sum, along - radial_distance(spacing, row - back));
        }
        if (radial_scan.y != 0) {
            sum = radial_means(sum, along);
        }
    }
    result = vec4(sum, 0.0f);
}
