// What others do, to compare with. Compiles as GLSL and as C++.

float fog_height(float eta) {
#if FOG_PROFILE == FOG_EXPONENTIAL
    return exp(-max(eta, 0.0f));
#elif FOG_PROFILE == FOG_LINEAR
    return clamp(1.0f - eta, 0.0f, 1.0f);
#else
    return 1.0f;
#endif
}

// march:N: N mid-point samples of the bilinear texture (nearest for Haar) where the ray is in the map.
float fog_march(FogRay ray, int samples) {
    vec2 range = fog_clip(ray);
    if (range.y <= range.x) {
        return 0.0f;
    }
    float step = (range.y - range.x) / float(samples);
    // Pixel i of the map is centred at i + (d + 1) / 2 of the spline's causal coordinate.
    vec2 texel = vec2(1.0f / float(fog.size.z), 1.0f / float(fog.size.w));
    vec2 shift = vec2(float(fog.base.x), float(fog.base.y)) - 0.5f * float(FOG_DEGREE);
    float sum = 0.0f;
    for (int i = 0; i < samples; ++i) {
        float t = range.x + (float(i) + 0.5f) * step;
        vec2 p = (ray.origin + ray.slope * t + shift) * texel;
        sum += texture(fog_map, p).x * fog_height(ray.eta + ray.rise * t);
    }
    return sum * step * fog.scale.w * ray.metres;
}

// OpenGL's EXP fog with true distance, at the map's mean density.
float fog_homogeneous(float metres) {
    return fog.limit.y * fog.scale.w * metres;
}
