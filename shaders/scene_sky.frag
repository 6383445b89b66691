// Background: a gradient from the horizon to the zenith around the scene's sky colour, and the glow
// round the sun. Input: the pixel. Output: linear colour; the depth buffer keeps its clear value.

uniform vec2 pixel_size;        // 2 / size of the target
uniform vec3 direction_centre;  // view direction at the picture's centre, world axes
uniform vec3 direction_x;       // added from the centre to the right edge
uniform vec3 direction_y;       // and to the top edge
uniform vec3 to_sun;
uniform vec3 sun_colour;
uniform vec3 sky_colour;

layout(location = 0) out vec4 colour;

void main() {
    vec2 ndc = gl_FragCoord.xy * pixel_size - 1.0;
    vec3 direction = normalize(direction_centre + ndc.x * direction_x + ndc.y * direction_y);

    float up = max(direction.y, 0.0);
    vec3 horizon = mix(sky_colour, vec3(dot(sky_colour, vec3(1.0 / 3.0))), 0.45) * 1.18;
    vec3 zenith = sky_colour * vec3(0.42, 0.60, 0.86);
    vec3 sky = mix(horizon, zenith, 1.0 - exp(-3.2 * up));

    // A wide glow that hugs the horizon, a narrower one, and the disc.
    float facing = max(dot(direction, to_sun), 0.0);
    float low = exp(-5.0 * up);
    float glow = 0.30 * pow(facing, 6.0) * (0.35 + 0.65 * low) + 0.35 * pow(facing, 48.0) +
                 0.9 * pow(facing, 900.0);
    colour = vec4(sky + sun_colour * glow * (to_sun.y > -0.1 ? 1.0 : 0.0), 1.0);
}
