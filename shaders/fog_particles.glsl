// Optical depth of particles (paper 003): -log of the clarity, the product of 1 - opacity over all
// particles near the ray. Compiles as GLSL and as C++ (GLM). Metres from the eye.
// In: particle_tiles, a texel a tile of the screen: first entry and count; particle_list, two texels
// an entry: coarse place and 1 / radius; the rest of the place and the opacity at the centre.
//
// A small particle multiplies the rounding of its place, of the ray's direction and of the ray's end by
// the distance in radii. So all come in two parts, and the coarse ones of places and directions have so
// few binary digits that their products are exact in float32.

#define PARTICLE_LIST_WIDTH 2048
// The picture shows no difference below this clarity, a quarter of what T promises.
#define PARTICLE_LEAST_CLARITY 4e-7f
// Coarse directions are multiples of 1 / this.
#define PARTICLE_DIRECTION_STEPS 2048.0f
// Where a step's rounding counts, compilers must not take sums and products apart: Mesa's does, and a
// particle of 0.1 m in 112 m errs by 1.6e-5 in T. GLSL from 4.00 and GLSL ES from 3.20 can forbid it.
#define PARTICLE_PRECISE
#ifndef __cplusplus
#if __VERSION__ >= 400 || (defined(GL_ES) && __VERSION__ >= 320)
#undef PARTICLE_PRECISE
#define PARTICLE_PRECISE precise
#endif
#endif

// The ray leads from `start` along coarse + fine, and ends at end_coarse + end_fine from there.
struct ParticleRay {
    vec3 start;
    vec3 coarse;
    vec3 fine;
    vec3 end_coarse;
    vec3 end_fine;
};

// The first 12 of a number's 24 binary digits.
float particle_upper_half(float v) {
    return uintBitsToFloat(floatBitsToUint(v) & 0xfffff000u);
}

// The product and what its rounding left out (Dekker 1971).
vec2 particle_product(float a, float b) {
    float a_high = particle_upper_half(a);
    float b_high = particle_upper_half(b);
    PARTICLE_PRECISE float a_low = a - a_high;
    PARTICLE_PRECISE float b_low = b - b_high;
    PARTICLE_PRECISE float product = a * b;
    PARTICLE_PRECISE float rest = ((a_high * b_high - product) + a_low * b_high) + a_high * b_low;
    return vec2(product, rest + a_low * b_low);
}

// `reach` is 1 / (a + b depth), rounded: one step of Newton's method gives what is missing. The sum of
// the two parts of reach (a + b depth) is nearly 1; with the larger first, no difference is rounded.
float particle_reach_rest(float reach, float depth) {
    PARTICLE_PRECISE vec2 rise = particle_product(view.depth_line.z, depth);
    PARTICLE_PRECISE vec2 slope = particle_product(reach, rise.x);
    PARTICLE_PRECISE vec2 base = particle_product(reach, view.depth_line.x);
    PARTICLE_PRECISE float left = slope.x >= 0.5f ? (1.0f - slope.x) - base.x : (1.0f - base.x) - slope.x;
    left -= (slope.y + base.y) + reach * (rise.y + view.depth_line.y + view.depth_line.w * depth);
    return reach * left;
}

// The path is reach.x + reach.y times the direction of the pixel at `place`, as in ViewBlock; place.z is
// 0 if that is not known.
ParticleRay particle_ray(vec3 start, vec3 path, float metres, vec3 place, vec2 reach) {
    ParticleRay ray;
    ray.start = start;
    ray.coarse = vec3(0.0f);
    ray.fine = metres > 0.0f ? path / metres : vec3(0.0f);
    ray.end_coarse = path;
    ray.end_fine = vec3(0.0f);
    if (place.z != 0.0f) {
        PARTICLE_PRECISE vec4 high = view.ray_high[0] * place.x + view.ray_high[1] * place.y + view.ray_high[2];
        PARTICLE_PRECISE vec4 low = view.ray_low[0] * place.x + view.ray_low[1] * place.y + view.ray_low[2];
        PARTICLE_PRECISE vec4 coarse = floor(high * PARTICLE_DIRECTION_STEPS + 0.5f) / PARTICLE_DIRECTION_STEPS;
        PARTICLE_PRECISE vec4 fine = (high - coarse) + low;
        ray.coarse = vec3(coarse.x, coarse.y, coarse.z);
        ray.fine = vec3(fine.x, fine.y, fine.z);
        PARTICLE_PRECISE vec2 x = particle_product(reach.x, coarse.x);
        PARTICLE_PRECISE vec2 y = particle_product(reach.x, coarse.y);
        PARTICLE_PRECISE vec2 z = particle_product(reach.x, coarse.z);
        ray.end_coarse = vec3(x.x, y.x, z.x);
        ray.end_fine = vec3(x.y, y.y, z.y) + reach.x * ray.fine + reach.y * (ray.coarse + ray.fine);
    }
    return ray;
}

// The least distance counts, between the ray's ends.
float particle_opacity(vec4 coarse, vec4 fine, ParticleRay ray) {
    PARTICLE_PRECISE vec3 far = vec3(coarse.x, coarse.y, coarse.z);
    PARTICLE_PRECISE vec3 near = vec3(fine.x, fine.y, fine.z) - ray.start;
    vec3 place = far + near;
    PARTICLE_PRECISE vec3 past_end = (far - ray.end_coarse) + (near - ray.end_fine);
    PARTICLE_PRECISE vec3 direction = ray.coarse + ray.fine;
    float square = dot(direction, direction);
    float beyond = max(dot(past_end, direction), 0.0f) + min(dot(place, direction), 0.0f);
    PARTICLE_PRECISE vec3 side = cross(far, ray.coarse) + (cross(far, ray.fine) + cross(near, direction));
    float distance = square > 0.0f ? sqrt((dot(side, side) + beyond * beyond) / square) : length(place);
    return fine.w * max(1.0f - distance * coarse.w, 0.0f);
}

float fog_particles(ivec2 pixel, vec3 start, vec3 path, float metres, vec3 place, vec2 reach) {
    vec4 tile = texelFetch(particle_tiles, pixel / models.count_more.w, 0);
    int first = int(tile.x);
    int count = int(tile.y);
    ParticleRay ray = particle_ray(start, path, metres, place, reach);
    float tau = 0.0f;
    int i = first;
    // Once around, unless a colour sees a share of these particles alone.
    while (i < first + count && tau < models.limit.z) {
        float clarity = 1.0f;
        for (; i < first + count && clarity > PARTICLE_LEAST_CLARITY; ++i) {
            ivec2 at = ivec2(2 * (i % (PARTICLE_LIST_WIDTH / 2)), i / (PARTICLE_LIST_WIDTH / 2));
            clarity *= 1.0f - particle_opacity(texelFetch(particle_list, at, 0),
                                               texelFetch(particle_list, at + ivec2(1, 0), 0), ray);
        }
        tau -= log(max(clarity, 1e-30f));
    }
    return tau;
}
