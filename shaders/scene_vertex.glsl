// Where a vertex of the scene lies, in metres from the eye along world axes.
// Defines: SCENE_MESH: an instance of a mesh, turned about y, scaled and moved; else terrain.
// In: positions in metres from the terrain's origin, or in the mesh's own units.

layout(location = 0) in vec3 position;

uniform mat4 clip_from_eye;    // metres from the eye (world axes) -> clip space
uniform vec3 origin_from_eye;  // metres

#ifdef SCENE_MESH
layout(location = 3) in vec4 placement;  // offset (metres), scale (metres per unit)
layout(location = 4) in vec3 turn;       // cos and sin of the turn about y; visible part of the sun

vec3 scene_turned(vec3 v) {
    return vec3(turn.x * v.x + turn.y * v.z, v.y, turn.x * v.z - turn.y * v.x);
}

vec3 scene_from_eye() {
    return placement.xyz + origin_from_eye + placement.w * scene_turned(position);
}
#else
vec3 scene_from_eye() {
    return position + origin_from_eye;
}
#endif

// Passes over the same vertices meet the same pixels.
invariant gl_Position;
