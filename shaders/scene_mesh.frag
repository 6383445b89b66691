// Mesh surfaces: base colour, sun with the meshes' shadows, sky. Both sides of a triangle are lit.
// Inputs: scene_mesh.vert's outputs. Output: linear colour. With SHADOW: depth alone.
#ifdef SHADOW

void main() {}

#else
#include "scene_light.glsl"

in vec3 eye_position;
in vec3 surface_normal;
in vec3 surface_colour;
in vec3 surface_glow;
in float surface_sun;

layout(location = 0) out vec4 colour;

void main() {
    // The side that is seen is lit, whatever the order of the triangle's corners.
    vec3 seen = cross(dFdx(eye_position), dFdy(eye_position));
    seen = faceforward(seen, eye_position, seen);
    vec3 normal = normalize(surface_normal);
    if (dot(normal, seen) < 0.0) normal = -normal;
    float sun = surface_sun * scene_mesh_shadow(eye_position, normal);
    colour = vec4(surface_glow + scene_shade(surface_colour, normal, sun, 0.9, 0.25), 1.0);
}
#endif
