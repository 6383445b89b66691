// Compiles as GLSL and as C++ (GLM).

// 1 - exp(-tau) without cancellation for thin fog.
float fog_opacity(float tau) {
    return tau < 0.03f ? tau * (1.0f - tau * (0.5f - tau * ((1.0f / 6.0f) - tau * (1.0f / 24.0f))))
                       : 1.0f - exp(-tau);
}
