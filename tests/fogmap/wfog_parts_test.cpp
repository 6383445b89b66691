// Parts of the .wfog coder that take short cuts, against the long way.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "support/random.h"
#include "wfog/samples.h"
#include "wfog/smoothness.h"
#include "wfog/token_stream.h"

namespace wavefog {
namespace {

using std::int32_t;
using std::size_t;
using std::uint8_t;
using wfog::Scale;

struct Symbols {
    std::vector<int32_t> values;
    std::vector<uint8_t> contexts;
};

/// Rows of quiet and of busy symbols; the last contexts hold magnitudes up to `largest`.
Symbols rows_of_symbols(test::Random& random, size_t count, int32_t largest) {
    Symbols symbols;
    while (symbols.values.size() < count) {
        const int length = random.integer(1, 400), kind = random.integer(0, 3);
        for (int i = 0; i < length && symbols.values.size() < count; ++i) {
            int32_t value = 0;
            int context = random.integer(0, 2);
            if (kind == 0) context = 0;
            if (kind == 1 && random.integer(0, 99) == 0) value = random.integer(-2, 2);
            if (kind == 2)
                context = random.integer(3, 17), value = random.integer(-context, context);
            if (kind == 3 && largest > 0)
                context = random.integer(17, 19), value = random.integer(-largest, largest);
            symbols.values.push_back(value);
            symbols.contexts.push_back(static_cast<uint8_t>(context));
        }
    }
    return symbols;
}

Grid<float> waves(int width, int height, double noise, test::Random& random) {
    Grid<float> map(height, width);
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            const double value = 120 + 100 * std::sin(i * 0.05) * std::cos(j * 0.03);
            map(j, i) = static_cast<float>(
                double(std::lround(value + random.uniform(-noise, noise))) / 255);
        }
    return map;
}

/// What is read of symbols that were written, in pieces of up to 700.
std::vector<int32_t> written_and_read(const Symbols& symbols, test::Random& random) {
    const size_t count = symbols.values.size();
    wfog::Scratch scratch;
    wfog::Bytes stream;
    wfog::write_symbols(symbols.values, symbols.contexts, scratch, stream);
    wfog::SymbolReader reader(stream, count);
    std::vector<int32_t> back(count, -1);
    for (size_t at = 0; at < count;) {
        const size_t part = std::min(count - at, static_cast<size_t>(random.integer(1, 700)));
        reader.read(&symbols.contexts[at], part, &back[at]);
        at += part;
    }
    CHECK(!reader.failed());
    return back;
}

}  // namespace

TEST_CASE("wfog parts: symbols come back, in runs of zeros and between, whatever their size") {
    test::Random random(71);
    for (const int32_t largest : {0, 14, 15, 300, 1 << 20})
        for (const size_t count : {1u, 7u, 8u, 100u, 4095u, 4096u, 4099u, 60000u}) {
            const Symbols symbols = rows_of_symbols(random, count, largest);
            INFO(count << " symbols, magnitudes up to " << largest);
            CHECK(written_and_read(symbols, random) == symbols.values);
        }
}

TEST_CASE("wfog parts: zeros alone take no bytes") {
    for (const size_t count : {1u, 4095u, 60000u}) {
        const std::vector<int32_t> zeros(count);
        const std::vector<uint8_t> contexts(count, 7);
        wfog::Scratch scratch;
        wfog::Bytes stream;
        wfog::write_symbols(zeros, contexts, scratch, stream);
        CHECK(stream.empty());
        wfog::SymbolReader reader(stream, count);
        std::vector<int32_t> back(count, -1);
        reader.read(contexts.data(), count, back.data());
        CHECK(!reader.failed());
        CHECK(back == zeros);
    }
}

TEST_CASE("wfog parts: symbols that all need many plain bits, though none is beyond the tokens") {
    test::Random random(74);
    for (const int32_t most : {7, 14, 15}) {
        Symbols symbols;
        for (int i = 0; i < 20000; ++i) {
            symbols.values.push_back(random.integer(0, 1) ? most : -most);
            symbols.contexts.push_back(19);
        }
        INFO("magnitudes of " << most);
        CHECK(written_and_read(symbols, random) == symbols.values);
    }
}

TEST_CASE("wfog parts: densities of a ratio are the rounded quotients of doubles, and go back") {
    test::Random random(72);
    for (const std::uint32_t divisor :
         {1u, 2u, 3u, 10u, 255u, 1000u, 65535u, 16777213u, 16777216u, 16777217u, 4294967295u}) {
        const Scale scale{.kind = Scale::Kind::ratio, .divisor = divisor};
        for (const int32_t largest : {255, 65535, (1 << 20) - 1, (1 << 24) - 1, 1 << 24, 1 << 29}) {
            std::vector<int32_t> integers = {0, 1, -1, largest, -largest, largest - 1};
            for (int i = 0; i < 5000; ++i) integers.push_back(random.integer(-largest, largest));
            std::vector<float> densities(integers.size());
            scale.densities(integers.data(), integers.size(), densities.data());
            std::vector<int32_t> back(integers.size());
            REQUIRE(scale.integers(densities.data(), densities.size(), back.data()));
            size_t wrong = 0, lost = 0;
            for (size_t i = 0; i < integers.size(); ++i) {
                wrong += densities[i] != scale.density(integers[i]);
                lost += back[i] != integers[i];
            }
            INFO("divisor " << divisor << ", up to " << largest);
            CHECK(wrong == 0);
            // Floats tell integers of 24 bits apart, products with the divisor those of 23.
            if (largest < 1 << 23) CHECK(lost == 0);
        }
    }
}

TEST_CASE("wfog parts: how smooth a map is, counted pixel by pixel") {
    test::Random random(73);
    const Scale scale{.kind = Scale::Kind::ratio, .divisor = 255};
    for (const double noise : {0.0, 2.0, 8.0}) {
        const Grid<float> map = waves(97, noise == 2 ? 300 : 75, noise, random);
        const auto at = [&](int j, int i) { return std::lround(double(map(j, i)) * 255); };
        for (const int bound : {2, 4, 200}) {
            int near = 0, pixels = 0;
            for (int j = 1; j + 2 <= map.rows(); j += 2)
                for (int i = 1; i + 1 < map.cols(); ++i, ++pixels)
                    near += std::abs(4 * at(j, i) - at(j, i - 1) - at(j, i + 1) - at(j - 1, i) -
                                     at(j + 1, i)) <= 4 * bound;
            const double share = double(near) / pixels;
            INFO("noise " << noise << ", bound " << bound << ", share " << share);
            CHECK(mostly_foretold(map, scale, bound, share - 1e-9));
            CHECK(!mostly_foretold(map, scale, bound, share + 1e-9));

            double squares = 0;
            const long low = std::lround(double(map.minCoeff()) * 255), step = 2 * bound + 1;
            for (int j = 0; j < map.rows(); ++j)
                for (int i = 0; i < map.cols(); ++i) {
                    const long above = (at(j, i) - low) % step;
                    const long off = std::min(above, step - above);
                    squares += double(off * off);
                }
            const double rms = std::sqrt(squares / double(map.size())) / 255;
            CHECK(prequantised_rms(map, scale, bound, false) == doctest::Approx(rms));
            // A map of few rows is looked at as a whole; noise is alike in all rows of others.
            CHECK(prequantised_rms(map, scale, bound, true) ==
                  doctest::Approx(rms).epsilon(map.rows() < 256 ? 1e-6 : 0.04));
        }
    }
}

}  // namespace wavefog
