// How large .wfog files may be: no larger for a looser promise, hardly larger than plain bits, near
// the bytes that they are allowed.
#include <doctest/doctest.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "support/random.h"
#include "wavefog/fogmap/wfog.h"

namespace wavefog {
namespace {

using Promise = WfogOptions::Promise;

EncodedFog encoded(const Grid<float>& map, const WfogOptions& options) {
    const auto fog = make_fog(map, {});
    REQUIRE(fog.has_value());
    auto file = encode_wfog(*fog, options, &map);
    if (!file) FAIL(file.error().message);
    return std::move(*file);
}

/// Waves in `greys` steps of `apart` 255ths.
Grid<float> in_greys(int width, int height, int greys, int apart) {
    Grid<float> map(height, width);
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            const double wave = std::sin(i * 0.11 + 2 * std::sin(j * 0.05)) * std::cos(j * 0.07);
            map(j, i) =
                static_cast<float>(std::lround((0.5 + 0.5 * wave) * (greys - 1)) * apart) / 255;
        }
    return map;
}

/// Bits that nothing foretells, of so many in each pixel.
Grid<float> noise(int width, int height, int bits, test::Random& random) {
    Grid<float> map(height, width);
    for (Eigen::Index i = 0; i < map.size(); ++i) {
        if (bits == 8) {
            map.data()[i] = static_cast<float>(random.integer(0, 255)) / 255;
        } else {  // 23 bits of the mantissa, and exponents 2^-31 .. 1
            const auto mantissa = static_cast<std::uint32_t>(random.integer(0, (1 << 23) - 1));
            const auto exponent = static_cast<std::uint32_t>(random.integer(96, 127));
            map.data()[i] = std::bit_cast<float>(exponent << 23 | mantissa);
        }
    }
    return map;
}

}  // namespace

TEST_CASE("wfog sizes: no promise makes a map of few greys larger than no loss does") {
    for (const auto& [greys, apart] : {std::pair{12, 4}, {9, 6}, {5, 51}})
        for (const auto& [w, h] : {std::pair{300, 200}, {600, 130}})
            for (const bool best : {false, true}) {
                const Grid<float> map = in_greys(w, h, greys, apart);
                WfogOptions options;
                options.best = best;
                const std::size_t lossless = encoded(map, options).bytes.size();
                options.promise = Promise::max_error;
                for (const double error : {1.0, 2.0, 4.0, 20.0, 60.0}) {
                    options.error = error / 255;
                    INFO(greys << " greys, " << w << " x " << h << ", best " << best << ", error "
                               << error);
                    CHECK(encoded(map, options).bytes.size() <= lossless);
                }
            }
}

TEST_CASE("wfog sizes: noise takes its own bits") {
    test::Random random(91);
    // A head, and for each of up to two tiles of up to 7 levels some bytes.
    constexpr std::size_t kAround = 160;
    for (const bool best : {false, true})
        for (const auto& [w, h] : {std::pair{300, 200}, {1000, 1}, {600, 40}}) {
            INFO(w << " x " << h << ", best " << best);
            WfogOptions options;
            options.best = best;
            const std::size_t pixels = std::size_t(w) * std::size_t(h);
            const Grid<float> bytes = noise(w, h, 8, random), floats = noise(w, h, 28, random);
            CHECK(encoded(bytes, options).bytes.size() <= pixels + kAround);
            const EncodedFog file = encoded(floats, options);
            CHECK(file.bytes.size() <= pixels * 28 / 8 + kAround);
            const auto back = decode_wfog(file.bytes);
            REQUIRE(back.has_value());
            CHECK((back->map == floats).all());
        }
}

TEST_CASE("wfog sizes: most of the bytes that are allowed are used") {
    const Grid<float> map = in_greys(512, 400, 200, 1);
    WfogOptions options;
    const std::size_t lossless = encoded(map, options).bytes.size();
    options.promise = Promise::bytes;
    for (const double share : {0.95, 0.8, 0.6, 0.4, 0.2}) {
        options.bytes = static_cast<std::size_t>(share * double(lossless));
        const std::size_t used = encoded(map, options).bytes.size();
        INFO("of " << options.bytes << " bytes " << used);
        CHECK(used <= options.bytes);
        CHECK(used >= 0.9 * double(options.bytes));
    }
    // A constant tile, its head and nothing else.
    options.bytes = 80;
    CHECK(encoded(map, options).bytes.size() <= 80);
}

TEST_CASE("wfog sizes: errors are those of the pixels, not of the fractions that they stand for") {
    test::Random random(92);
    Grid<float> map(150, 160);
    for (int j = 0; j < map.rows(); ++j)
        for (int i = 0; i < map.cols(); ++i) {
            const auto hundredths =
                double(std::lround(3000 + 2500 * std::sin(i * 0.1) * std::cos(j * 0.07)));
            // A float beside the nearest, as arithmetic leaves them.
            map(j, i) = std::nextafter(static_cast<float>(hundredths / 100),
                                       random.integer(0, 1) ? 100.0f : 0.0f);
        }
    WfogOptions options;
    options.promise = Promise::max_error;
    for (const double error : {1e-5, 1 / 255.0, 4 / 255.0}) {
        options.error = error;
        const EncodedFog file = encoded(map, options);
        const auto back = decode_wfog(file.bytes);
        REQUIRE(back.has_value());
        const double most = (back->map.cast<double>() - map.cast<double>()).abs().maxCoeff();
        INFO("error " << error << ", most " << most);
        CHECK(most <= file.report.max_error);
        CHECK(most <= error * file.report.full_scale * (1 + 1e-6));
    }
}

}  // namespace wavefog
