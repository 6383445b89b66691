// Optical depth of fogs given by formulas, all in closed form. Compiles as GLSL and as C++ (GLM).
// In: a segment start + path t, t in [0, 1], in metres from the eye. Each function returns a mean
// extinction over it; the double-precision twin and the papers' equations are in fogmap/models.h.
// The formulas are chosen for float32: none subtracts nearly equal numbers on level, short or very
// long rays. Sine and arc tangent are polynomials here, because GLSL promises 2^-11 for its own.

#define MODEL_PI 3.14159265358979f

// sin(2 pi x) for any x.
float model_sine(float x) {
    x -= floor(x + 0.5f);
    x = abs(x) > 0.25f ? (x < 0.0f ? -0.5f : 0.5f) - x : x;
    float a = 2.0f * MODEL_PI * x;
    float s = a * a;
    return a * (1.0f - s * (0.166666667f - s * (8.33333333e-3f - s * (1.98412698e-4f -
               s * (2.75573192e-6f - s * 2.50521084e-8f)))));
}

// Angle of (x, y) in [0, pi]; y >= 0, not both 0. Minimax polynomial up to tan(pi / 8).
float model_angle(float x, float y) {
    float r = min(abs(x), y) / max(abs(x), y);
    bool upper = r > 0.41421356f;
    float z = upper ? (r - 1.0f) / (r + 1.0f) : r;
    float s = z * z;
    float angle = z - z * s * (0.333329491539f - s * (0.199777106478f - s * (0.138776856032f -
                  s * 8.05374449538e-2f)));
    angle += upper ? 0.25f * MODEL_PI : 0.0f;
    angle = y > abs(x) ? 0.5f * MODEL_PI - angle : angle;
    return x < 0.0f ? MODEL_PI - angle : angle;
}

#include "fog_separable.glsl"

// Constant and linear density behind a plane (Lengyel, eq. 5 and 13), by the depths a and b of the
// segment's ends; `along` is normal . path.
float model_halfspace(vec4 plane, vec4 density, vec3 start, float along) {
    vec3 normal = vec3(plane.x, plane.y, plane.z);
    float a = -(plane.w + dot(normal, start));
    float b = a - along;
    float inside = a >= 0.0f ? 1.0f : 0.0f;
    if (along != 0.0f) {
        inside = clamp(max(a, b) / abs(along), 0.0f, 1.0f);
    }
    return inside * (density.x + 0.5f * density.y * (max(a, 0.0f) + max(b, 0.0f)));
}

// The fog's fraction of the optical depth mean * metres, as a mean extinction again.
float model_fraction(vec4 density, float mean, float metres) {
    if (density.z == MODEL_FRACTION_EXP2) {
        return mean * mean * metres;
    }
    if (density.z == MODEL_FRACTION_LINEAR) {
        float left = 1.0f - max(mean * metres - density.w, 0.0f);
        return (left > 0.0f ? -log(min(left, 1.0f)) : MODEL_SATURATED) / metres;
    }
    return mean;
}

// One straight piece of a function of height.
float model_ramp(vec4 ramp, float y, float rise) {
    vec2 range = fog_clip_axis(vec2(0.0f, 1.0f), y, rise, ramp.x, ramp.y);
    float middle = clamp(y + 0.5f * rise * (range.x + range.y), ramp.x, ramp.y);
    return max(range.y - range.x, 0.0f) * (ramp.z + ramp.w * (middle - ramp.x));
}

float model_exponential(vec4 layer, float y, float path_y) {
    float eta = layer.x + layer.y * y;
    float rise = layer.y * path_y;
    float low = min(eta, eta + rise);
    float below = low < 0.0f ? 1.0f : 0.0f;
    if (rise != 0.0f) {
        below = clamp(-low / abs(rise), 0.0f, 1.0f);
    }
    float above = 1.0f - below;
    float z = above * abs(rise);
    float mean_decay = z > 0.0f ? fog_opacity(z) / z : 1.0f;
    return layer.z * (below + above * exp(-max(low, 0.0f)) * mean_decay);
}

// The mean of a cosine over some turns is the one in the middle times sin(h) / h, h half of them.
float model_wave(vec4 wave, float amplitude, vec3 start, vec3 path) {
    vec3 per_metre = vec3(wave.x, wave.y, wave.z);
    float turns = dot(per_metre, path);
    float middle = wave.w + dot(per_metre, start) + 0.5f * turns;
    float spread = turns == 0.0f ? 1.0f : model_sine(0.5f * turns) / (MODEL_PI * turns);
    return amplitude * model_sine(middle + 0.25f) * spread;
}

float model_power_sum(int i, float u) {
    vec4 a = models.coefficients[3 * i];
    vec4 b = models.coefficients[3 * i + 1];
    vec4 c = models.coefficients[3 * i + 2];
    float high = b.z + u * (b.w + u * (c.x + u * c.y));
    return a.x + u * (a.y + u * (a.z + u * (a.w + u * (b.x + u * (b.y + u * high)))));
}

// Mean of polynomial i from u to v: five Gauss nodes, exact to degree 9.
float model_polynomial_mean(int i, float u, float v) {
    float m = 0.5f * (u + v);
    float h = 0.5f * (v - u);
    return 0.284444444f * model_power_sum(i, m) +
           0.239314335f * (model_power_sum(i, m - 0.538469310f * h) +
                           model_power_sum(i, m + 0.538469310f * h)) +
           0.118463443f * (model_power_sum(i, m - 0.906179846f * h) +
                           model_power_sum(i, m + 0.906179846f * h));
}

// A bounded polynomial: the part of the segment inside its domain, or, where the domain repeats, the
// part up to its border, whole domains by their mean, and the rest.
float model_polynomial(int i, vec3 start, vec3 path) {
    vec4 place = models.polynomial[i];
    vec3 per_metre = vec3(place.x, place.y, place.z);
    float u = place.w + dot(per_metre, start);
    float du = dot(per_metre, path);
    if (models.coefficients[3 * i + 2].w == 0.0f) {
        vec2 range = fog_clip_axis(vec2(0.0f, 1.0f), u, du, -1.0f, 1.0f);
        float part = range.y - range.x;
        return part > 0.0f ? part * model_polynomial_mean(i, u + range.x * du, u + range.y * du) : 0.0f;
    }
    u -= 2.0f * floor(0.5f * (u + 1.0f));
    float border = du < 0.0f ? -1.0f : 1.0f;
    float size = abs(du);
    float first = min(abs(border - u), size);
    float left = size - first;
    float domains = floor(0.5f * left);
    float rest = left - 2.0f * domains;
    float near = model_polynomial_mean(i, u, u + border * first);
    float far = model_polynomial_mean(i, -border, -border + border * rest);
    float whole = models.coefficients[3 * i + 2].z;
    return size > 0.0f ? (first * near + 2.0f * domains * whole + rest * far) / size : near;
}

// Mean over w + v t of 1 / (e + |x|^2), positive there; all lengths in units of reach.
float model_inverse_square(vec3 w, vec3 v, float e) {
    vec3 side = vec3(w.y * v.z - w.z * v.y, w.z * v.x - w.x * v.z, w.x * v.y - w.y * v.x);
    float b = e + dot(w, w + v);
    float d = e * dot(v, v) + dot(side, side);
    float q = d / (b * b);
    if (b > 0.0f && abs(q) < 0.01f) {
        return (1.0f - q * ((1.0f / 3.0f) - q * (0.2f - q * (1.0f / 7.0f)))) / b;
    }
    float root = sqrt(abs(d));
    if (d > 0.0f) {
        return model_angle(b, root) / root;
    }
    float ends = (e + dot(w, w)) * (e + dot(w + v, w + v));
    return log((b + root) / sqrt(ends)) / root;
}

// The same over the part `range` of the segment, times the part's length.
float model_object_part(vec3 w, vec3 v, vec2 range, float e) {
    float part = range.y - range.x;
    return part > 0.0f ? part * model_inverse_square(w + v * range.x, v * part, e) : 0.0f;
}

// Fog around a point, a sphere or a line: beside a line the distance counts across it, beyond its
// ends from them; inside a sphere nothing changes.
float model_object(int i, vec3 start, vec3 path) {
    vec4 place = models.object[i];
    vec4 axis = models.object_axis[i];
    vec4 shape = models.object_shape[i];
    vec3 w = (start - vec3(place.x, place.y, place.z)) * shape.y;
    vec3 v = path * shape.y;
    float sum = 0.0f;
    if (axis.w > 0.0f) {
        vec3 direction = vec3(axis.x, axis.y, axis.z);
        float whole = axis.w * shape.y;
        float from = dot(w, direction);
        float slope = dot(v, direction);
        vec2 all = vec2(0.0f, 1.0f);
        sum += model_object_part(w, v, fog_clip_axis(all, from, slope, -FOG_FAR, 0.0f), 1.0f);
        sum += model_object_part(w - direction * from, v - direction * slope,
                                 fog_clip_axis(all, from, slope, 0.0f, whole), 1.0f);
        sum += model_object_part(w - direction * whole, v,
                                 fog_clip_axis(all, from, slope, whole, FOG_FAR), 1.0f);
        return shape.x * sum;
    }
    float radius = place.w * shape.y;
    float square = dot(v, v);
    vec3 side = vec3(w.y * v.z - w.z * v.y, w.z * v.x - w.x * v.z, w.x * v.y - w.y * v.x);
    float half_square = radius * radius - dot(side, side) / square;
    vec2 inside = vec2(0.0f, 0.0f);
    if (half_square > 0.0f) {
        float half_size = sqrt(half_square / square);
        float middle = -dot(w, v) / square;
        inside = vec2(clamp(middle - half_size, 0.0f, 1.0f), clamp(middle + half_size, 0.0f, 1.0f));
    }
    float e = 1.0f - radius * radius;
    sum += model_object_part(w, v, vec2(0.0f, inside.x), e);
    sum += model_object_part(w, v, vec2(inside.y, 1.0f), e);
    return shape.x * (sum + (inside.y - inside.x));
}

// The ray's way out of the plane. A ray that grazes it cancels what the normal and the path are rounded
// to, and constant fog ends there: so the pixel's place gives it, if there is one (z = 1).
float model_along(int i, vec3 path, vec3 place, float scale) {
    if (place.z == 0.0f) {
        return dot(vec3(models.plane[i].x, models.plane[i].y, models.plane[i].z), path);
    }
    vec4 high = models.plane_high[i];
    vec4 low = models.plane_low[i];
    return scale * (dot(vec3(high.x, high.y, high.z), place) + dot(vec3(low.x, low.y, low.z), place));
}

// The sum of all models from eye + start to eye + start + path, `metres` apart. The path is `scale`
// times the direction of the pixel at `place`, as in ViewBlock; 0 if it is not known.
float fog_models(vec3 start, vec3 path, float metres, vec3 place, float scale) {
    if (metres == 0.0f) {
        return 0.0f;
    }
    float mean = models.limit.y;
#if (FOG_MODEL_KINDS & MODEL_KIND_HALFSPACE) != 0
    for (int i = 0; i < models.count.x; ++i) {
        float density = model_halfspace(models.plane[i], models.plane_density[i], start,
                                        model_along(i, path, place, scale));
#if (FOG_MODEL_KINDS & MODEL_KIND_FRACTION) != 0
        density = model_fraction(models.plane_density[i], density, metres);
#endif
        mean += density;
    }
#endif
#if (FOG_MODEL_KINDS & MODEL_KIND_RAMP) != 0
    for (int i = 0; i < models.count.y; ++i) {
        mean += model_ramp(models.ramp[i], start.y, path.y);
    }
#endif
#if (FOG_MODEL_KINDS & MODEL_KIND_EXPONENTIAL) != 0
    for (int i = 0; i < models.count.z; ++i) {
        mean += model_exponential(models.exponential[i], start.y, path.y);
    }
#endif
#if (FOG_MODEL_KINDS & MODEL_KIND_WAVE) != 0
    for (int i = 0; i < models.count.w; ++i) {
        mean += model_wave(models.wave[i], models.wave_amplitude[i].x, start, path);
    }
#endif
#if (FOG_MODEL_KINDS & MODEL_KIND_POLYNOMIAL) != 0
    for (int i = 0; i < models.count_more.x; ++i) {
        mean += model_polynomial(i, start, path);
    }
#endif
#if (FOG_MODEL_KINDS & MODEL_KIND_OBJECT) != 0
    for (int i = 0; i < models.count_more.y; ++i) {
        mean += model_object(i, start, path);
    }
#endif
#if (FOG_MODEL_KINDS & (MODEL_KIND_MEANS | MODEL_KIND_WALK)) != 0
    for (int i = 0; i < models.count_more.z; ++i) {
        mean += model_separable(i, start, path, metres);
    }
#endif
    // Rounding may leave -1e-9 where subtracted fog is just 0.
    return max(mean, 0.0f) * metres;
}
