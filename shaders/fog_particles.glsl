// Optical depth of particles (paper 003): -log of the clarity, the product of 1 - opacity over all
// particles near the ray. Compiles as GLSL and as C++ (GLM). Metres from the eye.
// In: particle_tiles, a texel a tile of the screen: first entry and count; particle_list, two texels
// an entry: coarse place and 1 / radius; the rest of the place and the opacity at the centre.
//
// A small particle multiplies the rounding of its place and of the ray's direction by the distance in
// radii. So both come in two parts, and the coarse ones have so few binary digits that their products
// are exact in float32.

#define PARTICLE_LIST_WIDTH 2048
// The picture shows no difference below this clarity, a quarter of what T promises.
#define PARTICLE_LEAST_CLARITY 4e-7f
// Coarse directions are multiples of 1 / this.
#define PARTICLE_DIRECTION_STEPS 2048.0f

// The ray leads from `start` along coarse + fine, `reach` times that far.
struct ParticleRay {
    vec3 start;
    vec3 coarse;
    vec3 fine;
    float reach;
};

// The path is `scale` times the direction of the pixel at `place`, as in ViewBlock; 0 if it is not known.
ParticleRay particle_ray(vec3 start, vec3 path, float metres, vec3 place, float scale) {
    ParticleRay ray;
    ray.start = start;
    ray.coarse = vec3(0.0f);
    ray.fine = metres > 0.0f ? path / metres : vec3(0.0f);
    ray.reach = metres;
    if (place.z != 0.0f) {
        vec4 high = view.ray_high[0] * place.x + view.ray_high[1] * place.y + view.ray_high[2];
        vec4 low = view.ray_low[0] * place.x + view.ray_low[1] * place.y + view.ray_low[2];
        vec4 coarse = floor(high * PARTICLE_DIRECTION_STEPS + 0.5f) / PARTICLE_DIRECTION_STEPS;
        vec4 fine = (high - coarse) + low;
        ray.coarse = vec3(coarse.x, coarse.y, coarse.z);
        ray.fine = vec3(fine.x, fine.y, fine.z);
        ray.reach = scale;
    }
    return ray;
}

// The least distance counts, between the ray's ends.
float particle_opacity(vec4 coarse, vec4 fine, ParticleRay ray) {
    vec3 far = vec3(coarse.x, coarse.y, coarse.z);
    vec3 near = vec3(fine.x, fine.y, fine.z) - ray.start;
    vec3 place = far + near;
    vec3 direction = ray.coarse + ray.fine;
    float square = dot(direction, direction);
    float along = dot(place, direction);
    float beyond = along - clamp(along, 0.0f, ray.reach * square);
    vec3 side = cross(far, ray.coarse) + (cross(far, ray.fine) + cross(near, direction));
    float distance = square > 0.0f ? sqrt((dot(side, side) + beyond * beyond) / square) : length(place);
    return fine.w * max(1.0f - distance * coarse.w, 0.0f);
}

float fog_particles(ivec2 pixel, vec3 start, vec3 path, float metres, vec3 place, float scale) {
    vec4 tile = texelFetch(particle_tiles, pixel / models.count_more.w, 0);
    int first = int(tile.x);
    int count = int(tile.y);
    ParticleRay ray = particle_ray(start, path, metres, place, scale);
    float clarity = 1.0f;
    for (int i = first; i < first + count && clarity > PARTICLE_LEAST_CLARITY; ++i) {
        ivec2 at = ivec2(2 * (i % (PARTICLE_LIST_WIDTH / 2)), i / (PARTICLE_LIST_WIDTH / 2));
        clarity *= 1.0f - particle_opacity(texelFetch(particle_list, at, 0),
                                           texelFetch(particle_list, at + ivec2(1, 0), 0), ray);
    }
    return -log(max(clarity, 1e-30f));
}
