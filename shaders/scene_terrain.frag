// Terrain ground: grass and soil on gentle slopes, rock on steep ones, with noise at several scales.
// Inputs: scene_terrain.vert's outputs. Output: linear colour.
#include "scene_noise.glsl"
#include "scene_light.glsl"

in vec3 local_position;
in vec3 eye_position;
in vec3 surface_normal;
in vec2 surface_light;

layout(location = 0) out vec4 colour;

void main() {
    vec3 p = local_position;
    float footprint = max(length(dFdx(p)), length(dFdy(p)));
    vec3 base_normal = normalize(surface_normal);

    vec4 broad = scene_fractal(p * vec3(1.0, 0.5, 1.0), 170.0, 3, footprint);
    vec4 middle = scene_fractal(p, 19.0, 4, footprint);
    vec4 fine = scene_fractal(p, 1.4, 4, footprint);

    float slope = 1.0 - base_normal.y;
    float rock = smoothstep(0.17, 0.30, slope + 0.07 * middle.x + 0.03 * broad.x);
    float soil = smoothstep(0.05, 0.20, slope + 0.05 * middle.x + 0.06 * broad.x) * (1.0 - rock);

    // Bumps: the part of the noise's gradient that lies in the surface tilts the normal.
    vec3 bump = middle.yzw * mix(0.55, 1.6, rock) + fine.yzw * mix(0.045, 0.09, rock);
    bump -= base_normal * dot(bump, base_normal);
    vec3 normal = normalize(base_normal - bump);

    vec3 lush = vec3(0.075, 0.100, 0.030);
    vec3 dry = vec3(0.190, 0.160, 0.072);
    vec3 grass = mix(lush, dry, smoothstep(-0.45, 0.55, broad.x + 0.45 * middle.x));
    grass *= 1.0 + 0.22 * middle.x + 0.42 * fine.x;
    vec3 earth = vec3(0.150, 0.112, 0.072) * (1.0 + 0.25 * middle.x + 0.25 * fine.x);
    // Beds of stone: bands along the height, bent by noise.
    float beds = sin(0.55 * p.y + 5.0 * broad.x + 2.2 * middle.x);
    vec3 stone = mix(vec3(0.135, 0.125, 0.115), vec3(0.235, 0.215, 0.190),
                     0.5 + 0.25 * beds + 0.45 * middle.x);
    stone *= 1.0 + 0.3 * fine.x;
    vec3 albedo = mix(mix(grass, earth, soil * 0.8), stone, rock);

    // Hollows of the bumps see less sky.
    float hollow = clamp(1.0 + 0.25 * middle.x + 0.2 * fine.x, 0.5, 1.2);
    float sun = surface_light.x * scene_mesh_shadow(eye_position, base_normal);
    colour = vec4(scene_shade(max(albedo, 0.0), normal, sun, surface_light.y * hollow, 0.0), 1.0);
}
