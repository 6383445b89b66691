#include "plain_transform.h"

#include <cstddef>

namespace wavefog::bench {
namespace {

void forward_line(float* samples, float* line, int n, std::ptrdiff_t stride) {
    const int half = n / 2;
    for (int k = 0; k < half; ++k)
        line[half + k] =
            samples[2 * k * stride] / 2 -
            (samples[((2 * k + n - 1) % n) * stride] + samples[(2 * k + 1) * stride]) / 4;
    for (int k = 0; k < half; ++k)
        line[k] =
            samples[(2 * k + 1) * stride] + (line[half + k] + line[half + (k + 1) % half]) / 2;
    for (int i = 0; i < n; ++i) samples[i * stride] = line[i];
}

void inverse_line(float* samples, float* line, int n, std::ptrdiff_t stride) {
    const int half = n / 2;
    for (int i = 0; i < n; ++i) line[i] = samples[i * stride];
    for (int k = 0; k < half; ++k) line[k] -= (line[half + k] + line[half + (k + 1) % half]) / 2;
    for (int k = 0; k < half; ++k) {
        samples[2 * k * stride] = 2 * line[half + k] + (line[(k + half - 1) % half] + line[k]) / 2;
        samples[(2 * k + 1) * stride] = line[k];
    }
}

}  // namespace

void plain_forward(float* map, float* line, int size, int levels) {
    for (int l = 0; l < levels; ++l) {
        const int n = size >> l;
        for (int j = 0; j < n; ++j) forward_line(map + std::ptrdiff_t{j} * size, line, n, 1);
        for (int i = 0; i < n; ++i) forward_line(map + i, line, n, size);
    }
}

void plain_inverse(float* map, float* line, int size, int levels) {
    for (int l = levels - 1; l >= 0; --l) {
        const int n = size >> l;
        for (int i = 0; i < n; ++i) inverse_line(map + i, line, n, size);
        for (int j = 0; j < n; ++j) inverse_line(map + std::ptrdiff_t{j} * size, line, n, 1);
    }
}

}  // namespace wavefog::bench
