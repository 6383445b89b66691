// Integrals of the density along a horizontal line, cell by cell, for the table of method radial and
// for the exact last step of its look-ups. Compiles as GLSL and as C++.

// A_n over the first d metres of a line whose s counts metres.
vec3 radial_step(FogLine line, float d) {
    vec3 sum = vec3(d * (line.s0 + d * ((1.0f / 2.0f) * line.s1 + d * (1.0f / 3.0f) * line.s2)), 0.0f,
                    0.0f);
#if FOG_DEGREE == 2
    float d4 = (d * d) * (d * d);
    sum.x += d4 * ((1.0f / 4.0f) * line.s3 + d * (1.0f / 5.0f) * line.s4);
#endif
#if RADIAL_ORDER >= 2
    float d2 = d * d;
    sum.y = d2 * ((1.0f / 2.0f) * line.s0 +
                  d * ((1.0f / 6.0f) * line.s1 + d * (1.0f / 12.0f) * line.s2));
#if FOG_DEGREE == 2
    sum.y += d * d4 * ((1.0f / 20.0f) * line.s3 + d * (1.0f / 30.0f) * line.s4);
#endif
#endif
#if RADIAL_ORDER >= 3
    sum.z = d * d2 * ((1.0f / 6.0f) * line.s0 +
                      d * ((1.0f / 24.0f) * line.s1 + d * (1.0f / 60.0f) * line.s2));
#if FOG_DEGREE == 2
    sum.z += d2 * d4 * ((1.0f / 120.0f) * line.s3 + d * (1.0f / 210.0f) * line.s4);
#endif
#endif
    // Approximations of degree >= 1 can be negative: a step that is, counts as empty.
    return sum.x > 0.0f ? sum : vec3(0.0f);
}

// The cell at t; on a face, the one that the ray goes into.
vec2 radial_cell(FogGrid grid, float t) {
    vec2 point = grid.o + grid.g * t;
    return vec2(grid.g.x < 0.0f ? ceil(point.x) - 1.0f : floor(point.x),
                grid.g.y < 0.0f ? ceil(point.y) - 1.0f : floor(point.y));
}

// The cell behind k, which the ray leaves at `next` through the faces that it crosses there.
vec2 radial_next_cell(FogGrid grid, vec2 k, vec2 cross, float next) {
    return vec2(cross.x <= next ? k.x + grid.forward.x : k.x,
                cross.y <= next ? k.y + grid.forward.y : k.y);
}

// The density from t on in cell k.
FogLine radial_line(FogGrid grid, ivec4 level, vec2 k, float t, float twist) {
    return fog_line(fog_fetch(level, k + grid.first), grid.o + grid.g * t - k, grid.g, twist);
}

// The part of a line from the eye that lies inside the map, of `range` in metres. `slope`: finest cells
// a metre.
vec2 radial_inside(vec2 range, vec2 slope) {
#ifndef FOG_REPEAT
    vec2 low = -vec2(float(fog.base.x), float(fog.base.y));
    vec2 high = low + vec2(float(fog.size.x), float(fog.size.y));
    float end = range.y;
    range = fog_clip_axis(range, fog.eye.x, slope.x, low.x, high.x);
    range = fog_clip_axis(range, fog.eye.y, slope.y, low.y, high.y);
    range.x = min(range.x, end);
    range.y = max(range.x, range.y);
#endif
    return range;
}
