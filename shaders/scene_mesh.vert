// Instances of a mesh, turned about y, scaled and moved. Inputs: the mesh's own units, instance
// offsets in metres from the scene's origin; outputs: metres from the eye along world axes.
// With SHADOW the same for the sun's shadow map, where the "eye" is the scene's origin.

layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec3 vertex_colour;
layout(location = 3) in vec4 placement;  // offset (metres), scale (metres per unit)
layout(location = 4) in vec3 turn;       // cos and sin of the turn about y; visible part of the sun

layout(location = 5) in vec3 vertex_glow;

uniform mat4 clip_from_eye;
uniform vec3 origin_from_eye;

#ifndef SHADOW
out vec3 eye_position;
out vec3 surface_normal;
out vec3 surface_colour;
out vec3 surface_glow;
out float surface_sun;
#endif

vec3 turned(vec3 v) {
    return vec3(turn.x * v.x + turn.y * v.z, v.y, turn.x * v.z - turn.y * v.x);
}

void main() {
    vec3 from_eye = placement.xyz + origin_from_eye + placement.w * turned(position);
#ifndef SHADOW
    eye_position = from_eye;
    surface_normal = turned(normal);
    surface_colour = vertex_colour;
    surface_glow = vertex_glow;
    surface_sun = turn.z;
#endif
    gl_Position = clip_from_eye * vec4(from_eye, 1.0);
}
