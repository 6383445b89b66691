// Optical depth between vertices, interpolated as it is (transmittance instead errs from half to four
// times as much, by scene), added to that of the fogs before.
// Defines: FOG_CHANNELS, FOG_PREVIOUS_TAU: fog_pass.frag.
precision highp float;
precision highp sampler2D;

#define FOG_OUTPUT_TAU
#include "fog_block.glsl"
#include "fog_blend.glsl"

in float vertex_tau;

uniform sampler2D previous_tau;

layout(location = 0) out vec4 result;

void main() {
    FOG_TAU tau = vertex_tau
#ifdef FOG_CHANNELS
                  * view.channels.rgb
#endif
        ;
#ifdef FOG_PREVIOUS_TAU
    tau += fog_texel_tau(texelFetch(previous_tau, ivec2(gl_FragCoord.xy), 0));
#endif
    result = fog_result(tau, ivec2(gl_FragCoord.xy), vec3(0.0f));
}
