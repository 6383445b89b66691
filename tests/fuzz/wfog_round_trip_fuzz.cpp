// Any map and promise: the bytes keep it, and are the same when made again.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "wavefog/fogmap/wfog.h"

namespace {

using namespace wavefog;

/// The first bytes of an input; pixels follow.
struct Choices {
    std::uint8_t width, height;
    std::uint8_t kind;  ///< bits 0-1 of pixels, 2 best, 3-4 promise, 5 repeat, 6 wide, 7 scaling
    std::uint8_t error;
};

/// Sides up to 160, mostly less. A search encodes many times, so its maps are smaller; one over
/// rays follows every line through each of its files, so that those are the smallest.
int side(WfogOptions::Promise promise, int byte) {
    using Promise = WfogOptions::Promise;
    const int divisor = promise == Promise::max_transmittance_error ? 6000
                        : promise == Promise::bytes                 ? 3000
                                                                    : 408;
    return 1 + byte * byte / divisor;
}

/// Repeats the pixels, each time changed, so that a short input can be a large map.
Grid<float> make_map(const Choices& choices, WfogOptions::Promise promise,
                     const std::uint8_t* pixels, std::size_t count) {
    const int width = side(promise, choices.width), height = side(promise, choices.height);
    const bool wide = (choices.kind & 64) != 0;  // more than one tile, where maps are large
    Grid<float> map(wide ? 1 + height / 16 : height, wide ? width * 4 : width);
    const int kind = choices.kind & 3;
    const std::size_t each = kind == 2 ? sizeof(float) : 1, pattern = count / each;
    for (std::size_t i = 0; i < std::size_t(map.size()); ++i) {
        const std::uint8_t* at = pixels + i % pattern * each;
        const auto byte = std::uint8_t(*at + i / pattern * choices.error);
        float value = float(byte) / (kind == 0 ? 255.0f : kind == 1 ? 7.0f : 65535.0f);
        if (kind == 2) {
            std::memcpy(&value, at, each);
            value = std::isfinite(value) && std::fabs(value) < 1e30f ? std::fabs(value) : 0;
        }
        map.data()[i] = value;
    }
    return map;
}

void require(bool fact) {
    if (!fact) std::abort();
}

/// The largest |dT| of rays of up to `path` metres through 1/m and 1/m.
double largest_change(double a, double b, double path) {
    const double s = a == b ? 0 : a > 0 && b > 0 ? std::min(path, std::log(a / b) / (a - b)) : path;
    return std::fabs(std::exp(-a * s) - std::exp(-b * s));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size < sizeof(Choices) + sizeof(float)) return 0;
    Choices choices;
    std::memcpy(&choices, data, sizeof choices);
    using Promise = WfogOptions::Promise;
    const auto promise = static_cast<Promise>(choices.kind >> 3 & 3);
    const Grid<float> map =
        make_map(choices, promise, data + sizeof choices, size - sizeof choices);
    FogOptions fog_options{.degree = 1, .levels = 2};
    if (choices.kind & 32) fog_options.boundary = Boundary::repeat;
    if (choices.kind & 128) fog_options.form = Form::scaling;
    const auto fog = make_fog(map, fog_options);
    if (!fog) return 0;

    WfogOptions options;
    options.threads = 1;
    options.best = (choices.kind & 4) != 0;
    options.promise = promise;
    options.error = (1 + choices.error) / 512.0;
    options.path = 1 + choices.error / 8;  // cells: some maps are shorter, some longer
    options.bytes = 64 + std::size_t(choices.error) * 16;
    const auto file = encode_wfog(*fog, options, &map);
    // Only a size can be impossible.
    require(file || promise == Promise::bytes);
    if (!file) return 0;
    require(encode_wfog(*fog, options, &map)->bytes == file->bytes);
    const auto back = decode_wfog(file->bytes);
    require(back && back->map.minCoeff() >= 0);
    if (promise == Promise::bytes) require(file->bytes.size() <= options.bytes);
    const double allowed =
        options.error * file->report.full_scale + double(map.maxCoeff()) * 0x1p-23;
    for (Eigen::Index i = 0; i < map.size(); ++i) {
        const float a = map.data()[i], b = back->map.data()[i];
        if (promise == Promise::lossless)
            require(std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b));
        if (promise == Promise::max_error) require(std::fabs(double(a) - double(b)) <= allowed);
        // Fog without a profile: a ray straight up stays over one pixel. Floats are rounded.
        if (promise == Promise::max_transmittance_error)
            require(largest_change(double(a), double(b), options.path) <= options.error * 1.00001);
    }
    return 0;
}
