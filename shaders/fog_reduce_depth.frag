// The depth of a reduced picture's pixels, for fog at that resolution.
// In: scene_depth, the depth buffer; reduced_pixel, pixels of it across and up one reduced pixel.
// Out: red: with FOG_AVERAGE the mean over the reduced pixel (paper 000, section 4.3), else the depth in
// its middle.
precision highp float;
precision highp int;
precision highp sampler2D;

uniform sampler2D scene_depth;
uniform vec2 reduced_pixel;
uniform float sky_depth;

layout(location = 0) out vec4 result;

void main() {
    ivec2 size = textureSize(scene_depth, 0);
#ifdef FOG_AVERAGE
    vec2 low = (gl_FragCoord.xy - 0.5f) * reduced_pixel;
    vec2 high = low + reduced_pixel;
    ivec2 first = ivec2(low);
    ivec2 last = min(ivec2(ceil(high)), size) - 1;
    // Counted from the sky's: sky alone stays exactly that.
    float sum = 0.0f;
    float area = 0.0f;
    for (int y = first.y; y <= last.y; ++y) {
        float up = min(high.y, float(y + 1)) - max(low.y, float(y));
        for (int x = first.x; x <= last.x; ++x) {
            float part = up * (min(high.x, float(x + 1)) - max(low.x, float(x)));
            sum += part * (texelFetch(scene_depth, ivec2(x, y), 0).x - sky_depth);
            area += part;
        }
    }
    float depth = sky_depth + sum / area;
#else
    ivec2 middle = min(ivec2(gl_FragCoord.xy * reduced_pixel), size - 1);
    float depth = texelFetch(scene_depth, middle, 0).x;
#endif
    result = vec4(depth, 0.0f, 0.0f, 1.0f);
}
