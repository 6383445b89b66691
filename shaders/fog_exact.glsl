// Optical depth by one walk through one grid at a time: method `exact`. Compiles as GLSL and C++.
//
// The mu rule (paper 004, eq. 12) keeps detail level l up to the distance |OP| mu^l. So between
// |OP| mu^(l+1) and |OP| mu^l the density is the approximation that holds levels 0..l: the walk uses
// that approximation's grid there and never sums levels. Each cell's polynomial is integrated in
// closed form (fog_cell.glsl); empty blocks are crossed in one step; a step's integral is clamped at
// 0, because approximations of degree >= 1 can be negative; the walk stops when the remaining
// transmittance cannot be seen.

FogCell fog_fetch(ivec4 level, ivec2 k) {
    FogCell cell;
#if FOG_DEGREE == 2
    ivec2 p = ivec2(level.x + 3 * k.x, level.y + k.y);
    cell.row0 = texelFetch(fog_cells, p, 0);
    cell.row1 = texelFetch(fog_cells, ivec2(p.x + 1, p.y), 0);
    cell.row2 = texelFetch(fog_cells, ivec2(p.x + 2, p.y), 0);
#else
    cell.c = texelFetch(fog_cells, ivec2(level.x + k.x, level.y + k.y), 0);
#endif
    return cell;
}

// Index of a cell in its level's part of the atlas. `k` counts from the base cell.
ivec2 fog_index(ivec4 level, ivec2 k, ivec2 base) {
    ivec2 index = k + base;
#ifdef FOG_REPEAT
    index = ivec2(index.x % level.z, index.y % level.w);
    index = ivec2(index.x < 0 ? index.x + level.z : index.x, index.y < 0 ? index.y + level.w : index.y);
#endif
    return index;
}

// Integral of density * height over t in [from, to] on level l's grid; stops beyond `enough`.
float fog_walk(FogRay ray, int l, float from, float to, float enough) {
    ivec4 level = fog.level[l];
    int e = fog.base.z - l;
    float cell_size = float(1 << e);
    ivec2 base = ivec2(fog.base.x >> e, fog.base.y >> e);
    vec2 o = (ray.origin + vec2(float(fog.base.x - (base.x << e)), float(fog.base.y - (base.y << e)))) /
             cell_size;
    vec2 g = ray.slope / cell_size;
    vec2 per_cell = vec2(g.x == 0.0f ? FOG_FAR : 1.0f / g.x, g.y == 0.0f ? FOG_FAR : 1.0f / g.y);
    vec2 ahead = vec2(g.x < 0.0f ? 0.0f : 1.0f, g.y < 0.0f ? 0.0f : 1.0f);
#if FOG_PROFILE == FOG_EXPONENTIAL || FOG_PROFILE == FOG_LINEAR
    float corner = ray.rise == 0.0f ? FOG_FAR : -ray.eta / ray.rise;
#endif

    vec2 p = o + g * from;
    ivec2 k = ivec2(int(floor(p.x)), int(floor(p.y)));
#ifndef FOG_REPEAT
    k = clamp(k, -base, ivec2(level.z - 1, level.w - 1) - base);
#endif
    float t = from;
    float sum = 0.0f;
    for (int i = 0; i < FOG_MAX_STEPS; ++i) {
        ivec2 index = fog_index(level, k, base);
        FogCell cell = fog_fetch(level, index);
        bool empty = FOG_FIRST(cell) < -0.5f * FOG_EMPTY;
        ivec2 low = k;
        int size = 1;
        if (empty) {
            size = 1 << (int(FOG_FIRST(cell) * (-1.0f / FOG_EMPTY)) - 1);
            low = k - ivec2(index.x & (size - 1), index.y & (size - 1));
        }
        vec2 corner0 = vec2(float(low.x), float(low.y));
        vec2 cross = (corner0 + ahead * float(size) - o) * per_cell;
        float next = min(min(cross.x, cross.y), to);
#if FOG_PROFILE == FOG_EXPONENTIAL || FOG_PROFILE == FOG_LINEAR
        next = t < corner ? min(next, corner) : next;
#endif
        next = max(next, t);
        vec2 q = o + g * next;
        if (!empty) {
            vec2 a = p - corner0;
            vec2 b = q - corner0;
#if FOG_PROFILE == FOG_EXPONENTIAL || FOG_PROFILE == FOG_LINEAR
            float mean = fog_mean_height(cell, a, b, ray.eta + ray.rise * t, ray.eta + ray.rise * next);
#else
            float mean = fog_mean(cell, a, b);
#endif
            sum += max(mean, 0.0f) * (next - t);
        }
        if (next >= to || sum > enough) {
            break;
        }
        // Crossed faces set the new index exactly; the other axis stays inside the block.
        ivec2 last = low + ivec2(size - 1, size - 1);
        ivec2 inside = clamp(ivec2(int(floor(q.x)), int(floor(q.y))), low, last);
        k = ivec2(cross.x <= next ? (g.x < 0.0f ? low.x - 1 : last.x + 1) : inside.x,
                  cross.y <= next ? (g.y < 0.0f ? low.y - 1 : last.y + 1) : inside.y);
#ifndef FOG_REPEAT
        ivec2 at = k + base;
        if (at.x < 0 || at.y < 0 || at.x >= level.z || at.y >= level.w) {
            break;
        }
#endif
        t = next;
        p = q;
    }
    return sum;
}

float fog_exact(FogRay ray) {
    float tau_per_sum = fog.scale.w * ray.metres;
    float enough = fog.limit.x / max(tau_per_sum, 1.0e-20f);
    vec2 range = fog_clip(ray, vec2(0.0f, ray.last));
#if FOG_PROFILE == FOG_EXPONENTIAL
    range = fog_clip_axis(range, ray.eta, ray.rise, -FOG_FAR, FOG_ETA_MAX);
#endif
    float sum = 0.0f;
    float from = range.x;
    for (int l = fog.base.z; l >= 0; --l) {
        float to = l == 0 ? range.y : min(range.y, fog.reach[l].x - ray.passed);
        if (to > from && sum <= enough) {
            sum += fog_walk(ray, l, from, to, enough - sum);
            from = to;
        }
    }
    return sum * tau_per_sum;
}
