// Products of tabulated functions of x, y and z (paper 001, sections 3.2.2 and 3.2.3). Compiles as GLSL
// and as C++ (GLM). A texel of model_tables holds a value, the step to the next one, and the integral
// from the table's begin as the sum of two floats, so that the difference of two integrals keeps its
// digits (eq. 7 divides it by a height that may be tiny).
// Places u on a table are counted in its cells from the eye's cell.

// Outside the table stands the table again, or its end value.
float separable_value(int k, float u) {
    vec4 axis = models.separable_axis[k];
    ivec4 row = models.separable_row[k];
    float cell = clamp(floor(u), -8388608.0f, 8388608.0f);
    float part = u - cell;
    int cells = int(axis.z);
    int i = row.x + int(cell);
    if (axis.w != 0.0f) {
        i -= cells * int(floor(float(i) / axis.z));
        i = i < 0 ? i + cells : i >= cells ? i - cells : i;
    } else if (i < 0 || i >= cells) {
        part = 0.0f;
        i = clamp(i, 0, cells);
    }
    vec4 texel = texelFetch(model_tables, ivec2(i, row.y), 0);
    return texel.x + part * texel.y;
}

float separable_difference(vec4 low, vec4 high) {
    return (high.z - low.z) + (high.w - low.w);
}

// Integral over whole cells, from <= to.
float separable_cells(int k, float from, float to) {
    vec4 axis = models.separable_axis[k];
    ivec4 row = models.separable_row[k];
    int cells = int(axis.z);
    int i = row.x + int(from);
    int j = row.x + int(to);
    int turns = 0;
    if (axis.w != 0.0f) {
        int before = int(floor(float(i) / axis.z));
        turns = int(floor(float(j) / axis.z)) - before;
        i -= cells * before;
        j -= cells * (before + turns);
    }
    vec4 low = texelFetch(model_tables, ivec2(i, row.y), 0);
    vec4 high = texelFetch(model_tables, ivec2(j, row.y), 0);
    if (turns == 0) {
        return separable_difference(low, high);
    }
    vec4 all = texelFetch(model_tables, ivec2(cells, row.y), 0);
    return separable_difference(low, all) + (high.z + high.w) + float(turns - 1) * (all.z + all.w);
}

// Mean from u to u + du. Each part is divided by the sum of the parts' own lengths, so that rounding
// moves weight between neighbours and changes no sum; level rays get the value.
float separable_mean(int k, float u, float du) {
    vec4 axis = models.separable_axis[k];
    if (axis.z == 0.0f) {
        return 1.0f;
    }
    float low = min(u, u + du);
    float high = max(u, u + du);
    float sum = 0.0f;
    float length = 0.0f;
    if (axis.w == 0.0f) {
        float first = -float(models.separable_row[k].x);
        float last = first + axis.z;
        float below = max(min(high, first) - low, 0.0f);
        float above = max(high - max(low, last), 0.0f);
        sum = below * separable_value(k, first) + above * separable_value(k, last);
        length = below + above;
        low = clamp(low, first, last);
        high = clamp(high, first, last);
    }
    float from = floor(low);
    float to = floor(high);
    if (from == to) {
        sum += (high - low) * separable_value(k, 0.5f * (low + high));
        length += high - low;
    } else {
        float before = from + 1.0f - low;
        float after = high - to;
        sum += before * separable_value(k, low + 0.5f * before) +
               separable_cells(k, from + 1.0f, to) + after * separable_value(k, to + 0.5f * after);
        length += before + (to - from - 1.0f) + after;
    }
    return length > 0.0f ? sum / length : separable_value(k, low);
}

// The product of an axis's function with the others is a cubic between two places where a table's line
// changes: two Gauss nodes are exact.
float separable_product(int s, vec3 u, vec3 du) {
    float value = 1.0f;
    for (int a = 0; a < 3; ++a) {
        if (models.separable_axis[3 * s + a].z != 0.0f) {
            value *= separable_value(3 * s + a, u[a] + du[a]);
        }
    }
    return value;
}

// Mean of the product over the segment; `enough` is one at which nothing is seen any more.
float separable_walk(int s, vec3 u, vec3 du, float enough) {
    vec2 range = vec2(0.0f, 1.0f);
    vec3 index = vec3(0.0f);   // of the next place where a table's line changes
    vec3 last = vec3(FOG_FAR);  // the last one there is, in the direction of the ray
    vec3 turn = vec3(FOG_FAR);  // its t
    for (int a = 0; a < 3; ++a) {
        vec4 axis = models.separable_axis[3 * s + a];
        if (axis.z == 0.0f) {
            continue;
        }
        float first = -float(models.separable_row[3 * s + a].x);
        float end = first + axis.z;
        if (axis.w == 0.0f) {
            // Nothing counts where a table ends with 0.
            float low = separable_value(3 * s + a, first) == 0.0f ? first : -FOG_FAR;
            float high = separable_value(3 * s + a, end) == 0.0f ? end : FOG_FAR;
            range = fog_clip_axis(range, u[a], du[a], low, high);
        }
        if (du[a] == 0.0f) {
            continue;
        }
        bool rising = du[a] > 0.0f;
        index[a] = rising ? floor(u[a]) + 1.0f : ceil(u[a]) - 1.0f;
        if (axis.w == 0.0f) {
            index[a] = rising ? max(index[a], first) : min(index[a], end);
            last[a] = rising ? end : -first;
        }
        turn[a] = (rising ? index[a] : -index[a]) <= last[a] ? (index[a] - u[a]) / du[a] : FOG_FAR;
    }
    float sum = 0.0f;
    float t = range.x;
    while (t < range.y && sum < enough) {
        float next = min(min(turn.x, turn.y), min(turn.z, range.y));
        if (next > t) {
            float part = (next - t) * 0.211324865f;
            sum += 0.5f * (next - t) * (separable_product(s, u, du * (t + part)) +
                                        separable_product(s, u, du * (next - part)));
            t = next;
        }
        for (int a = 0; a < 3; ++a) {
            if (turn[a] <= t) {
                index[a] += du[a] > 0.0f ? 1.0f : -1.0f;
                turn[a] = (du[a] > 0.0f ? index[a] : -index[a]) <= last[a]
                              ? (index[a] - u[a]) / du[a] : FOG_FAR;
            }
        }
    }
    return sum;
}

// Mean extinction over the segment, `metres` long.
float model_separable(int s, vec3 start, vec3 path, float metres) {
    vec4 shape = models.separable[s];
    vec3 u = vec3(0.0f);
    vec3 du = vec3(0.0f);
    for (int a = 0; a < 3; ++a) {
        vec4 axis = models.separable_axis[3 * s + a];
        u[a] = axis.x + axis.y * start[a];
        du[a] = axis.y * path[a];
    }
    float mean = 0.0f;
#if (FOG_MODEL_KINDS & MODEL_KIND_MEANS) != 0
    if (shape.y != 0.0f) {
        mean = separable_mean(3 * s, u.x, du.x) * separable_mean(3 * s + 1, u.y, du.y) *
               separable_mean(3 * s + 2, u.z, du.z);
    }
#endif
#if (FOG_MODEL_KINDS & MODEL_KIND_WALK) != 0
    if (shape.y == 0.0f) {
        mean = separable_walk(s, u, du, models.limit.z / (shape.x * metres));
    }
#endif
    return shape.x * mean;
}
