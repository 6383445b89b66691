// Noise for fogmaps: its options, its range, its tiles.
#include "wavefog/fogmap/noise.h"

#include <doctest/doctest.h>

#include <cmath>

using namespace wavefog;

namespace {

Noise noise_of(const NoiseOptions& options, double aspect = 1) {
    const auto noise = Noise::create(options, aspect);
    REQUIRE_MESSAGE(noise.has_value(), (noise ? "" : noise.error().message));
    return *noise;
}

constexpr NoiseOptions::Kind kKinds[] = {NoiseOptions::Kind::perlin, NoiseOptions::Kind::simplex};

}  // namespace

TEST_CASE("noise: tiles are the same a period further, in value and slope") {
    for (const auto kind : kKinds)
        for (const double aspect : {1.0, 0.5, 0.37}) {
            const Noise noise = noise_of(
                {.kind = kind, .seed = 5, .features = 3, .octaves = 4, .warp = 0.5, .tile = true},
                aspect);
            for (int i = 0; i < 200; ++i) {
                const double u = std::fmod(i * 0.618034, 1), v = std::fmod(i * 0.414214, 1);
                // The trigonometric functions of the torus round a turn to 1e-15 of features.
                CHECK(std::abs(noise(u, v) - noise(u + 1, v)) < 1e-9);
                CHECK(std::abs(noise(u, v) - noise(u, v - 1)) < 1e-9);
            }
        }
}

TEST_CASE("noise: it is bounded, of mean about 0, continuous, and seeds differ") {
    for (const auto kind : kKinds) {
        const Noise a = noise_of({.kind = kind, .seed = 1, .features = 16}),
                    b = noise_of({.kind = kind, .seed = 2, .features = 16});
        double mean = 0, power = 0, product = 0, step = 0;
        const int n = 200;
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i) {
                const double u = (i + 0.5) / n, v = (j + 0.5) / n, value = a(u, v);
                CHECK_LE(std::abs(value), 1);
                mean += value / (n * n);
                power += value * value / (n * n);
                product += value * b(u, v) / (n * n);
                step = std::max(step, std::abs(a(u + 1e-7, v) - value));
            }
        // About 256 independent banks: their mean wavers by a sixteenth of the spread.
        CHECK(std::abs(mean) < 0.25 * std::sqrt(power));
        CHECK(std::abs(product) < 0.3 * power);
        CHECK(power > 0.01);
        // A slope of 8 for each of 16 features and 6 octaves is beyond any lattice noise. GLM's
        // simplices reach 0.1 (of a squared distance) into each other, which leaves steps of 42 *
        // 0.1^4 and less.
        CHECK(step < (kind == NoiseOptions::Kind::perlin ? 1e-7 * 8 * 16 * 6 : 3 * 42e-4));
    }
}

TEST_CASE("noise: an octave keeps to its range without being cut off at it") {
    for (const auto kind : kKinds)
        for (const bool tile : {false, true}) {
            const Noise noise =
                noise_of({.kind = kind, .seed = 3, .features = 64, .octaves = 1, .tile = tile});
            double largest = 0;
            int cut = 0;
            const int n = 600;
            for (int j = 0; j < n; ++j)
                for (int i = 0; i < n; ++i) {
                    const double value = std::abs(noise((i + 0.5) / n, (j + 0.5) / n));
                    largest = std::max(largest, value);
                    cut += value == 1;
                }
            CAPTURE(tile);
            CHECK_LE(largest, 1);
            CHECK(largest > 0.6);
            CHECK(cut == 0);
        }
}

TEST_CASE("noise: options out of range are named") {
    const auto complaint = [](const NoiseOptions& options) {
        const auto noise = Noise::create(options, 1);
        return noise ? std::string() : noise.error().message;
    };
    CHECK(complaint({.features = 0}).find("features is 0; it must be 1 to 256") == 0);
    CHECK(complaint({.octaves = 17}).find("octaves is 17") == 0);
    CHECK(complaint({.gain = -0.1}).find("gain is -0.1") == 0);
    CHECK(complaint({.gain = std::nan("")}).find("gain is nan") == 0);
    CHECK(complaint({.lacunarity = 1}).find("lacunarity is 1") == 0);
    CHECK(complaint({.warp = 5}).find("warp is 5") == 0);
}

TEST_CASE("noise: the highest values become fog") {
    Grid<float> map(1, 5);
    map << 3, 1, 5, 2, 4;
    Grid<float> half = map;
    keep_highest(half, 0.6);
    Grid<float> expected(1, 5);
    expected << 0, 0, 1, 0, 0.5;
    CHECK((half == expected).all());
    Grid<float> all = map;
    keep_highest(all, 1);
    CHECK((all == (map - 1) / 4).all());
    keep_highest(map, 0);
    CHECK((map == 0).all());
    map = 7;
    keep_highest(map, 1);
    CHECK((map == 1).all());
}
