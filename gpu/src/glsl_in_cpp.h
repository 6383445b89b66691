// Enough of GLSL in C++ (on GLM) to compile the fog shaders' maths as it stands.
#pragma once

#include <cmath>
#include <glm/glm.hpp>
#include <vector>

namespace wavefog::shader {

using glm::abs;
using glm::ceil;
using glm::clamp;
using glm::cross;
using glm::dot;
using glm::exp;
using glm::floatBitsToUint;
using glm::floor;
using glm::ivec2;
using glm::ivec4;
using glm::length;
using glm::log;
using glm::max;
using glm::min;
using glm::mix;
using glm::sqrt;
using glm::uintBitsToFloat;
using glm::vec2;
using glm::vec3;
using glm::vec4;

#include "fog_block.glsl"
#include "fog_models_block.glsl"

/// A texture in memory: `channels` floats a texel, missing ones read as 0.
struct sampler2D {
    const float* texels = nullptr;
    int width = 0, height = 0, channels = 1;
    bool repeat = false;
    bool linear = false;
    bool edge = false;  ///< GL_CLAMP_TO_EDGE instead of a zero border

    float at(int x, int y, int c) const {
        if (repeat) {
            x = ((x % width) + width) % width;
            y = ((y % height) + height) % height;
        } else if (edge) {
            x = glm::clamp(x, 0, width - 1);
            y = glm::clamp(y, 0, height - 1);
        } else if (x < 0 || y < 0 || x >= width || y >= height) {
            return 0;
        }
        return texels[(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                       static_cast<std::size_t>(x)) *
                          static_cast<std::size_t>(channels) +
                      static_cast<std::size_t>(c)];
    }
};

inline vec4 texelFetch(const sampler2D& s, ivec2 p, int) {
    vec4 texel(0.0f);
    for (int c = 0; c < s.channels; ++c) texel[c] = s.at(p.x, p.y, c);
    return texel;
}

/// GL_LINEAR or GL_NEAREST.
inline vec4 texture(const sampler2D& s, vec2 p) {
    const float x = p.x * static_cast<float>(s.width), y = p.y * static_cast<float>(s.height);
    if (!s.linear)
        return texelFetch(
            s, ivec2(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y))), 0);
    const float fx = std::floor(x - 0.5f), fy = std::floor(y - 0.5f);
    const float u = x - 0.5f - fx, v = y - 0.5f - fy;
    const int i = static_cast<int>(fx), j = static_cast<int>(fy);
    const vec4 low =
        (1 - u) * texelFetch(s, ivec2(i, j), 0) + u * texelFetch(s, ivec2(i + 1, j), 0);
    const vec4 high =
        (1 - u) * texelFetch(s, ivec2(i, j + 1), 0) + u * texelFetch(s, ivec2(i + 1, j + 1), 0);
    return (1 - v) * low + v * high;
}

/// The shader's uniforms: one set a thread.
inline thread_local FogBlock fog;
inline thread_local ViewBlock view;
inline thread_local ModelBlock models;
inline thread_local sampler2D model_tables;
inline thread_local sampler2D particle_tiles;
inline thread_local sampler2D particle_list;
inline thread_local sampler2D fog_cells;
inline thread_local sampler2D fog_map;
inline thread_local PaperBlock paper;
inline thread_local sampler2D paper_bands;
inline thread_local sampler2D paper_paths;
inline thread_local sampler2D paper_partials;
inline thread_local RadialBlock radial;
inline thread_local sampler2D radial_table;
/// Of the table that radial_walk() writes: three floats a texel, as wide as radial_image_width.
inline thread_local vec3* radial_image;
inline thread_local int radial_image_width;

inline void radial_store(int column, int row, vec3 means) {
    radial_image[row * radial_image_width + column] = means;
}

}  // namespace wavefog::shader
