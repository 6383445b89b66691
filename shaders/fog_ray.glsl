// A view ray in the fog's own coordinates, and where it meets fog. Compiles as GLSL and as C++ (GLM).
//
// The ray is parametrised by t, `metres` of path per unit of t, so that the walk needs no square root
// and no world coordinate. A surface lies at t = 1; a sky pixel's ray goes on to `last` = 1, the
// longest sky ray, and its far end is where the map ends (FogRay.sky).
// eta is the height in units of the profile: slab 0 (bottom) .. 1 (top), exponential (y - base) / scale,
// linear 0 (base) .. 1 (top).

// FOG_PROFILE
#define FOG_UNIFORM 0
#define FOG_SLAB 1
#define FOG_EXPONENTIAL 2
#define FOG_LINEAR 3

#include "fog_opacity.glsl"

#define FOG_FAR 1.0e30f

// Profiles that change with height: the walk steps from one integer eta to the next.
#if FOG_PROFILE == FOG_EXPONENTIAL || FOG_PROFILE == FOG_LINEAR
#define FOG_LAYERED
#endif

// Above 40 scale heights the exponential profile is below 5e-18 and the walk need not go.
#define FOG_ETA_MAX 40.0f

struct FogRay {
    vec2 origin;   // finest cells from fog.base
    vec2 slope;    // finest cells per unit t
    float eta;     // height at t = 0
    float rise;    // eta per unit t
    float metres;  // path length per unit t
    float passed;  // t that lies between the eye and the origin (0 unless the ray was re-based)
    float last;    // t of the end point
    bool sky;      // no surface: |OP| ends with the map (paper 004's P, for the mu rule)
};

// The part [x, y] of the range where low <= origin + slope * t <= high.
vec2 fog_clip_axis(vec2 range, float origin, float slope, float low, float high) {
    if (slope == 0.0f) {
        return origin >= low && origin < high ? range : vec2(0.0f, -1.0f);
    }
    float a = (low - origin) / slope;
    float b = (high - origin) / slope;
    return vec2(max(range.x, min(a, b)), min(range.y, max(a, b)));
}

// The part of the ray inside the map's box (not when it repeats) and the height profile's support.
vec2 fog_clip(FogRay ray) {
    vec2 range = vec2(0.0f, ray.last);
#ifndef FOG_REPEAT
    vec2 low = -vec2(float(fog.base.x), float(fog.base.y));
    vec2 high = low + vec2(float(fog.size.x), float(fog.size.y));
    range = fog_clip_axis(range, ray.origin.x, ray.slope.x, low.x, high.x);
    range = fog_clip_axis(range, ray.origin.y, ray.slope.y, low.y, high.y);
#endif
#if FOG_PROFILE == FOG_SLAB
    range = fog_clip_axis(range, ray.eta, ray.rise, 0.0f, 1.0f);
#elif FOG_PROFILE == FOG_LINEAR
    range = fog_clip_axis(range, ray.eta, ray.rise, -FOG_FAR, 1.0f);
#endif
    return range;
}
