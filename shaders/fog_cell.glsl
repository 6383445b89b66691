// One cell of the spline surface: its polynomial and its mean along a segment.
// FOG_DEGREE 0 (Haar), 1 (linear), 2 (quadratic); FOG_PROFILE as in fog_ray.glsl.
// Compiles as GLSL and as C++ (GLM). Densities are in units of the cell texture, coordinates local to
// the cell, [0,1]^2.

// A cell without fog holds -FOG_EMPTY * (s + 1) instead of a density: the aligned block of 2^s cells
// around it is empty. Densities stay far above -FOG_EMPTY / 2 (the texture is scaled to maximum 1).
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

float fog_density(FogCell cell, vec2 p) {
#if FOG_DEGREE == 0
    return cell.c.x;
#elif FOG_DEGREE == 1
    return cell.c.x + cell.c.y * p.x + p.y * (cell.c.z + cell.c.w * p.x);
#else
    float a = cell.row0.x + p.x * (cell.row0.y + p.x * cell.row0.z);
    float b = cell.row1.x + p.x * (cell.row1.y + p.x * cell.row1.z);
    float c = cell.row2.x + p.x * (cell.row2.y + p.x * cell.row2.z);
    return a + p.y * (b + p.y * c);
#endif
}

// Mean density on the segment with end points a and b: exact for the polynomial.
float fog_mean(FogCell cell, vec2 a, vec2 b) {
#if FOG_DEGREE == 0
    return cell.c.x;
#elif FOG_DEGREE == 1
    // The mean of u v is the product of the means plus du dv / 12.
    vec2 m = 0.5f * (a + b);
    vec2 d = b - a;
    return cell.c.x + cell.c.y * m.x + cell.c.z * m.y +
           cell.c.w * (m.x * m.y + d.x * d.y * (1.0f / 12.0f));
#else
    // Degree 4 along the segment: 3-point Gauss-Legendre is exact.
    vec2 m = 0.5f * (a + b);
    vec2 d = 0.387298334620742f * (b - a);
    return (5.0f / 18.0f) * (fog_density(cell, m - d) + fog_density(cell, m + d)) +
           (4.0f / 9.0f) * fog_density(cell, m);
#endif
}

#if FOG_PROFILE == FOG_LINEAR
// Mean of density * (1 - eta), eta from e0 to e1: degree 2 d + 1 along the segment, so d + 1 Gauss
// nodes stay exact.
float fog_mean_height(FogCell cell, vec2 a, vec2 b, float e0, float e1) {
    float h0 = clamp(1.0f - e0, 0.0f, 1.0f);
    float h1 = clamp(1.0f - e1, 0.0f, 1.0f);
    float hm = 0.5f * (h0 + h1);
#if FOG_DEGREE == 0
    return cell.c.x * hm;
#elif FOG_DEGREE == 1
    vec2 m = 0.5f * (a + b);
    vec2 d = 0.288675134594813f * (b - a);
    float hd = 0.288675134594813f * (h1 - h0);
    return 0.5f * (fog_density(cell, m - d) * (hm - hd) + fog_density(cell, m + d) * (hm + hd));
#else
    vec2 m = 0.5f * (a + b);
    vec2 d = 0.387298334620742f * (b - a);
    float hd = 0.387298334620742f * (h1 - h0);
    return (5.0f / 18.0f) * (fog_density(cell, m - d) * (hm - hd) +
                             fog_density(cell, m + d) * (hm + hd)) +
           (4.0f / 9.0f) * fog_density(cell, m) * hm;
#endif
}
#endif

#if FOG_PROFILE == FOG_EXPONENTIAL
// Mean of density * exp(-eta), eta from e0 to e1, both >= 0 or both <= 0 (there h = 1). Gauss-Legendre
// with d + 3 nodes on pieces of |eta1 - eta0| <= 1: relative error below 1e-6 (stability.md 7).
float fog_mean_height(FogCell cell, vec2 a, vec2 b, float e0, float e1) {
    float h0 = max(e0, 0.0f);
    float h1 = max(e1, 0.0f);
    float pieces = clamp(ceil(abs(h1 - h0)), 1.0f, 64.0f);
    vec2 d = (b - a) / pieces;
    float de = (h1 - h0) / pieces;
    float sum = 0.0f;
    for (float i = 0.5f; i < pieces; i += 1.0f) {
        vec2 m = a + d * i;
        float e = h0 + de * i;
        float w = exp(-e);
#if FOG_DEGREE == 0
        // sinh(x) / x, |x| <= 1/2, to 1e-9: the closed form of the mean of exp.
        float x = 0.25f * de * de;
        sum += w * cell.c.x * (1.0f + x * (1.0f / 6.0f) * (1.0f + x * 0.05f * (1.0f + x * (1.0f / 42.0f))));
#else
#if FOG_DEGREE == 1
        // 4 nodes
        float n0 = 0.169990521792428f;
        float n1 = 0.430568155797026f;
        float w0 = 0.326072577431273f;
        float w1 = 0.173927422568727f;
        float c = 0.0f;
#else
        // 5 nodes
        float n0 = 0.269234655052841f;
        float n1 = 0.453089922969332f;
        float w0 = 0.239314335249683f;
        float w1 = 0.118463442528095f;
        float c = 0.284444444444444f * fog_density(cell, m);
#endif
        float f0 = exp(de * n0);
        float f1 = exp(de * n1);
        sum += w * (c + w0 * (fog_density(cell, m - d * n0) * f0 + fog_density(cell, m + d * n0) / f0) +
                    w1 * (fog_density(cell, m - d * n1) * f1 + fog_density(cell, m + d * n1) / f1));
#endif
    }
    return sum / pieces;
}
#endif
