// Optical depth between two points by one method: the same for pixels (fog_pass.frag) and for vertices
// (fog_vertex.vert).
// Defines: FOG_DEGREE, FOG_PROFILE, FOG_REPEAT, FOG_SKIP, FOG_METHOD, FOG_PAPER_SCALING,
// RADIAL_LAYERED, RADIAL_STEP, FOG_PARTICLES, FOG_MODEL_KINDS (fog_models_block.glsl; all).

#define FOG_METHOD_EXACT 0
#define FOG_METHOD_MARCH 1
#define FOG_METHOD_HOMOGENEOUS 2
#define FOG_METHOD_NONE 3
#define FOG_METHOD_PAPER 4
#define FOG_METHOD_RADIAL 5
#define FOG_METHOD_MODELS 6

#include "fog_block.glsl"

uniform sampler2D fog_cells;       // atlas of cell polynomials
uniform sampler2D fog_map;         // the map itself, for march:N
uniform sampler2D paper_bands;     // packed coefficients
uniform sampler2D paper_paths;     // path-integral table, whole paths
uniform sampler2D paper_partials;  // path-integral table, partial paths
uniform sampler2D radial_table;    // of method radial
uniform sampler2D model_tables;    // of fogs from tabulated functions

#include "fog_ray.glsl"
#include "fog_cell.glsl"
#include "fog_exact.glsl"
#include "fog_baselines.glsl"
#if FOG_METHOD == FOG_METHOD_PAPER
#include "fog_paper.glsl"
#elif FOG_METHOD == FOG_METHOD_RADIAL
#include "fog_radial.glsl"
#elif FOG_METHOD == FOG_METHOD_MODELS
#include "fog_models_block.glsl"
#include "fog_models.glsl"
#ifdef FOG_PARTICLES
uniform sampler2D particle_tiles;  // where a tile's list begins and how long it is
uniform sampler2D particle_list;   // particles, tile by tile
#include "fog_particles.glsl"
#endif
#endif

// Of the longest sky ray, metres.
float fog_sky_limit() {
#if FOG_METHOD == FOG_METHOD_MODELS
    return models.limit.x;
#else
    return fog.limit.z;
#endif
}

// From eye + start to eye + start + path, `metres` apart. `sky`: nothing ends the ray. A halfspace knows
// the path better by its pixel (place, reach.x: fog_models.glsl), particles are listed by pixels.
float fog_optical_depth(vec3 start, vec3 path, float metres, bool sky, vec3 place, vec2 reach,
                        ivec2 pixel) {
#if FOG_METHOD == FOG_METHOD_MODELS
    float tau = fog_models(start, path, metres, place, reach.x);
#ifdef FOG_PARTICLES
    tau += fog_particles(pixel, start, path, metres, place, reach);
#endif
    return tau;
#elif FOG_METHOD == FOG_METHOD_HOMOGENEOUS
    return fog_homogeneous(metres);
#elif FOG_METHOD == FOG_METHOD_NONE
    return 0.0f;
#else
    FogRay ray;
    ray.origin = fog.eye.xy + start.xz * fog.scale.xy;
    ray.slope = path.xz * fog.scale.xy;
    ray.eta = fog.eye.z + start.y * fog.scale.z;
    ray.rise = path.y * fog.scale.z;
    ray.metres = metres;
    ray.passed = 0.0f;
    ray.last = 1.0f;
    ray.sky = sky;
#if FOG_METHOD == FOG_METHOD_EXACT
    return fog_exact(ray);
#elif FOG_METHOD == FOG_METHOD_PAPER
    return fog_paper(ray);
#elif FOG_METHOD == FOG_METHOD_RADIAL
    return fog_radial(ray);
#else
    return fog_march(ray, view.samples.x);
#endif
#endif
}
