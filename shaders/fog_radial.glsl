// Method radial: a table of the fog around the eye, and its look-up. Compiles as GLSL and as C++.
//
// All rays of a frame start at the eye and the fog does not vary with y inside a height profile, so
// that the integral along a ray depends on its azimuth and its horizontal length r alone. Column i
// of the table is an azimuth, row j a horizontal distance L from `radial.radius.x` on; its channels
// are the n-fold integrals of the density along the azimuth,
//   A_n(L) = integral of rho(x) (L - x)^(n-1) / (n-1)! over x in [0, L],
// as means m_n = n! A_n / L^n, which stay finite at L = 0 and are interpolated linearly. A slab
// needs two look-ups, a linear profile is integrated by parts, and for the exponential one
// (fog_radial_profile.glsl) the differences from row to row tell the density between them.
//
// With RADIAL_LAYERED (0 < mu < 1) there is a table for every level l, of the approximation that
// holds the levels 0..l, one below the other: level l serves between |OP| mu^(l+1) and |OP| mu^l
// (paper 004, eq. 12).
//
// Azimuths are counted without an angle: s / (f^2 + bend s^2) f for an offset f along `radial.axis`
// and s across it. With bend 0 it is the tangent, and the columns of a level camera are pixel
// columns; with 0.28 it is within 1 % of the angle up to 45 degrees, and a wide view counts from the
// nearest of four axes.
//
// With RADIAL_STEP a look-up takes the row at or before its place and walks the cells of the rest, so
// that rows add no error: what is left is the interpolation between azimuths.

#include "fog_radial_rows.glsl"
#include "fog_radial_walk.glsl"

// Horizontal vector (world x, z) of an azimuth coordinate: the inverse of radial_coordinate.
vec2 radial_direction(float a) {
    float bend = radial.axis.z;
    float quarter = 2.0f / (1.0f + bend);
    float turns = radial.axis.w != 0.0f ? floor(a / quarter + 0.5f) : 0.0f;
    float q = a - turns * quarter;
    float s = 2.0f * q / (1.0f + sqrt(max(1.0f - 4.0f * bend * q * q, 0.0f)));
    vec2 axis = vec2(radial.axis.x, radial.axis.y);
    axis = turns == 0.0f    ? axis
           : turns == 1.0f  ? vec2(-axis.y, axis.x)
           : turns == -1.0f ? vec2(axis.y, -axis.x)
                            : -axis;
    return axis + vec2(-axis.y, axis.x) * s;
}

// Azimuth coordinate of a horizontal offset from the eye, in any unit.
float radial_coordinate(vec2 offset) {
    float bend = radial.axis.z;
    float f = dot(offset, vec2(radial.axis.x, radial.axis.y));
    float s = dot(offset, vec2(-radial.axis.y, radial.axis.x));
    float product = s * f;
    float ff = f * f;
    float ss = s * s;
    float turns = 0.0f;
    if (radial.axis.w != 0.0f) {
        // The nearest of four axes; `turns` from the first, in quarters.
        bool side = ss > ff;
        turns = side ? 1.0f : f < 0.0f ? 2.0f : 0.0f;
        turns = s < 0.0f ? -turns : turns;
        product = side ? -product : product;
        float swapped = ff;
        ff = side ? ss : ff;
        ss = side ? swapped : ss;
    }
    return product / max(ff + bend * ss, 1.0e-30f) + turns * (2.0f / (1.0f + bend));
}

// Where a ray looks its integrals up.
struct RadialPlace {
    float r;  // horizontal length of the ray, m
    float u;  // texture u of its azimuth
    float v;  // what a level adds to texture v
#if FOG_PROFILE == FOG_EXPONENTIAL
    int column;     // the columns that its azimuth lies between: this and the next
    float blend;    // part of the next
    int first_row;  // of the level
#endif
#ifdef RADIAL_STEP
    vec2 slope;  // finest cells a metre
    int finest;  // level of the table
#endif
};

#ifdef RADIAL_STEP
// The level whose grid the table reads between a row and the next.
int radial_level(RadialPlace place, int row) {
    int l = place.finest;
    while (l > 0 && row + 1 >= radial.level[l].x) {
        --l;
    }
    return l;
}

// A_n of the density between a row, `from` metres from the eye, and `to`.
vec3 radial_last_step(RadialPlace place, int row, float from, float to) {
    int l = radial_level(place, row);
    ivec4 level = fog.level[l];
    FogGrid grid = fog_grid(vec2(fog.eye.x, fog.eye.y), place.slope, l);
    float twist = grid.g.x * grid.g.y;
    vec2 inside = radial_inside(vec2(from, to), place.slope);
    float t = inside.x;
    vec2 k = radial_cell(grid, t);
    vec3 sum = vec3(0.0f);
    while (t < inside.y) {
        vec2 cross = (k + grid.face) * grid.per_cell;
        float next = min(max(min(cross.x, cross.y), t), inside.y);
        FogLine line = radial_line(grid, level, k, t, twist);
        sum = radial_join(sum, radial_step(line, next - t), next - t);
        k = radial_next_cell(grid, k, cross, next);
        t = next;
    }
    return radial_join(sum, vec3(0.0f), to - inside.y);
}
#endif

// A_n from the eye to the fraction t of a ray, per unit of t: times the ray's length they are
// integrals along the ray.
vec3 radial_integrals(RadialPlace place, float t) {
    float beyond = max(place.r * t - radial.radius.x, 0.0f);
    float along = min(beyond, radial.radius.y);
    float root = sqrt(along + radial.radius.z);
#ifdef RADIAL_STEP
    vec2 spacing = radial_spacing();
    float row = min(floor(max(root - radial.radius.w, 0.0f) / spacing.x), float(radial.size.y - 1));
    root = radial.radius.w + spacing.x * row;
    float to = along;
    along = min(radial_distance(spacing, int(row)), to);
#endif
    float v = radial.rows.z + radial.rows.w * root + place.v;
    vec4 means = texture(radial_table, vec2(place.u, v));
#ifdef FOG_REPEAT
    // After many periods the means stay.
    along = beyond > radial.radius.y ? beyond : along;
#endif
    float w = along / place.r;
#if RADIAL_ORDER == 1
    vec3 sum = vec3(means.x * w, 0.0f, 0.0f);
#else
    float w2 = (1.0f / 2.0f) * w * w;
    vec3 sum = vec3(means.x * w, means.y * w2, means.z * (1.0f / 3.0f) * w * w2);
#endif
#ifdef RADIAL_STEP
    if (to > along) {
        float per_r = 1.0f / place.r;
        vec3 step = radial_last_step(place, int(row), radial.radius.x + along, radial.radius.x + to);
        sum = radial_join(sum, step * vec3(per_r, per_r * per_r, per_r * per_r * per_r),
                          (to - along) * per_r);
        along = to;
    }
#endif
    return radial_join(sum, vec3(0.0f), (beyond - along) / place.r);
}

#if FOG_PROFILE == FOG_EXPONENTIAL
#include "fog_radial_profile.glsl"
#endif

// Integral of density times profile over t in [0, end].
float radial_integral(RadialPlace place, float eta, float rise, float end) {
#if FOG_PROFILE == FOG_UNIFORM
    return radial_integrals(place, end).x;
#elif FOG_PROFILE == FOG_EXPONENTIAL
    return radial_exponential(place, eta, rise, end);
#else
    vec2 range = fog_clip_axis(vec2(0.0f, end), eta, rise, 0.0f, 1.0f);
    range.y = max(range.x, range.y);
    vec3 part = radial_integrals(place, range.y) - radial_integrals(place, range.x);
#if FOG_PROFILE == FOG_SLAB
    return part.x;
#else
    return clamp(1.0f - eta - rise * end, 0.0f, 1.0f) * radial_integrals(place, end).x + rise * part.y;
#endif
#endif
}

// Optical depth of a ray from the eye.
float fog_radial(FogRay ray) {
    vec2 offset = ray.slope * vec2(radial.cell.x, radial.cell.y);
    RadialPlace place;
    place.r = max(length(offset), 1.0e-20f);
    place.u = clamp(radial.azimuth.z + radial.azimuth.w * radial_coordinate(offset), radial.edge.x,
                    radial.edge.y);
    place.v = 0.0f;
#if FOG_PROFILE == FOG_EXPONENTIAL
    float column = max(place.u / (2.0f * radial.edge.x) - 0.5f, 0.0f);
    place.column = int(column);
    place.blend = column - floor(column);
    place.first_row = 0;
#endif
#ifdef RADIAL_STEP
    place.slope = ray.slope / place.r;
    place.finest = radial.size.w;
#endif
#ifdef RADIAL_LAYERED
    float whole = ray.sky ? max(fog_clip(ray).y, 0.0f) : ray.last;
    float sum = 0.0f;
    for (int l = 0; l <= fog.base.z; ++l) {
        place.v = radial.edge.z * float(l);
#if FOG_PROFILE == FOG_EXPONENTIAL
        place.first_row = radial.size.z * l;
#endif
#ifdef RADIAL_STEP
        place.finest = l;
#endif
        sum += radial_integral(place, ray.eta, ray.rise, whole * fog.reach[l].x);
        if (l < fog.base.z) {
            sum -= radial_integral(place, ray.eta, ray.rise, whole * fog.reach[l + 1].x);
        }
    }
#else
    float sum = radial_integral(place, ray.eta, ray.rise, 1.0f);
#endif
    return fog.scale.w * ray.metres * max(sum, 0.0f);
}
