// What a column of the table of method radial holds (fog_radial.glsl): integrals that are joined one
// behind the other, as means by row. Compiles as GLSL and as C++.

// The largest n.
#if FOG_PROFILE == FOG_EXPONENTIAL
#define RADIAL_ORDER 3
#elif FOG_PROFILE == FOG_LINEAR
#define RADIAL_ORDER 2
#else
#define RADIAL_ORDER 1
#endif

// Integrals up to a point, a, and those of the next d metres alone, b: up to the end of b.
vec3 radial_join(vec3 a, vec3 b, float d) {
    vec3 sum = a + b;
#if RADIAL_ORDER >= 2
    sum.y += d * a.x;
#endif
#if RADIAL_ORDER >= 3
    sum.z += d * (a.y + d * (1.0f / 2.0f) * a.x);
#endif
    return sum;
}

// Metres from row 0 to a row; `spacing` is radial_spacing().
float radial_distance(vec2 spacing, int row) {
    float root = spacing.x * float(row);
    return root * (root + spacing.y);
}
vec2 radial_spacing() {
    return vec2(radial.rows.x, 2.0f * radial.radius.w);
}

// What the table holds, from the integrals up to a row `along` metres from row 0.
vec3 radial_means(vec3 sum, float along) {
    float per_length = 1.0f / along;
    return sum * vec3(1.0f, 2.0f * per_length, 6.0f * per_length * per_length) * per_length;
}
