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
    // The geometric mean keeps detail on grazing ground, where the longer side alone would blur it.
    float footprint = sqrt(length(dFdx(p)) * length(dFdy(p)));
    vec3 base_normal = normalize(surface_normal);

    vec4 broad = scene_fractal(p * vec3(1.0, 0.5, 1.0), 170.0, 3, footprint);
    vec4 middle = scene_fractal(p, 19.0, 4, footprint);
    vec4 fine = scene_fractal(p, 1.7, 3, footprint);
    vec4 grain = scene_fractal(p * vec3(1.0, 0.6, 1.0), 0.23, 3, footprint);

    float slope = 1.0 - base_normal.y;
    float rock = smoothstep(0.22, 0.36, slope + 0.05 * middle.x + 0.03 * broad.x);
    float soil = smoothstep(0.08, 0.24, slope + 0.04 * middle.x + 0.05 * broad.x) * (1.0 - rock);

    // Bumps: the part of the noise's gradient that lies in the surface tilts the normal.
    vec3 bump = middle.yzw * mix(0.9, 2.0, rock) + fine.yzw * mix(0.10, 0.16, rock) +
                grain.yzw * mix(0.016, 0.008, rock);
    bump -= base_normal * dot(bump, base_normal);
    vec3 normal = normalize(base_normal - bump);

    vec3 lush = vec3(0.075, 0.100, 0.030);
    vec3 dry = vec3(0.190, 0.160, 0.072);
    vec3 grass = mix(lush, dry, smoothstep(-0.45, 0.55, broad.x + 0.45 * middle.x));
    grass = mix(grass, dry, 0.5 * smoothstep(0.1, 0.6, grain.x + 0.5 * fine.x));
    // Heather and scrub in patches with a clear edge.
    float scrub = smoothstep(0.08, 0.22, middle.x - 0.35 * broad.x + 0.25 * fine.x) * (1.0 - soil);
    grass = mix(grass, vec3(0.062, 0.066, 0.030), 0.75 * scrub);
    grass *= 1.0 + 0.20 * middle.x + 0.45 * fine.x + 0.45 * grain.x;
    vec3 earth = vec3(0.130, 0.106, 0.070) * (1.0 + 0.25 * middle.x + 0.25 * fine.x + 0.3 * grain.x);
    // Beds of stone: bands along the height, bent and broken by noise.
    float beds = scene_noise(vec3(0.004, 0.09, 0.004) * p + 0.6 * broad.x).x;
    vec3 stone = mix(vec3(0.135, 0.125, 0.115), vec3(0.235, 0.215, 0.190),
                     0.5 + 0.4 * beds + 0.45 * middle.x);
    // Cracks where the noise changes sign.
    float cracks = smoothstep(0.0, 0.10, abs(middle.x)) * smoothstep(0.0, 0.16, abs(fine.x) + 0.04);
    stone *= (0.62 + 0.38 * cracks) * (1.0 + 0.3 * fine.x + 0.2 * grain.x);
    vec3 albedo = mix(mix(grass, earth, soil * 0.7), stone, rock);

    // Hollows of the bumps see less sky.
    float hollow = clamp(1.0 + 0.25 * middle.x + 0.2 * fine.x + 0.2 * grain.x, 0.5, 1.2);
    float sun = surface_light.x * scene_mesh_shadow(eye_position, base_normal);
    colour = vec4(scene_shade(max(albedo, 0.0), normal, sun, surface_light.y * hollow, 0.0), 1.0);
}
