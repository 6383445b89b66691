// Optical depth by one walk through one grid at a time: method `exact`. Compiles as GLSL and C++.
//
// The mu rule (paper 004, eq. 12) keeps detail level l up to the distance |OP| mu^l. So between
// |OP| mu^(l+1) and |OP| mu^l the density is the approximation that holds levels 0..l: the walk uses
// that approximation's grid there and never sums levels. A step ends where the ray leaves a cell, a
// level's reach or a layer of the height profile (integer eta); its integral is in closed form
// (fog_cell.glsl) and clamped at 0, because approximations of degree >= 1 can be negative. The walk
// stops when the remaining transmittance cannot be seen.

// The cell of a level; `texel` counts texels of the atlas (of cells for degree 2, which has three side by
// side). Every level has a border of empty texels, so that rounding at the box's faces reads nothing
// strange.
FogCell fog_fetch(ivec4 level, vec2 texel) {
    FogCell cell;
#ifdef FOG_REPEAT
    vec2 period = vec2(float(level.z), float(level.w));
    vec2 first = vec2(FOG_DEGREE == 2 ? 0.0f : float(level.x), float(level.y));
    texel = texel - period * floor((texel - first + 0.5f) / period);
#endif
#if FOG_DEGREE == 2
    // One cell on, so that the border's -1 is not truncated to 0.
    ivec2 p = ivec2(level.x + 3 * int(texel.x + 1.0f) - 3, int(texel.y));
    cell.row0 = texelFetch(fog_cells, p, 0);
    cell.row1 = texelFetch(fog_cells, ivec2(p.x + 1, p.y), 0);
    cell.row2 = texelFetch(fog_cells, ivec2(p.x + 2, p.y), 0);
#else
    cell.c = texelFetch(fog_cells, ivec2(int(texel.x), int(texel.y)), 0);
#endif
    return cell;
}

// A ray in the cells of one level, counted from the cell that fog.base lies in.
struct FogGrid {
    vec2 o;         // origin
    vec2 g;         // slope
    vec2 per_cell;  // t per cell
    vec2 forward;   // +-1
    vec2 face;      // t at which the ray leaves column k is (k + face) per_cell
    vec2 first;     // texel of cell 0 (degree 2: cells along x)
};

FogGrid fog_grid(vec2 origin, vec2 slope, int l) {
    ivec4 level = fog.level[l];
    int e = fog.base.z - l;
    float per_level = 1.0f / float(1 << e);
    ivec2 whole = ivec2(fog.base.x >> e, fog.base.y >> e);
    vec2 base = vec2(float(whole.x), float(whole.y));
    FogGrid grid;
    grid.o = (origin + vec2(float(fog.base.x - (whole.x << e)), float(fog.base.y - (whole.y << e)))) *
             per_level;
    grid.g = slope * per_level;
    grid.per_cell =
        vec2(grid.g.x == 0.0f ? FOG_FAR : 1.0f / grid.g.x, grid.g.y == 0.0f ? FOG_FAR : 1.0f / grid.g.y);
    grid.forward = vec2(grid.g.x < 0.0f ? -1.0f : 1.0f, grid.g.y < 0.0f ? -1.0f : 1.0f);
    grid.face = max(grid.forward, vec2(0.0f)) - grid.o;
    grid.first = base + vec2(FOG_DEGREE == 2 ? 0.0f : float(level.x), float(level.y));
    return grid;
}

// Integral of density * height over t in [from, to] on level l's grid; stops beyond `enough`.
// There is no branch on the cell: an empty one has a negative "density", which the clamp turns into 0,
// and with FOG_SKIP a radius by which the step is longer.
float fog_walk(FogRay ray, int l, float from, float to, float enough) {
    ivec4 level = fog.level[l];
    FogGrid grid = fog_grid(ray.origin, ray.slope, l);
    vec2 half_g = 0.5f * grid.g;
    float twist = half_g.x * half_g.y;
    vec2 k = floor(grid.o + grid.g * from);
#ifdef FOG_LAYERED
    float up = ray.rise < 0.0f ? -1.0f : 1.0f;
    float per_rise = ray.rise == 0.0f ? FOG_FAR : 1.0f / ray.rise;
    float at = ray.eta + ray.rise * from;
    float plane = ray.rise < 0.0f ? ceil(at) - 1.0f : max(floor(at) + 1.0f, 0.0f);
    float plane_t = plane < 0.0f || ray.rise == 0.0f ? FOG_FAR : (plane - ray.eta) * per_rise;
#endif

    float t = from;
    float sum = 0.0f;
    while (t < to) {
        FogCell cell = fog_fetch(level, k + grid.first);
#ifdef FOG_SKIP
        // The square of cells k - radius .. k + radius is empty.
        float radius = max(-FOG_EMPTY - FOG_FIRST(cell), 0.0f);
        vec2 cross = (k + grid.forward * radius + grid.face) * grid.per_cell;
#else
        vec2 cross = (k + grid.face) * grid.per_cell;
#endif
        float next = min(min(cross.x, cross.y), to);
#ifdef FOG_LAYERED
        next = min(next, plane_t);
#endif
        float dt = next - t;
        vec2 m = grid.o + half_g * (t + next) - k;
#ifdef FOG_LAYERED
        FogMoments h = fog_moments(ray.eta + ray.rise * t, ray.eta + ray.rise * next);
#else
        FogMoments h = fog_moments(0.0f, 0.0f);
#endif
        sum += max(fog_mean(cell, m, half_g * dt, twist * (dt * dt), h), 0.0f) * dt;

        // A crossed face gives the new index exactly; after a long step the other axis is looked up,
        // inside the square.
#ifdef FOG_SKIP
        vec2 stay = clamp(floor(grid.o + grid.g * next), k - radius, k + radius);
        vec2 beyond = k + grid.forward * (radius + 1.0f);
#else
        vec2 stay = k;
        vec2 beyond = k + grid.forward;
#endif
        k = vec2(cross.x <= next ? beyond.x : stay.x, cross.y <= next ? beyond.y : stay.y);
#ifdef FOG_LAYERED
        plane = plane_t <= next ? plane + up : plane;
        plane_t = plane < 0.0f || ray.rise == 0.0f ? FOG_FAR : (plane - ray.eta) * per_rise;
#endif
        t = sum > enough ? to : next;
    }
    return sum;
}

float fog_exact(FogRay ray) {
    float tau_per_sum = fog.scale.w * ray.metres;
    float enough = fog.limit.x / max(tau_per_sum, 1.0e-20f);
    vec2 range = fog_clip(ray);
    float whole = ray.sky ? range.y : ray.last;
#if FOG_PROFILE == FOG_EXPONENTIAL
    range = fog_clip_axis(range, ray.eta, ray.rise, -FOG_FAR, FOG_ETA_MAX);
#endif
    float sum = 0.0f;
    float from = range.x;
    for (int l = fog.base.z; l >= 0; --l) {
        if (from >= range.y || sum > enough) {
            break;
        }
        // mu^l (passed + whole) - passed, without the cancellation
        float to = l == 0 ? range.y : min(range.y, fog.reach[l].x * whole - fog.reach[l].y * ray.passed);
        if (to > from) {
            sum += fog_walk(ray, l, from, to, enough - sum);
            from = to;
        }
    }
    return sum * tau_per_sum;
}
