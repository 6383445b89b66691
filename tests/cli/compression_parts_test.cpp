// Parts of --preset compression.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <utility>

#include "bench/compression.h"
#include "support/random.h"

namespace wavefog::cli {

TEST_CASE("prequantised maps are within the error") {
    test::Random random(8);
    for (const int steps : {255, 65535, 0})
        for (const double error : {0.0, 1.0, 2.0, 4.0}) {
            CodecMap map{"map", Grid<float>(20, 30), 1, steps};
            for (Eigen::Index i = 0; i < map.densities.size(); ++i)
                map.densities.data()[i] = steps > 0 ? float(random.integer(0, steps)) / float(steps)
                                                    : float(random.uniform(0.1, 0.9));
            const auto result = prequantise(map, error);
            if (steps == 0 && error == 0) {
                CHECK_FALSE(result.has_value());
                continue;
            }
            REQUIRE(result.has_value());
            const double worst = double((result->densities - map.densities).abs().maxCoeff());
            CHECK(worst <= error / 255 + 1e-6);
            CHECK(result->largest == int(result->indices.maxCoeff()));
            for (const std::string& peer : installed_peers()) {
                if (peer != "JPEG-LS" && peer != "zfp") continue;  // the others start programs
                const auto run =
                    run_peer(peer, map, error, *result, std::filesystem::temp_directory_path());
                REQUIRE(run.has_value());
                CHECK(run->bytes > 0);
                const double off = double((run->densities - map.densities).abs().maxCoeff());
                CHECK(off <= error / 255 + 1e-6);
            }
        }
}

TEST_CASE("compression is told by geometric means over the maps that all codecs have") {
    Facts runs = Facts::array();
    const auto add = [&](const char* map, const char* codec, double bits, int pixels = 100000) {
        runs.push_back({{"map", map},
                        {"pixels", pixels},
                        {"codec", codec},
                        {"error", 1.0},
                        {"bits_per_pixel", bits},
                        {"encode_mpixel_s", 10.0},
                        {"decode_mpixel_s", 20.0},
                        {"encode_spread", bits < 3 ? bits / 10 : bits * 0.105},
                        {"psnr", 50.0}});
    };
    add("a", "one", 1);
    add("b", "one", 4);
    add("c", "one", 1000);
    add("a", "two", 2);
    add("b", "two", 8);
    // Too small to be timed, and run once.
    for (const auto& [codec, bits] : {std::pair{"one", 2}, {"two", 4}}) {
        add("d", codec, bits, 1000);
        add("e", codec, bits);
        runs.back()["encode_spread"] = 0;
    }
    const std::string text = compression_text(runs, false);
    CHECK(text.find("geometric means of 4 maps") != std::string::npos);
    CHECK(text.find("2.00") != std::string::npos);  // of 1 and 4
    CHECK(text.find("4.00") != std::string::npos);  // of 2 and 8
    // Half the median of the spreads 0.1 and 0.42, and of 0.2 and 0.84; older files have none.
    CHECK(text.find("10.0 ± 13 %") != std::string::npos);
    CHECK(text.find("10.0 ± 26 %") != std::string::npos);
    CHECK(text.find("20.0 ±") == std::string::npos);
    const auto figures = compression_figures(runs);
    REQUIRE(figures.size() == 2);
    CHECK(figures[0].curves.size() == 2);
}

}  // namespace wavefog::cli
