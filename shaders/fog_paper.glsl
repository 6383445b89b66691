// Optical depth as paper 004's algorithm 1 has it: level by level, cell by cell, every basis function
// over the cell, its coefficient from a packed texture times its integral from a path-integral
// texture. Compiles as GLSL and as C++.
//
// FOG_PAPER_SCALING: the details are scaling functions again (section 4.4), one residual grid a level.
// Otherwise wavelet bands: a wavelet has knots at half cells of its level, so those levels are walked in
// half cells, where each function is one polynomial and the table of means is exact to its sampling.
// Either way detail level l is walked on the grid of the approximation that it completes.
//
// The tables hold no height profile. A profile that varies with height multiplies each step by its mean
// over the step: exact for uniform and slab, an approximation for the others (the paper fades the fog
// with the vertical distance in the same spirit, section 4.3).

// Where a path lies in a block of the table, and how to weigh a texel's four corners.
struct PaperPath {
    ivec2 texel;
    vec4 corner;
    float per_unit;  // integral over t from the looked-up value
};

// Edges 0: u = 0, 1: u = 1, 2: v = 0, 3: v = 1. Column block of a pair of edges, lower one first.
int paper_pair(int first, int second) { return first == 0 ? second - 1 : (first == 1 ? second + 1 : 5); }

// Place on the perimeter, 0..4, in the order v = 0, u = 1, v = 1, u = 0.
float paper_place(int edge, vec2 p) {
    return edge == 2 ? p.x : (edge == 1 ? 1.0f + p.y : (edge == 3 ? 3.0f - p.x : 4.0f - p.y));
}

// The path from face `enter` at a to face `leave` at b, dt long in t and per_cell in t per cell.
PaperPath paper_whole(int enter, vec2 a, int leave, vec2 b, float dt, float per_cell) {
    PaperPath path;
    vec2 s;
    ivec2 block;
    float patches = float(paper.table.x);
    if (paper.table.y != 0) {
        s = vec2(paper_place(leave, b), paper_place(enter, a)) * (0.25f * patches) - 0.5f;
        s = vec2(s.x < 0.0f ? s.x + patches : s.x, s.y < 0.0f ? s.y + patches : s.y);
        block = ivec2(0, 0);
        path.per_unit = per_cell;
    } else {
        bool ordered = enter < leave;
        int first = ordered ? enter : leave;
        int second = ordered ? leave : enter;
        vec2 p = ordered ? a : b;
        vec2 q = ordered ? b : a;
        s = clamp(vec2(first < 2 ? p.y : p.x, second < 2 ? q.y : q.x), 0.0f, 1.0f) * patches;
        block = ivec2(paper_pair(first, second) * paper.table.x, 0);
        path.per_unit = dt;
    }
    vec2 patch_at = clamp(floor(s), vec2(0.0f), vec2(patches - 1.0f));
    s = s - patch_at;
    path.texel = block + ivec2(int(patch_at.x), int(patch_at.y));
    path.corner = vec4((1.0f - s.x) * (1.0f - s.y), s.x * (1.0f - s.y), (1.0f - s.x) * s.y, s.x * s.y);
    return path;
}

// Lagrange weights at the nodes of a partial table, i / FOG_DEGREE.
vec3 paper_nodes(float x) {
#if FOG_DEGREE == 0
    return vec3(1.0f, 0.0f, 0.0f);
#elif FOG_DEGREE == 1
    return vec3(1.0f - x, x, 0.0f);
#else
    return vec3((1.0f - x) * (1.0f - 2.0f * x), 4.0f * x * (1.0f - x), x * (2.0f * x - 1.0f));
#endif
}

// Values of functions at a cell's nodes, or their weights in the mean over a path.
struct PaperNodes {
#if FOG_DEGREE == 2
    vec4 row0;  // v = 0: u = 0, 1/2, 1
    vec4 row1;
    vec4 row2;
#else
    vec4 corners;  // Haar: x; linear: (0,0), (1,0), (0,1), (1,1)
#endif
};

// The mean over a -> b, anywhere in the cell, is the same weighted sum of node values for every
// function: Gauss-Legendre with d + 1 nodes on the path, exact.
PaperNodes paper_weights(vec2 a, vec2 b) {
    PaperNodes w;
#if FOG_DEGREE == 0
    w.corners = vec4(1.0f, 0.0f, 0.0f, 0.0f);
#elif FOG_DEGREE == 1
    vec2 m = 0.5f * (a + b);
    vec2 d = 0.288675134594813f * (b - a);
    vec3 x = paper_nodes(m.x - d.x);
    vec3 z = paper_nodes(m.y - d.y);
    w.corners = 0.5f * vec4(x.x * z.x, x.y * z.x, x.x * z.y, x.y * z.y);
    x = paper_nodes(m.x + d.x);
    z = paper_nodes(m.y + d.y);
    w.corners += 0.5f * vec4(x.x * z.x, x.y * z.x, x.x * z.y, x.y * z.y);
#else
    vec2 m = 0.5f * (a + b);
    vec2 d = 0.387298334620742f * (b - a);
    vec3 x = paper_nodes(m.x);
    vec3 z = (4.0f / 9.0f) * paper_nodes(m.y);
    w.row0 = vec4(x * z.x, 0.0f);
    w.row1 = vec4(x * z.y, 0.0f);
    w.row2 = vec4(x * z.z, 0.0f);
    x = paper_nodes(m.x - d.x);
    z = (5.0f / 18.0f) * paper_nodes(m.y - d.y);
    w.row0 += vec4(x * z.x, 0.0f);
    w.row1 += vec4(x * z.y, 0.0f);
    w.row2 += vec4(x * z.z, 0.0f);
    x = paper_nodes(m.x + d.x);
    z = (5.0f / 18.0f) * paper_nodes(m.y + d.y);
    w.row0 += vec4(x * z.x, 0.0f);
    w.row1 += vec4(x * z.y, 0.0f);
    w.row2 += vec4(x * z.z, 0.0f);
#endif
    return w;
}

// Coefficient times the weighted node values of a block's function.
float paper_partial(float coefficient, int block, PaperNodes w) {
#if FOG_DEGREE == 2
    return coefficient * (dot(texelFetch(paper_partials, ivec2(0, block), 0), w.row0) +
                          dot(texelFetch(paper_partials, ivec2(1, block), 0), w.row1) +
                          dot(texelFetch(paper_partials, ivec2(2, block), 0), w.row2));
#else
    return coefficient * dot(texelFetch(paper_partials, ivec2(0, block), 0), w.corners);
#endif
}

// Coefficients phi phi, phi psi, psi phi, psi psi of index k, 0 where there are none.
vec4 paper_coefficients(int l, ivec2 k) {
    ivec4 range = paper.range[l];
#ifdef FOG_REPEAT
    ivec2 period = ivec2(range.z - range.x, range.w - range.y);
    k = ivec2((k.x - range.x) % period.x, (k.y - range.y) % period.y);
    k = ivec2(range.x + (k.x < 0 ? k.x + period.x : k.x), range.y + (k.y < 0 ? k.y + period.y : k.y));
#else
    if (k.x < range.x || k.y < range.y || k.x >= range.z || k.y >= range.w) {
        return vec4(0.0f);
    }
#endif
    return texelFetch(paper_bands, ivec2(paper.place[l].x + k.x, paper.place[l].y + k.y), 0);
}

// Sums over the functions that overlap one cell: coefficient times mean over a path. Two functions that
// differ in the table alone, because a branch around both costs both on wide processors.
#ifdef FOG_PAPER_SCALING
#define PAPER_WAVELETS(l) false
#else
#define PAPER_WAVELETS(l) ((l) > 0)
#endif

// Translate (i, j) of the wavelet bands over half cell `cell`: coefficients, zero where the translate's
// function does not reach, and blocks of its three functions.
struct PaperBands {
    vec4 c;
    ivec4 block;
};

PaperBands paper_bands_at(int l, ivec2 cell, int i, int j) {
    ivec2 k = ivec2(((cell.x - paper.table.z) >> 1) - i, ((cell.y - paper.table.z) >> 1) - j);
    ivec2 phi = ivec2(cell.x - 2 * k.x, cell.y - 2 * k.y);
    ivec2 psi = ivec2(phi.x - paper.pieces.z, phi.y - paper.pieces.z);
    bool phi_x = phi.x >= 0 && phi.x < paper.pieces.x;
    bool phi_z = phi.y >= 0 && phi.y < paper.pieces.x;
    bool psi_x = psi.x >= 0 && psi.x < paper.pieces.y;
    bool psi_z = psi.y >= 0 && psi.y < paper.pieces.y;
    PaperBands bands;
    bands.c = paper_coefficients(l, k) * vec4(0.0f, phi_x && psi_z ? 1.0f : 0.0f,
                                              psi_x && phi_z ? 1.0f : 0.0f, psi_x && psi_z ? 1.0f : 0.0f);
    bands.block = paper.first_block +
                  ivec4(0, phi_x && psi_z ? psi.y * paper.pieces.x + phi.x : 0,
                        psi_x && phi_z ? phi.y * paper.pieces.y + psi.x : 0,
                        psi_x && psi_z ? psi.y * paper.pieces.y + psi.x : 0);
    return bands;
}

vec4 paper_look_up(PaperPath path, int block) {
    return texelFetch(paper_paths, ivec2(path.texel.x, path.texel.y + block * paper.table.x), 0);
}

// From face to face: all functions share the bilinear weights, so the corners are summed first.
float paper_cell_whole(int l, ivec2 cell, PaperPath path) {
    vec4 corners = vec4(0.0f);
    if (PAPER_WAVELETS(l)) {
        int translates = paper.table.w;
        for (int j = 0; j < translates; ++j) {
            for (int i = 0; i < translates; ++i) {
                PaperBands bands = paper_bands_at(l, cell, i, j);
                corners += bands.c.y * paper_look_up(path, bands.block.y) +
                           bands.c.z * paper_look_up(path, bands.block.z) +
                           bands.c.w * paper_look_up(path, bands.block.w);
            }
        }
    } else {
        for (int j = 0; j <= FOG_DEGREE; ++j) {
            for (int i = 0; i <= FOG_DEGREE; ++i) {
                corners += paper_coefficients(l, ivec2(cell.x - i, cell.y - j)).x *
                           paper_look_up(path, paper.first_block.x + j * (FOG_DEGREE + 1) + i);
            }
        }
    }
    return dot(corners, path.corner) * path.per_unit;
}

// From a to b anywhere in the cell.
float paper_cell_partial(int l, ivec2 cell, vec2 a, vec2 b) {
    PaperNodes w = paper_weights(a, b);
    float mean = 0.0f;
    if (PAPER_WAVELETS(l)) {
        int translates = paper.table.w;
        for (int j = 0; j < translates; ++j) {
            for (int i = 0; i < translates; ++i) {
                PaperBands bands = paper_bands_at(l, cell, i, j);
                mean += paper_partial(bands.c.y, bands.block.y, w) +
                        paper_partial(bands.c.z, bands.block.z, w) +
                        paper_partial(bands.c.w, bands.block.w, w);
            }
        }
    } else {
        for (int j = 0; j <= FOG_DEGREE; ++j) {
            for (int i = 0; i <= FOG_DEGREE; ++i) {
                mean += paper_partial(paper_coefficients(l, ivec2(cell.x - i, cell.y - j)).x,
                                      paper.first_block.x + j * (FOG_DEGREE + 1) + i, w);
            }
        }
    }
    return mean;
}

// Mean of the height profile from t to next.
float paper_height(FogRay ray, float t, float next) {
#if FOG_PROFILE == FOG_EXPONENTIAL
    float e0 = max(ray.eta + ray.rise * t, 0.0f);
    float e1 = max(ray.eta + ray.rise * next, 0.0f);
    float d = e1 - e0;
    // (1 - exp(-d)) / d without cancellation.
    float fall = abs(d) < 0.03f ? 1.0f - d * (0.5f - d * (1.0f / 6.0f)) : (1.0f - exp(-d)) / d;
    return exp(-e0) * fall;
#elif FOG_PROFILE == FOG_LINEAR
    return 0.5f * (clamp(1.0f - ray.eta - ray.rise * t, 0.0f, 1.0f) +
                   clamp(1.0f - ray.eta - ray.rise * next, 0.0f, 1.0f));
#else
    return 1.0f;
#endif
}

// Integral of detail level l (0: the approximation) over t in [from, to].
float paper_level(FogRay ray, int l, float from, float to) {
    int e = fog.base.z - l;
    float per_level = 1.0f / float(1 << e);
    ivec2 base = ivec2(fog.base.x >> e, fog.base.y >> e);
    vec2 o = (ray.origin + vec2(float(fog.base.x - (base.x << e)), float(fog.base.y - (base.y << e)))) *
             per_level;
    vec2 g = ray.slope * per_level;
    vec2 per_cell = vec2(g.x == 0.0f ? FOG_FAR : 1.0f / g.x, g.y == 0.0f ? FOG_FAR : 1.0f / g.y);
    vec2 forward = vec2(g.x < 0.0f ? -1.0f : 1.0f, g.y < 0.0f ? -1.0f : 1.0f);
    vec2 face = max(forward, vec2(0.0f)) - o;
    float per_length = 1.0f / max(length(g), 1.0e-30f);
    ivec2 enter_face = ivec2(g.x < 0.0f ? 1 : 0, g.y < 0.0f ? 3 : 2);

    vec2 k = floor(o + g * from);
    vec2 cross = (k + face) * per_cell;
    float t = from;
    float sum = 0.0f;
    // The first path begins inside a cell, then come whole cells, the last path ends inside one.
    float next = max(min(min(cross.x, cross.y), to), t);
    vec2 a = clamp(o + g * t - k, 0.0f, 1.0f);
    vec2 b = clamp(o + g * next - k, 0.0f, 1.0f);
    sum += paper_cell_partial(l, ivec2(int(k.x), int(k.y)) + base, a, b) * (next - t) *
           paper_height(ray, t, next);
    t = next;
    while (t < to) {
        bool along_x = cross.x <= cross.y;
        int enter = along_x ? enter_face.x : enter_face.y;
        k = vec2(along_x ? k.x + forward.x : k.x, along_x ? k.y : k.y + forward.y);
        cross = (k + face) * per_cell;
        next = max(min(cross.x, cross.y), t);
        if (next >= to) {
            break;
        }
        // The faces opposite to those by which a ray in this direction enters.
        int leave = cross.x <= cross.y ? 1 - enter_face.x : 5 - enter_face.y;
        a = clamp(o + g * t - k, 0.0f, 1.0f);
        b = clamp(o + g * next - k, 0.0f, 1.0f);
        PaperPath path = paper_whole(enter, a, leave, b, next - t, per_length);
        sum += paper_cell_whole(l, ivec2(int(k.x), int(k.y)) + base, path) *
               paper_height(ray, t, next);
        t = next;
    }
    a = clamp(o + g * t - k, 0.0f, 1.0f);
    b = clamp(o + g * to - k, 0.0f, 1.0f);
    sum += paper_cell_partial(l, ivec2(int(k.x), int(k.y)) + base, a, b) * (to - t) *
           paper_height(ray, t, to);
    return sum;
}

float fog_paper(FogRay ray) {
    float tau_per_sum = fog.scale.w * ray.metres;
    vec2 range = fog_clip(ray);
    float whole = ray.sky ? range.y : ray.last;
#if FOG_PROFILE == FOG_EXPONENTIAL
    range = fog_clip_axis(range, ray.eta, ray.rise, -FOG_FAR, FOG_ETA_MAX);
#endif
    float sum = 0.0f;
    for (int l = 0; l <= fog.base.z; ++l) {
        // d_max(l) = |OP| mu^l (eq. 12), counted from the eye.
        float to = l == 0 ? range.y : min(range.y, fog.reach[l].x * whole - fog.reach[l].y * ray.passed);
        if (to > range.x) {
            sum += paper_level(ray, l, range.x, to);
        }
#ifdef FOG_PAPER_SCALING
        // Section 4.4: enough fog. A later residual can be negative, so twice the depth that is invisible.
        if (sum * tau_per_sum > 2.0f * fog.limit.x) {
            break;
        }
#endif
    }
    return max(sum, 0.0f) * tau_per_sum;
}
