// Instances of a mesh. Outputs: metres from the eye along world axes.
// With SHADOW the same for the sun's shadow map, where the "eye" is the scene's origin.

#define SCENE_MESH
#include "scene_vertex.glsl"

layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 vertex_colour;
layout(location = 5) in vec3 vertex_glow;

#ifndef SHADOW
out vec3 eye_position;
out vec3 surface_normal;
out vec3 surface_colour;
out vec3 surface_glow;
out float surface_sun;
#endif

void main() {
    vec3 from_eye = scene_from_eye();
#ifndef SHADOW
    eye_position = from_eye;
    surface_normal = scene_turned(normal);
    surface_colour = vertex_colour;
    surface_glow = vertex_glow;
    surface_sun = turn.z;
#endif
    gl_Position = clip_from_eye * vec4(from_eye, 1.0);
}
