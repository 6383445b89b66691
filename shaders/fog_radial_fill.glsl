// Filling the table of method radial (fog_radial.glsl). Compiles as GLSL and as C++; the includer
// defines radial_store(column, row, values).
// With RADIAL_SEGMENTS what is stored of a row are the integrals of the metres since the row before
// alone, for radial_scan.frag to join; else the table's means.

// Stores the rows begin..end-1 of one column of the table of levels 0..finest, walking outwards from
// row begin - 1. `first` is the table's first row.
void radial_walk(int column, int first, int finest, int begin, int end) {
    vec2 direction = radial_direction(radial.azimuth.x + radial.azimuth.y * float(column));
    vec2 slope = direction * (1.0f / length(direction)) * vec2(fog.scale.x, fog.scale.y);
    float start = radial.radius.x;
    vec2 inside = radial_inside(vec2(start, start + radial.radius.y), slope);
    vec2 origin = vec2(fog.eye.x, fog.eye.y);
    // Uniforms read inside the loop would be read anew each time.
    vec2 spacing = radial_spacing();
    float at = start + radial_distance(spacing, max(begin - 1, 0));
#if FOG_PROFILE == FOG_UNIFORM
    float enough = radial.stop.x;
#endif
    vec3 reached = vec3(0.0f);
    int row = begin;
#ifdef RADIAL_SEGMENTS
    int finer_rows = 0;  // that finer levels have
#endif
    for (int l = finest; l >= 0; --l) {
        int stop = min(radial.level[l].x, end);
#ifdef RADIAL_SEGMENTS
        int level_begin = finer_rows;
        finer_rows = max(finer_rows, radial.level[l].x);
#endif
        if (row >= stop) {
            continue;
        }
        ivec4 level = fog.level[l];
        FogGrid grid = fog_grid(origin, slope, l);
        float twist = grid.g.x * grid.g.y;
        float t = clamp(at, inside.x, inside.y);
        vec2 k = radial_cell(grid, t);
#ifdef RADIAL_SEGMENTS
        // A step's sign is that of all since the cell's or the level's entry: it starts there, and what
        // the row before has of it is taken off.
        float begun = t;
        float level_start = start + radial_distance(spacing, max(level_begin - 1, 0));
        vec2 enter = (k + grid.face - grid.forward) * grid.per_cell;
        t = min(t, max(max(enter.x, enter.y), clamp(level_start, inside.x, inside.y)));
#endif
        FogLine line = radial_line(grid, level, k, t, twist);
        if (row == 0) {
            // Every mean begins with the density where the walk begins.
            float density = inside.x == start && inside.y > start ? max(line.s0, 0.0f) : 0.0f;
            radial_store(column, first, vec3(density));
            row = 1;
        }
#ifdef RADIAL_SEGMENTS
        vec3 before = radial_step(line, begun - t);
#endif
        vec2 cross = (k + grid.face) * grid.per_cell;
        float next = max(min(cross.x, cross.y), t);
        vec3 sum = reached;
        for (; row < stop; ++row) {
            float along = radial_distance(spacing, row);
            float to = start + along;
            float until = clamp(to, inside.x, inside.y);
            // Whole cells up to the row, then a part of one; `sum` and t stay at the cell's entry.
            while (next < until) {
                float d = next - t;
                sum = radial_join(sum, radial_step(line, d), d);
                k = radial_next_cell(grid, k, cross, next);
                t = next;
                line = radial_line(grid, level, k, t, twist);
                cross = (k + grid.face) * grid.per_cell;
                next = max(min(cross.x, cross.y), t);
            }
            float d = max(until - t, 0.0f);
            reached = radial_join(sum, radial_step(line, d), d);
            vec3 here = reached;
#if RADIAL_ORDER > 1
            // Behind the map the higher integrals still grow. (Before it all are 0.)
            here = radial_join(here, vec3(0.0f), to - max(until, start));
#endif
#if FOG_PROFILE == FOG_UNIFORM
            // No ray is shorter than its horizontal part: nothing is seen through this much fog.
            inside.y = here.x > enough ? to : inside.y;
#endif
            at = to;
#ifdef RADIAL_SEGMENTS
            here = radial_join(-before, here, to - begun);
#else
            here = radial_means(here, along);
#endif
            radial_store(column, first + row, here);
        }
    }
}
