// One cell of the spline surface: its polynomial, and its mean along a segment with a height profile.
// FOG_DEGREE 0 (Haar), 1 (linear), 2 (quadratic); FOG_PROFILE as in fog_ray.glsl.
// Compiles as GLSL and as C++ (GLM). Densities are in units of the cell texture, coordinates local to
// the cell, [0,1]^2.
//
// On a segment m + d s, s in [-1, 1], a cell's density is a polynomial of degree 2 FOG_DEGREE in s, so
// its mean is a dot product of coefficients with the profile's moments: closed form for every basis
// and profile.

// A cell without fog holds -(FOG_EMPTY + r) instead of a density, and zeros: the square of cells up to
// r away from it in x and z is empty. Densities stay far above -FOG_EMPTY (the texture is scaled to
// maximum 1).
#define FOG_EMPTY 1024.0f

struct FogCell {
#if FOG_DEGREE == 2
    vec4 row0;  // density = row0(u) + v row1(u) + v^2 row2(u), row(u) = x + y u + z u^2
    vec4 row1;
    vec4 row2;
#else
    vec4 c;     // Haar: x; linear: x + y u + z v + w u v
#endif
};

#if FOG_DEGREE == 2
#define FOG_FIRST(cell) ((cell).row0.x)
#else
#define FOG_FIRST(cell) ((cell).c.x)
#endif

// Moments of the height profile over a segment: m_k = mean of s^k h(s), s in [-1, 1].
struct FogMoments {
    float m0;
    float m1;
    float m2;
    float m3;
    float m4;
};

// e0, e1: eta at the segment's ends, on one side of every integer eta (fog_exact.glsl sees to it).
FogMoments fog_moments(float e0, float e1) {
    FogMoments h;
#if FOG_PROFILE == FOG_LINEAR
    float h0 = clamp(1.0f - e0, 0.0f, 1.0f);
    float h1 = clamp(1.0f - e1, 0.0f, 1.0f);
    float a = 0.5f * (h0 + h1);
    float b = 0.5f * (h1 - h0);
    h.m0 = a;
    h.m1 = b * (1.0f / 3.0f);
    h.m2 = a * (1.0f / 3.0f);
    h.m3 = b * (1.0f / 5.0f);
    h.m4 = a * (1.0f / 5.0f);
#elif FOG_PROFILE == FOG_EXPONENTIAL
    // h = exp(-e) exp(-x s): m_k = exp(-e) sum_n (-x)^n / (n! (n + k + 1)), n + k even. |x| <= 1/2, so
    // the dropped terms are below 2e-8. The closed forms cancel (stability.md 7).
    float h0 = max(e0, 0.0f);
    float h1 = max(e1, 0.0f);
    float w = exp(-0.5f * (h0 + h1));
    float x = 0.5f * (h1 - h0);
    float y = x * x;
    float z = -w * x;
    h.m0 = w * (1.0f + y * (1.0f / 6.0f + y * (1.0f / 120.0f + y * (1.0f / 5040.0f))));
    h.m1 = z * (1.0f / 3.0f + y * (1.0f / 30.0f + y * (1.0f / 840.0f + y * (1.0f / 45360.0f))));
    h.m2 = w * (1.0f / 3.0f + y * (1.0f / 10.0f + y * (1.0f / 168.0f + y * (1.0f / 6480.0f))));
    h.m3 = z * (1.0f / 5.0f + y * (1.0f / 42.0f + y * (1.0f / 1080.0f)));
    h.m4 = w * (1.0f / 5.0f + y * (1.0f / 14.0f + y * (1.0f / 216.0f + y * (1.0f / 7920.0f))));
#else
    h.m0 = 1.0f;
    h.m1 = 0.0f;
    h.m2 = 1.0f / 3.0f;
    h.m3 = 0.0f;
    h.m4 = 1.0f / 5.0f;
#endif
    return h;
}

// A cell's density on a line m + d s: s0 + s1 s + s2 s^2 + s3 s^3 + s4 s^4.
struct FogLine {
    float s0;
    float s1;
    float s2;
    float s3;
    float s4;
};

// area = d.x d.y.
FogLine fog_line(FogCell cell, vec2 m, vec2 d, float area) {
    FogLine line;
#if FOG_DEGREE == 0
    line.s0 = cell.c.x;
    line.s1 = 0.0f;
    line.s2 = 0.0f;
    line.s3 = 0.0f;
    line.s4 = 0.0f;
#elif FOG_DEGREE == 1
    float du = cell.c.y + cell.c.w * m.y;
    float dv = cell.c.z + cell.c.w * m.x;
    line.s0 = cell.c.x + cell.c.y * m.x + m.y * dv;
    line.s1 = d.x * du + d.y * dv;
    line.s2 = cell.c.w * area;
    line.s3 = 0.0f;
    line.s4 = 0.0f;
#else
    // Each row is a + b s + c s^2 along the line; v = m.y + d.y s.
    vec3 a = vec3(cell.row0.x, cell.row1.x, cell.row2.x);
    vec3 b = vec3(cell.row0.y, cell.row1.y, cell.row2.y);
    vec3 c = vec3(cell.row0.z, cell.row1.z, cell.row2.z);
    a = a + m.x * (b + m.x * c);
    b = d.x * (b + (2.0f * m.x) * c);
    c = (d.x * d.x) * c;
    float v = m.y;
    line.s0 = a.x + v * (a.y + v * a.z);
    line.s1 = b.x + v * (b.y + v * b.z) + d.y * (a.y + 2.0f * v * a.z);
    line.s2 = c.x + v * (c.y + v * c.z) + d.y * (b.y + 2.0f * v * b.z + d.y * a.z);
    line.s3 = d.y * (c.y + 2.0f * v * c.z + d.y * b.z);
    line.s4 = d.y * d.y * c.z;
#endif
    return line;
}

// Mean of density * h on the segment with midpoint m and half extent d; area = d.x d.y.
float fog_mean(FogCell cell, vec2 m, vec2 d, float area, FogMoments h) {
    FogLine line = fog_line(cell, m, d, area);
#if FOG_DEGREE == 0
    return line.s0 * h.m0;
#elif FOG_DEGREE == 1
    return line.s0 * h.m0 + line.s1 * h.m1 + line.s2 * h.m2;
#else
    return line.s0 * h.m0 + line.s1 * h.m1 + line.s2 * h.m2 + line.s3 * h.m3 + line.s4 * h.m4;
#endif
}
