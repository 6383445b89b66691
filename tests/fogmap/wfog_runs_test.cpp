// The .wfog coder of flat tiles with edges: nothing is lost, slopes are left to others.
#include <doctest/doctest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "support/random.h"
#include "wavefog/fogmap/wfog.h"
#include "wfog/run_coder.h"

namespace wavefog {
namespace {

using std::int32_t;
using wfog::Tile;
using wfog::TileCoding;

TileCoding coding_of(int32_t low, int32_t high, int levels) {
    TileCoding coding;
    coding.low = low;
    coding.high = high;
    coding.levels = levels;
    return coding;
}

std::vector<wfog::View> views(const std::vector<wfog::Bytes>& streams, std::size_t count) {
    return {streams.begin(), streams.begin() + static_cast<std::ptrdiff_t>(count)};
}

/// Blocks of `side` pixels, each of one value; 1 is noise.
void fill_blocks(Tile& tile, int side, const TileCoding& coding, test::Random& random) {
    for (int j = 0; j < tile.height; ++j)
        for (int i = 0; i < tile.width; ++i)
            tile.row(j)[i] = i % side ? tile.row(j)[i - 1]
                             : j % side
                                 ? tile.row(j - 1)[i]
                                 : static_cast<int32_t>(random.integer(coding.low, coding.high));
}

template <class Value>
Grid<float> map_of(int width, int height, Value value) {
    Grid<float> map(height, width);
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) map(j, i) = static_cast<float>(value(i, j)) / 255;
    return map;
}

/// Discs of random densities on clear air, of which as many as 255 occur.
Grid<float> discs(int size, test::Random& random) {
    Grid<float> map = Grid<float>::Zero(size, size);
    for (int disc = 0; disc < 40; ++disc) {
        const double x = random.uniform(0, size), z = random.uniform(0, size);
        const double radius = random.uniform(0.02, 0.12) * size;
        const auto density = static_cast<float>(random.integer(0, 255)) / 255;
        for (int j = 0; j < size; ++j)
            for (int i = 0; i < size; ++i)
                if (std::hypot(i - x, j - z) < radius) map(j, i) = density;
    }
    return map;
}

EncodedFog encoded(const Grid<float>& map, double error, int threads = 0) {
    const auto fog = make_fog(map, {});
    REQUIRE(fog.has_value());
    WfogOptions options;
    options.threads = threads;
    if (error > 0) {
        options.promise = WfogOptions::Promise::max_error;
        options.error = error;
    }
    auto file = encode_wfog(*fog, options, &map);
    REQUIRE(file.has_value());
    return std::move(*file);
}

}  // namespace

TEST_CASE("wfog runs: tiles of any size and any values come back, level by level") {
    test::Random random(81);
    const std::pair<int32_t, int32_t> ranges[] = {{0, 1}, {-7, 248}, {-(1 << 19), (1 << 19) - 1}};
    for (const auto& [low, high] : ranges)
        for (const int side : {1, 3, 16, 1000})
            for (const auto& [w, h] : {std::pair{1, 1},
                                       {1, 40},
                                       {70, 1},
                                       {2, 3},
                                       {64, 64},
                                       {65, 33},
                                       {131, 140},
                                       {200, 17}})
                for (const int levels : {0, 3, 6}) {
                    const TileCoding coding = coding_of(low, high, levels);
                    INFO("up to " << coding.high << ", blocks of " << side << ", " << w << " x "
                                  << h << ", " << levels << " levels");
                    wfog::Scratch scratch;
                    Tile tile(w, h, scratch);
                    fill_blocks(tile, side, coding, random);
                    const auto streams = encode_runs(tile, coding, scratch);
                    REQUIRE(streams.size() == static_cast<std::size_t>(levels) + 1);
                    for (std::size_t known = 1; known <= streams.size(); ++known) {
                        Tile back(w, h, scratch);
                        decode_runs(back, coding, views(streams, known), scratch);
                        const int apart = 1 << (streams.size() - known);
                        int wrong = 0;
                        for (int j = 0; j < h; j += apart)
                            for (int i = 0; i < w; i += apart)
                                wrong += back.row(j)[i] != tile.row(j)[i];
                        CHECK(wrong == 0);
                    }
                }
}

TEST_CASE("wfog runs: any bytes decode to values within the range") {
    test::Random random(82);
    for (const int32_t high : {1, 2, 254, 1 << 20}) {
        const TileCoding coding = coding_of(0, high, 3);
        wfog::Scratch scratch;
        std::vector<wfog::Bytes> streams(4);
        for (wfog::Bytes& stream : streams)
            for (int k = random.integer(0, 300); k > 0; --k)
                stream.push_back(static_cast<std::uint8_t>(random.integer(0, 255)));
        Tile tile(150, 90, scratch);
        decode_runs(tile, coding, views(streams, streams.size()), scratch);
        int outside = 0;
        for (const int32_t value : tile.values) outside += value < 0 || value > high;
        INFO("up to " << high);
        CHECK(outside == 0);
    }
}

TEST_CASE("wfog runs: stripes and discs are exact in hardly any bits, whatever is promised") {
    test::Random random(83);
    constexpr int size = 512;
    std::vector<int> densities(size);
    for (int& density : densities) density = random.integer(0, 255);
    struct Case {
        const char* name;
        Grid<float> map;
        double bits;  ///< a pixel
    };
    // Stripes are 9 bits each, 0.018 a pixel. Discs have 40 edges of about 230 pixels, 0.035 of
    // all: so many bits allow one and a half for each. As slopes they took 5.3, 5.1 and 0.6.
    const Case cases[] = {
        {"rows", map_of(size, size, [&](int, int j) { return densities[std::size_t(j)]; }), 0.04},
        {"columns", map_of(size, size, [&](int i, int) { return densities[std::size_t(i)]; }),
         0.04},
        {"discs", discs(size, random), 0.055}};
    for (const Case& each : cases)
        for (const double error : {0.0, 1 / 255.0, 4 / 255.0}) {
            INFO(each.name << ", error " << error);
            const EncodedFog file = encoded(each.map, error);
            CHECK(file.report.max_error == 0);
            CHECK(file.report.bits_per_pixel < each.bits);
            CHECK(encoded(each.map, error, 1).bytes == file.bytes);
            const auto back = decode_wfog(file.bytes);
            REQUIRE(back.has_value());
            CHECK((back->map == each.map).all());
        }
}

TEST_CASE("wfog runs: flat tiles with edges are told from slopes and from noise") {
    test::Random random(84);
    using wfog::Flatness;
    const auto flatness = [](std::int64_t reach, auto value) {
        wfog::Scratch scratch;
        Tile tile(256, 200, scratch);
        for (int j = 0; j < tile.height; ++j)
            for (int i = 0; i < tile.width; ++i) tile.row(j)[i] = value(i, j);
        return flatness_of(tile, reach);
    };
    const auto slope = [](int i, int j) { return (i + j) / 30; };
    CHECK(flatness(0, slope) == Flatness::edges);
    CHECK(flatness(2, slope) == Flatness::slopes);
    CHECK(flatness(8, [](int i, int j) { return (i / 20 + j / 20) % 2 * 100; }) == Flatness::edges);
    CHECK(flatness(8, [](int i, int) { return i * 50; }) == Flatness::edges);
    CHECK(flatness(8, [](int, int j) { return j * 50; }) == Flatness::edges);
    CHECK(flatness(0, [](int i, int j) { return (i / 4 + j / 4) % 2 * 100; }) == Flatness::none);
    CHECK(flatness(0, [&](int, int) { return random.integer(0, 1); }) == Flatness::none);
}

TEST_CASE("wfog runs: no promise makes edges between near densities larger than no loss does") {
    const int densities[] = {10, 77, 78, 200, 240};
    for (const auto& [w, h] : {std::pair{300, 300}, {128, 700}, {199, 401}}) {
        const Grid<float> map =
            map_of(w, h, [&](int i, int j) { return densities[(i + 2 * j) / 37 % 5]; });
        const std::size_t lossless = encoded(map, 0).bytes.size();
        for (const double error : {1 / 255.0, 4 / 255.0}) {
            INFO(w << " x " << h << ", error " << error);
            CHECK(encoded(map, error).bytes.size() <= lossless);
        }
    }
}

TEST_CASE(
    "wfog runs: a gentle slope is foretold where an error is allowed, not kept step by step") {
    const Grid<float> map = map_of(512, 512, [](int i, int j) { return (2 * i + j) / 40; });
    const EncodedFog exact = encoded(map, 0), within = encoded(map, 4 / 255.0);
    CHECK(within.bytes.size() < exact.bytes.size() * 3 / 4);
    // 3 dB below a prequantiser's, whose steps of 9 are off by sqrt(80 / 12) on the mean.
    CHECK(within.report.rms_error < 0.7079 * std::sqrt(80 / 12.0) / 255);
}

}  // namespace wavefog
