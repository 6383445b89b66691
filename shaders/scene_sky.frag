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

    // Near the horizon the air is long, so it pales and takes on the sun's colour on its side.
    float up = max(direction.y, 0.0);
    float facing = max(dot(direction, to_sun), 0.0);
    float brightness = dot(sky_colour, vec3(1.0 / 3.0));
    vec3 sunlit = sun_colour * (brightness / max(dot(sun_colour, vec3(1.0 / 3.0)), 1e-3));
    vec3 horizon = mix(mix(sky_colour, vec3(brightness), 0.4), sunlit, 0.15 + 0.45 * facing * facing);
    vec3 zenith = sky_colour * vec3(0.40, 0.58, 0.84);
    vec3 sky = mix(1.12 * horizon, zenith, 1.0 - exp(-3.0 * up));

    // A wide glow that hugs the horizon, an aureole, and the disc.
    float low = exp(-5.0 * up);
    float glow = 0.10 * pow(facing, 5.0) * (0.3 + 0.7 * low) + 0.16 * pow(facing, 40.0) +
                 0.20 * pow(facing, 350.0) + 0.45 * pow(facing, 5000.0);
    colour = vec4(sky + sun_colour * glow * (to_sun.y > -0.1 ? 1.0 : 0.0), 1.0);
}
