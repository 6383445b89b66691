// Files of earlier versions decode to the same values for ever.
#include <doctest/doctest.h>

#include <bit>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "wavefog/fogmap/wfog.h"
#include "wfog_bytes.h"

namespace wavefog {
namespace {

/// Of the floats' bytes, low byte first, row by row.
std::uint32_t checksum(const Grid<float>& map) {
    std::vector<std::uint8_t> bytes;
    for (Eigen::Index i = 0; i < map.size(); ++i) {
        const auto bits = std::bit_cast<std::uint32_t>(map.data()[i]);
        for (int k = 0; k < 32; k += 8) bytes.push_back(std::uint8_t(bits >> k));
    }
    return test::crc32(bytes.data(), bytes.size());
}

struct Frozen {
    const char* name;
    int width, height;
    std::uint32_t whole, half;  ///< checksums with all levels and with half of them
};

}  // namespace

TEST_CASE("wfog: frozen files decode to the same values") {
    const Frozen files[] = {
        {"v1_lossless", 37, 23, 0x27382048, 0xb7b41fbe},
        {"v1_mixing", 37, 23, 0x5f9e027b, 0x1c6d7a80},
        {"v1_mixing_long", 310, 290, 0xf1e96237, 0xbe10e550},  // least squares are scaled back
        {"v1_tables", 140, 133, 0x7140de25, 0x7e988f66},
        {"v1_16bit", 33, 29, 0xceab7aa6, 0x44fd2d46},
        {"v1_floats", 40, 31, 0xae50b541, 0xa84f9b93},
        {"v1_float_bits", 40, 31, 0x0e2e5add, 0x89593905},
        {"v1_table", 48, 48, 0xe3089703, 0xe5f928fe},
        {"v1_coefficients", 40, 31, 0x7ffbb50c, 0x2bd33d48},
        {"v1_tiles", 600, 3, 0x6f8d5c3e, 0x9fc32143},
        {"v1_bounds", 45, 38, 0xdb99c69b, 0x70f13c93},
        {"v1_bounds_tables", 140, 133, 0xe58d94c9, 0xa4006f2f},
        {"v1_packed", 41, 35, 0xa08b7d3a, 0x18ce5455},
        {"v1_packed_tables", 150, 131, 0xf0797fe6, 0x7beb1ebf},
        {"v1_companded", 41, 35, 0x792c7177, 0x2a37c2bc},
        {"v1_companded_tables", 137, 130, 0x2d685b8d, 0xdde37ccc},
        {"v1_runs", 149, 131, 0x9062b9c4, 0x89bf0095},
        {"v1_runs_ranks", 137, 150, 0x18ab0674, 0xbfd3e88d},
        {"v1_runs_narrow", 1000, 3, 0xf510eeb1, 0x51568443},  // levels without centres
        {"v1_plain", 70, 50, 0xa9537558, 0x104cdb56},
        {"v1_zeros", 150, 131, 0x9d774898, 0xc5555b8d},  // levels without symbols
    };
    for (const Frozen& frozen : files) {
        const std::string name =
            std::string(WAVEFOG_DATA_DIR) + "/../tests/data/wfog/" + frozen.name + ".wfog";
        INFO(name);
        std::ifstream stream(name, std::ios::binary);
        REQUIRE(stream);
        const auto whole = decode_wfog(stream);
        REQUIRE(whole.has_value());
        CHECK(whole->map.cols() == frozen.width);
        CHECK(whole->map.rows() == frozen.height);
        CHECK(checksum(whole->map) == frozen.whole);
        WfogLimits limits;
        limits.levels = whole->of_levels / 2;
        stream.clear();
        stream.seekg(0);
        const auto half = decode_wfog(stream, limits);
        REQUIRE(half.has_value());
        CHECK(checksum(half->map) == frozen.half);
    }
}

}  // namespace wavefog
