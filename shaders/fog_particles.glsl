// Optical depth of particles (paper 003): -log of the clarity, the product of 1 - opacity over all
// particles near the ray. Compiles as GLSL and as C++ (GLM). Metres from the eye.
// In: particle_tiles, a texel a tile of the screen: first entry and count; particle_list, two texels
// an entry: position and 1 / radius; opacity at the centre.

#define PARTICLE_LIST_WIDTH 2048
// The picture shows no difference below this clarity, a quarter of what T promises.
#define PARTICLE_LEAST_CLARITY 4e-7f

// The least distance counts between start and start + metres * direction.
float particle_opacity(vec4 place, float opacity, vec3 start, vec3 direction, float metres) {
    vec3 w = vec3(place.x, place.y, place.z) - start;
    vec3 apart = w - direction * clamp(dot(w, direction), 0.0f, metres);
    return opacity * max(1.0f - sqrt(dot(apart, apart)) * place.w, 0.0f);
}

float fog_particles(ivec2 pixel, vec3 start, vec3 path, float metres) {
    vec4 tile = texelFetch(particle_tiles, pixel / models.count_more.w, 0);
    int first = int(tile.x);
    int count = int(tile.y);
    vec3 direction = metres > 0.0f ? path / metres : vec3(0.0f);
    float clarity = 1.0f;
    for (int i = first; i < first + count && clarity > PARTICLE_LEAST_CLARITY; ++i) {
        ivec2 at = ivec2(2 * (i % (PARTICLE_LIST_WIDTH / 2)), i / (PARTICLE_LIST_WIDTH / 2));
        vec4 place = texelFetch(particle_list, at, 0);
        float opacity = texelFetch(particle_list, at + ivec2(1, 0), 0).x;
        clarity *= 1.0f - particle_opacity(place, opacity, start, direction, metres);
    }
    return -log(max(clarity, 1e-30f));
}
