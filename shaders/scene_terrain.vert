// Terrain vertices. Inputs: metres from the terrain's origin; outputs: the same, and metres from the
// eye, both along world axes.

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 light;  // visible part of the sun, of the sky

uniform mat4 clip_from_eye;    // metres from the eye (world axes) -> clip space
uniform vec3 origin_from_eye;  // metres

out vec3 local_position;
out vec3 eye_position;
out vec3 surface_normal;
out vec2 surface_light;

void main() {
    local_position = position;
    eye_position = position + origin_from_eye;
    surface_normal = normal;
    surface_light = light;
    gl_Position = clip_from_eye * vec4(eye_position, 1.0);
}
