// Sun and sky light on a surface, linear colours.

uniform vec3 to_sun;       // world space, unit length
uniform vec3 sun_colour;   // colour of sunlight, 1 for a bright day
uniform vec3 sky_colour;   // mean colour of the sky
uniform mat4 shadow_from_eye;  // metres from the eye (world axes) -> shadow map, all in [0,1]
uniform float shadow_texel;    // metres a texel of the shadow map covers; 0 without a shadow map
uniform sampler2DShadow shadow_map;

// Part of the sun that meshes let through to a point, 4 x 4 filtered lookups.
float scene_mesh_shadow(vec3 from_eye, vec3 normal) {
    if (shadow_texel <= 0.0) return 1.0;
    // Out along the normal by the filter's reach, so that a surface does not shade itself.
    float slope = 1.0 - abs(dot(normal, to_sun));
    vec3 offset = normal * shadow_texel * (1.0 + 2.0 * slope);
    vec3 p = (shadow_from_eye * vec4(from_eye + offset, 1.0)).xyz;
    if (any(lessThan(p, vec3(0))) || any(greaterThan(p, vec3(1)))) return 1.0;
    vec2 texel = 1.0 / vec2(textureSize(shadow_map, 0));
    float sum = 0.0;
    for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 4; ++x)
            sum += texture(shadow_map, vec3(p.xy + (vec2(x, y) - 1.5) * texel, p.z));
    return sum / 16.0;
}

// Light reflected by a matt surface. `sun` is the visible part of the sun's disc, `ambient` that of
// the sky; `wrap` lets light round the terminator, as leaves do.
vec3 scene_shade(vec3 albedo, vec3 normal, float sun, float ambient, float wrap) {
    float facing = max((dot(normal, to_sun) + wrap) / (1.0 + wrap), 0.0);
    vec3 direct = sun_colour * (2.6 * sun * facing);
    // Above the sky, below the ground that the sun lights.
    vec3 bounce = 0.16 * (sky_colour + sun_colour * max(to_sun.y, 0.0)) * vec3(1.0, 0.93, 0.8);
    vec3 hemisphere = mix(bounce, sky_colour, 0.5 + 0.5 * normal.y) * ambient;
    return albedo * (direct + 1.15 * hemisphere);
}
