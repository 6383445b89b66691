// Any map and promise: the bytes keep it, twice the same.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "wavefog/fogmap/wfog.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace wavefog;
    if (size < 8) return 0;
    const int width = 1 + data[0] % 200, kind = data[1] % 3;
    const std::uint8_t* const pixels = data + 4;
    const std::size_t each = kind == 2 ? sizeof(float) : 1;
    const int height = std::min(200, static_cast<int>((size - 4) / each) / width);
    if (height < 1) return 0;
    Grid<float> map(height, width);
    for (Eigen::Index i = 0; i < map.size(); ++i) {
        if (kind == 2) {
            float value;
            std::memcpy(&value, pixels + std::size_t(i) * each, each);
            map.data()[i] = std::isfinite(value) && std::fabs(value) < 1e30f ? std::fabs(value) : 0;
        } else {
            map.data()[i] = float(pixels[i]) / (kind == 0 ? 255.0f : 7.0f);
        }
    }
    const auto fog = make_fog(map, {.degree = 1, .levels = 2});
    if (!fog) return 0;
    WfogOptions options;
    options.threads = 1;
    options.best = (data[2] & 1) != 0;
    if (data[2] & 2) {
        options.promise = WfogOptions::Promise::max_error;
        options.error = (1 + data[3]) / 512.0;
    }
    const auto file = encode_wfog(*fog, options, &map);
    if (!file) std::abort();
    if (encode_wfog(*fog, options, &map)->bytes != file->bytes) std::abort();
    const auto back = decode_wfog(file->bytes);
    if (!back) std::abort();
    const double allowed =
        options.error * file->report.full_scale + double(map.maxCoeff()) * 0x1p-23;
    for (Eigen::Index i = 0; i < map.size(); ++i) {
        const float a = map.data()[i], b = back->map.data()[i];
        if (options.error == 0 ? std::bit_cast<std::uint32_t>(a) != std::bit_cast<std::uint32_t>(b)
                               : std::fabs(double(a) - double(b)) > allowed || b < 0)
            std::abort();
    }
    return 0;
}
