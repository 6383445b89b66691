// Optical depth at the vertices of terrain and meshes (paper 000, section 4.3); fog_vertex.frag gets it
// between them.
// Defines: SCENE_MESH: scene_vertex.glsl; the rest: fog_optical_depth.glsl.
precision highp float;
precision highp int;
precision highp sampler2D;

#include "scene_vertex.glsl"
#include "fog_optical_depth.glsl"

uniform vec4 view_sides[5];  // planes around what the camera sees: xyz unit normal inwards, metres from
                             // the eye; all of them have 0 at most longest_edge beyond a triangle's side
uniform float longest_edge;  // of a triangle, metres (a mesh's units)

out float vertex_tau;

// Whether a triangle that has this corner can be seen.
bool near_view(vec3 from_eye) {
    float margin = longest_edge;
#ifdef SCENE_MESH
    margin *= placement.w;
#endif
    bool near = true;
    for (int i = 0; i < 5; ++i) {
        near = near && dot(view_sides[i].xyz, from_eye) + view_sides[i].w >= -margin;
    }
    return near;
}

void main() {
    vec3 from_eye = scene_from_eye();
    gl_Position = clip_from_eye * vec4(from_eye, 1.0);
    vertex_tau = 0.0f;
    if (near_view(from_eye)) {
        vec3 start = vec3(0.0f);
        if (view.pixel.w != 0.0f) {
            vec2 ndc = gl_Position.xy;
            vec4 front = view.depth0[0] * ndc.x + view.depth0[1] * ndc.y + view.depth0[2];
            vec4 back = view.depth1[0] * ndc.x + view.depth1[1] * ndc.y + view.depth1[2];
            start = (view.pixel.z == 0.0f ? back : front).xyz;
        }
        vec3 path = from_eye - start;
        vertex_tau = fog_optical_depth(start, path, length(path), false, vec3(0.0f), vec2(0.0f), ivec2(0));
    }
}
