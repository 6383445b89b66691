// Method radial: a table of the fog around the eye, and its look-up. Compiles as GLSL and as C++.
//
// All rays of a frame start at the eye and the fog does not vary with y inside a height profile, so
// that the integral along a ray depends on its azimuth and its horizontal length r alone. Column i
// of the table is an azimuth, row j a horizontal distance L from `radial.radius.x` on; its channels
// are the n-fold integrals of the density along the azimuth,
//   A_n(L) = integral of rho(x) (L - x)^(n-1) / (n-1)! over x in [0, L],
// as means m_n = n! A_n / L^n, which stay finite at L = 0 and are interpolated linearly. A height
// profile that is a spline in eta is integrated by parts: only its ends, and the jumps of its
// derivatives at its knots, need a look-up.
//
// Azimuths are counted by a ratio instead of an angle: the tangent from `radial.axis`, along which
// the columns of a level camera are pixel columns, or s / (|f| + |s|) for wide views and the full
// turn, -2 .. 2.

// n: uniform and slab 1, linear 2, exponential 4.
#if FOG_PROFILE == FOG_EXPONENTIAL
#define RADIAL_ORDER 4
#elif FOG_PROFILE == FOG_LINEAR
#define RADIAL_ORDER 2
#else
#define RADIAL_ORDER 1
#endif

// Horizontal unit vector (world x, z) of an azimuth coordinate.
vec2 radial_direction(float a) {
    float s = a;
    float f = 1.0f;
    if (radial.axis.z != 0.0f) {
        // |f| = 1 - |s| within a quarter turn of the axis; beyond it s falls again.
        s = a > 1.0f ? 2.0f - a : a < -1.0f ? -2.0f - a : a;
        f = abs(a) > 1.0f ? abs(s) - 1.0f : 1.0f - abs(s);
    }
    vec2 d = radial.axis.xy * f + vec2(-radial.axis.y, radial.axis.x) * s;
    return d * (1.0f / length(d));
}

// Texture u of a horizontal offset from the eye, in any unit.
float radial_column_of(vec2 offset) {
    float f = dot(offset, radial.axis.xy);
    float s = dot(offset, vec2(-radial.axis.y, radial.axis.x));
    float a = s / max(abs(f) + radial.axis.z * abs(s), 1.0e-30f);
    a = f < 0.0f ? (s < 0.0f ? -2.0f : 2.0f) - a : a;
    return clamp(radial.azimuth.z + radial.azimuth.w * a, radial.edge.x, radial.edge.y);
}

// Metres from row 0's distance to row j's.
float radial_length(int j) {
    float root = radial.rows.x * float(j);
    return root * (root + 2.0f * radial.radius.w);
}

// m_n at horizontal distance r along the column with texture u, times L^n / n!: A_n.
vec4 radial_integrals(float u, float r) {
    float along = clamp(r - radial.radius.x, 0.0f, radial.radius.y);
    float v = radial.rows.z + radial.rows.w * sqrt(along + radial.radius.z);
#ifdef FOG_REPEAT
    // After many periods the mean stays.
    along = max(r - radial.radius.x, 0.0f);
#endif
    return texture(radial_table, vec2(u, v)) * along;
}

// Optical depth from the eye to `path` (world metres from the eye) at a distance of `metres`.
float fog_radial(vec3 path, float metres) {
    vec2 offset = vec2(path.x, path.z);
    float r = max(length(offset), 1.0e-20f);
    float u = radial_column_of(offset);
    return fog.scale.w * metres / r * radial_integrals(u, r).x;
}
