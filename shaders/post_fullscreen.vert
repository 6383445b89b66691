// One triangle that covers the whole target, from gl_VertexID = 0, 1, 2; draw 3 vertices without
// attributes. Used by every post-process and by the sky.
// Outputs: gl_Position at clip z = 0. Fragment shaders take their pixel from gl_FragCoord.

void main() {
    vec2 corner = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
    gl_Position = vec4(corner, 0.0, 1.0);
}
