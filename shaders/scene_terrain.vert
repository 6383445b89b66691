// Terrain vertices. Outputs: metres from the terrain's origin and from the eye, both along world axes.

#include "scene_vertex.glsl"

layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 light;  // visible part of the sun, of the sky

out vec3 local_position;
out vec3 eye_position;
out vec3 surface_normal;
out vec2 surface_light;

void main() {
    local_position = position;
    eye_position = scene_from_eye();
    surface_normal = normal;
    surface_light = light;
    gl_Position = clip_from_eye * vec4(eye_position, 1.0);
}
