// Look-ups of method radial in an exponential profile. Compiles as GLSL and as C++.
//
// Between two rows of the table, A_n tell the integral, the centre of mass and the second moment of the
// density: it is taken to be the polynomial that has them, which is integrated against the profile in
// closed form. Rows are read as far apart as the profile allows; those around the ray's ends one by one,
// and with RADIAL_STEP cell by cell.

#include "fog_radial_spans.glsl"

// Integral of (c.x + c.y y + c.z y^2) exp(-z y) over y in [0, 1].
float radial_damped(vec3 c, float z) {
    float rest = exp(-z);
    float m0 = (1.0f - rest) / z;
    float m1 = (m0 - rest) / z;
    float m2 = (2.0f * m1 - rest) / z;
    if (z < 0.5f) {
        // The closed forms cancel; the dropped terms are below 4e-6.
        m0 = 1.0f - z * (1.0f / 2.0f -
                         z * (1.0f / 6.0f - z * (1.0f / 24.0f - z * (1.0f / 120.0f - z * (1.0f / 720.0f)))));
        m1 = 1.0f / 2.0f -
             z * (1.0f / 3.0f -
                  z * (1.0f / 8.0f - z * (1.0f / 30.0f - z * (1.0f / 144.0f - z * (1.0f / 840.0f)))));
        m2 = 1.0f / 3.0f -
             z * (1.0f / 4.0f -
                  z * (1.0f / 10.0f - z * (1.0f / 36.0f - z * (1.0f / 168.0f - z * (1.0f / 960.0f)))));
    }
    return c.x * m0 + c.y * m1 + c.z * m2;
}

// A horizontal ray through the profile: exp(-steep |L - lowest|), L in metres from row 0.
struct RadialSlope {
    float steep;
    float lowest;
    bool rising;
};

// Integral of the density c.x + c.y y + c.z y^2 times the profile over L in [from, to], y in [0, 1] there.
float radial_piece(RadialSlope slope, vec3 c, float from, float to) {
    float h = to - from;
    float near = slope.rising ? from - slope.lowest : slope.lowest - to;
    c = slope.rising ? c : vec3(c.x + c.y + c.z, -c.y - 2.0f * c.z, c.z);
    return max(exp(-slope.steep * near) * h * radial_damped(c, slope.steep * h), 0.0f);
}

// A_n at a row.
vec3 radial_row(RadialPlace place, int row, float along) {
    ivec2 texel = ivec2(place.column, row + place.first_row);
    vec4 left = texelFetch(radial_table, texel, 0);
    vec4 right = texelFetch(radial_table, ivec2(min(texel.x + 1, radial.size.x - 1), texel.y), 0);
    vec4 means = left + place.blend * (right - left);
    float half_along = 0.5f * along;
    return along * vec3(means.x, half_along * means.y, half_along * (1.0f / 3.0f) * along * means.z);
}

// The row before a place that is not the last.
int radial_row_before(float along) {
    float root = sqrt(along + radial.radius.z) - radial.radius.w;
    return clamp(int(root / radial.rows.x), 0, radial.size.y - 2);
}

// The density from row a to row b, d metres on, as a polynomial in y = 0 at a, 1 at b: the one with its
// integral, its centre of mass and, if `curved`, its second moment. Far integrals cancel: float32
// leaves the centre 2e-7 (L/d)^2 of the density, and the second moment 6e-7 (L/d)^3.
vec3 radial_density(vec3 at_a, vec3 at_b, float d, bool curved) {
    float per_d = 1.0f / d;
    float mass = max(at_b.x - at_a.x, 0.0f);
    float first = (at_b.y - at_a.y) * per_d - at_a.x;
    float second = ((at_b.z - at_a.z) * per_d - at_a.y) * per_d - 0.5f * at_a.x;
    // Coefficients of Legendre's polynomials, where the density is not negative.
    float c1 = clamp(3.0f * (mass - 2.0f * first), -3.0f * mass, 3.0f * mass);
    float c2 = clamp(5.0f * (mass - 6.0f * first + 12.0f * second), -5.0f * mass, 5.0f * mass);
    c2 = curved ? c2 : 0.0f;
    return per_d * vec3(mass - c1 + c2, 2.0f * c1 - 6.0f * c2, 6.0f * c2);
}

#ifdef RADIAL_STEP
// Integral of density times profile over [from, to], behind a row and before the next: cell by cell.
float radial_profile_step(RadialPlace place, RadialSlope slope, int row, float from, float to) {
    int l = radial_level(place, row);
    ivec4 level = fog.level[l];
    FogGrid grid = fog_grid(vec2(fog.eye.x, fog.eye.y), place.slope, l);
    vec2 half_g = 0.5f * grid.g;
    float twist = half_g.x * half_g.y;
    float start = radial.radius.x;
    vec2 inside = radial_inside(vec2(start + from, start + to), place.slope);
    float t = inside.x;
    vec2 k = radial_cell(grid, t);
    float sum = 0.0f;
    while (t < inside.y) {
        vec2 cross = (k + grid.face) * grid.per_cell;
        float leave = min(max(min(cross.x, cross.y), t), inside.y);
        // fog_moments() takes one unit of height.
        float next = slope.steep * (leave - t) > 1.0f ? t + 1.0f / slope.steep : leave;
        float dt = next - t;
        FogMoments h = fog_moments(slope.steep * abs(t - start - slope.lowest),
                                   slope.steep * abs(next - start - slope.lowest));
        vec2 m = grid.o + half_g * (t + next) - k;
        FogCell cell = fog_fetch(level, k + grid.first);
        sum += max(fog_mean(cell, m, half_g * dt, twist * (dt * dt), h), 0.0f) * dt;
        // Rounding may put the first cell behind the ray: its step has no length and the next cell follows.
        bool crossed = next == leave;
        k = crossed ? radial_next_cell(grid, k, cross, next) : k;
        t = crossed || next > t ? next : inside.y;
    }
    return sum;
}
#endif

// Integral of density times profile over L in [from, to], from row to row.
float radial_profile(RadialPlace place, RadialSlope slope, float from, float to) {
    vec2 spacing = radial_spacing();
    float length = radial.radius.y;
    float until = min(to, length);
    float per_steep = 1.0f / max(slope.steep, 1.0e-20f);
    int row = radial_row_before(from);
    int row_before_end = radial_row_before(until);
    float a = radial_distance(spacing, row);
    float at = from;
    vec3 at_a = radial_row(place, row, a);
    float sum = 0.0f;
    while (at < until) {
        float height = slope.steep * abs(at - slope.lowest);
        float width = radial_width + radial_widen * height;
        width = slope.rising ? width : width * (1.0f / (1.0f + radial_widen));
        int next = max(radial_row_before(min(at + width * per_steep, length)), row + 1);
        // Rows that the ray's ends lie between stand alone.
        next = row < row_before_end ? min(next, row_before_end) : row + 1;
        next = at > a ? row + 1 : next;
        float b = radial_distance(spacing, next);
        vec3 at_b = radial_row(place, next, b);
        float upto = min(b, until);
        bool partial = at > a || b > until;
        // A whole stretch over which the profile changes little hardly feels the second moment's noise.
        bool curved = !partial && b - a > radial_curved_part * b && slope.steep * (b - a) < radial_curved_change;
        vec3 c = radial_density(at_a, at_b, b - a, curved);
        if (partial) {
            // The polynomial on [at, upto].
            float per_d = 1.0f / (b - a);
            c = vec3(c.x + (at - a) * per_d * c.y, (upto - at) * per_d * c.y, 0.0f);
        }
#ifdef RADIAL_STEP
        float near = slope.steep * (slope.rising ? at - slope.lowest : slope.lowest - upto);
        bool walks = next == row + 1 && (partial || slope.steep * (b - a) > 1.0f) && near < radial_nearby;
        sum += walks ? radial_profile_step(place, slope, row, at, upto) : radial_piece(slope, c, at, upto);
#else
        sum += radial_piece(slope, c, at, upto);
#endif
        row = next;
        a = b;
        at_a = at_b;
        at = b;
    }
#ifdef FOG_REPEAT
    // After many periods the mean stays.
    if (to > length) {
        float mean = radial_row(place, radial.size.y - 1, length).x / length;
        sum += radial_piece(slope, vec3(mean, 0.0f, 0.0f), max(from, length), to);
    }
#endif
    return sum;
}

// Integral of density times profile over t in [0, end].
float radial_exponential(RadialPlace place, float eta, float rise, float end) {
    // Before the first row and behind the last there is no fog.
    float start = radial.radius.x;
    float first = start / place.r;
#ifndef FOG_REPEAT
    end = min((start + radial.radius.y) / place.r, end);
#endif
    if (first >= end) {
        return 0.0f;
    }
    bool rising = rise >= 0.0f;
    float low = min(eta + rise * first, eta + rise * end);
    float base = rise == 0.0f ? (eta < 0.0f ? end : first) : clamp(-eta / rise, first, end);
    float sum = 0.0f;
    vec2 above = vec2(first, end);
    if (low < 0.0f) {
        // Below the base the profile is 1.
        above = rising ? vec2(base, end) : vec2(first, base);
        float at_base = radial_integrals(place, base).x;
        sum = rising ? at_base : radial_integrals(place, end).x - at_base;
    }
    float reach = radial_top / max(abs(rise), 1.0e-20f);
    float lowest = rising ? above.x : above.y;
    above = rising ? vec2(above.x, min(above.x + reach, above.y)) : vec2(max(above.x, above.y - reach), above.y);
    above = place.r * above - start;
    RadialSlope slope;
    slope.steep = abs(rise) / place.r;
    slope.lowest = place.r * lowest - start;
    slope.rising = rising;
    return sum + radial_profile(place, slope, max(above.x, 0.0f), above.y) * exp(-max(low, 0.0f)) / place.r;
}
