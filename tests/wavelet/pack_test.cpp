#include "wavefog/wavelet/pack.h"

#include <doctest/doctest.h>

#include <bit>
#include <cstdint>

#include "support/maps.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

bool same_bits(const Band<float>& a, const Band<float>& b) {
    if (a.values.rows() != b.values.rows() || a.values.cols() != b.values.cols()) return false;
    if (a.values.size() == 0) return true;
    if (a.start_x != b.start_x || a.start_z != b.start_z) return false;
    for (Eigen::Index i = 0; i < a.values.size(); ++i)
        if (std::bit_cast<std::uint32_t>(a.values.data()[i]) !=
            std::bit_cast<std::uint32_t>(b.values.data()[i]))
            return false;
    return true;
}

bool same_bits(const Decomposition<float>& a, const Decomposition<float>& b) {
    bool same = a.family == b.family && a.form == b.form && a.boundary == b.boundary &&
                a.width == b.width && a.height == b.height && a.levels() == b.levels() &&
                same_bits(a.approximation, b.approximation);
    for (std::size_t l = 0; same && l < a.details.size(); ++l)
        same = same_bits(a.details[l].phi_psi, b.details[l].phi_psi) &&
               same_bits(a.details[l].psi_phi, b.details[l].psi_phi) &&
               same_bits(a.details[l].psi_psi, b.details[l].psi_psi) &&
               same_bits(a.details[l].residual, b.details[l].residual);
    return same;
}

const float* texel(const PackedAtlas& atlas, int x, int y) {
    return atlas.rgba.data() +
           4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(atlas.width) +
                static_cast<std::size_t>(x));
}

Decomposition<float> example(Form form = Form::wavelet) {
    Random random(71);
    return *decompose(make_map<float>(MapKind::random, 24, 17, random), default_family(1, form), 3,
                      form);
}

}  // namespace

TEST_CASE("Packing and unpacking is bit for bit, for every family, form and boundary") {
    Random random(72);
    for (int degree = 0; degree <= 4; ++degree)
        for (const Family& family : families(degree))
            for (const Form form : {Form::wavelet, Form::scaling})
                for (const Boundary boundary : {Boundary::zero, Boundary::repeat}) {
                    if (family.kind == Family::Kind::positive && form == Form::wavelet) continue;
                    for (const auto& [width, height] :
                         {std::pair{1, 1}, {1, 13}, {40, 1}, {32, 32}, {29, 18}})
                        for (int levels : {0, 1, 3, 8}) {
                            auto dec =
                                *decompose(make_map<float>(MapKind::random, width, height, random),
                                           family, levels, form, boundary);
                            dec.approximation.values(0, 0) = -0.0f;  // the sign must survive
                            CAPTURE(family.name());
                            const auto atlas = unpack(pack(dec));
                            REQUIRE(atlas.has_value());
                            CHECK(same_bits(*atlas, dec));
                            const auto images = unpack(pack_levels(dec));
                            REQUIRE(images.has_value());
                            CHECK(same_bits(*images, dec));
                        }
                }
}

TEST_CASE("Texels are aligned by coefficient index, bands in R, G, B, A") {
    const auto dec = example();
    const PackedAtlas atlas = pack(dec);
    REQUIRE(atlas.levels.size() == 3);
    for (const PackedLevel& level : atlas.levels) {
        const auto& detail = dec.details[static_cast<std::size_t>(level.level - 1)];
        for (int j = 0; j < level.height; ++j)
            for (int i = 0; i < level.width; ++i) {
                const int kx = level.origin_x + i, kz = level.origin_z + j;
                const float* rgba = texel(atlas, level.x + i, level.y + j);
                CHECK(rgba[0] == (level.level == 1 ? dec.approximation.at(kx, kz) : 0.0f));
                CHECK(rgba[1] == detail.phi_psi.at(kx, kz));
                CHECK(rgba[2] == detail.psi_phi.at(kx, kz));
                CHECK(rgba[3] == detail.psi_psi.at(kx, kz));
            }
    }
    const auto scaling = example(Form::scaling);
    const PackedAtlas residuals = pack(scaling);
    REQUIRE(residuals.levels.size() == 4);
    CHECK(residuals.levels[0].level == 0);
    for (const float* value = residuals.rgba.data();
         value < residuals.rgba.data() + residuals.rgba.size(); value += 4)
        CHECK((value[1] == 0 && value[2] == 0 && value[3] == 0));
}

TEST_CASE("Levels do not overlap, have a zero texel between them and fit the image closely") {
    for (const Form form : {Form::wavelet, Form::scaling})
        for (const auto& [width, height] : {std::pair{256, 256}, {300, 40}, {40, 300}, {1, 200}}) {
            const auto dec = *decompose<float>(Grid<float>::Ones(height, width),
                                               default_family(1, form), 5, form);
            const PackedAtlas atlas = pack(dec);
            std::int64_t used = 0;
            for (const PackedLevel& level : atlas.levels) {
                used += std::int64_t{level.width} * level.height;
                CHECK(level.x + level.width <= atlas.width);
                CHECK(level.y + level.height <= atlas.height);
                for (const PackedLevel& other : atlas.levels)
                    if (level.level != other.level) {
                        const bool apart =
                            level.x + level.width < other.x || other.x + other.width < level.x ||
                            level.y + level.height < other.y || other.y + other.height < level.y;
                        CHECK(apart);
                    }
            }
            // A mip chain fills 8/9 of a square; long maps and small coarse levels less.
            CHECK(static_cast<double>(used) / (atlas.width * atlas.height) > 0.55);
        }
}

TEST_CASE("Damaged metadata are refused and name the level") {
    const PackedAtlas good = pack(example());
    const auto refused = [&](auto change, const char* text) {
        PackedAtlas bad = good;
        change(bad);
        const auto result = unpack(bad);
        REQUIRE_FALSE(result.has_value());
        CHECK(result.error().kind == ErrorKind::data);
        CAPTURE(result.error().message);
        CHECK(result.error().message.find(text) != std::string::npos);
    };
    constexpr int big = 2147483647;
    refused([](PackedAtlas& a) { a.levels.pop_back(); }, "level 3: is missing");
    refused([](PackedAtlas& a) { a.levels[0].level = 2; }, "level 2: is there twice");
    refused([](PackedAtlas& a) { a.levels[1].level = 9; }, "level 9");
    refused([](PackedAtlas& a) { a.levels[2].x = a.width; }, "outside the image");
    refused([](PackedAtlas& a) { a.levels[2].x = big; }, "outside the image");
    refused([](PackedAtlas& a) { a.levels[2].width = -1; }, "outside the image");
    refused([](PackedAtlas& a) { a.levels[2].channels[3].width = big; }, "outside its rectangle");
    refused([](PackedAtlas& a) { a.levels[2].channels[3].start_z = -big - 1; },
            "outside its rectangle");
    refused([](PackedAtlas& a) { a.levels[2].origin_x = -big - 1; }, "first index");
    refused([](PackedAtlas& a) { a.rgba.pop_back(); }, "values");
    refused([](PackedAtlas& a) { a.width = -a.width; }, "values");
    refused([](PackedAtlas& a) { a.map_width = 0; }, "map of 0x17");
    refused([](PackedAtlas& a) { a.map_height = big; }, "map of 24x");
    refused([](PackedAtlas& a) { a.detail_levels = -1; }, "-1 levels");
    refused([](PackedAtlas& a) { a.detail_levels = big; }, "levels");
    refused([](PackedAtlas& a) { a.family.dual_moments = 7; }, "2,7");
    refused([](PackedAtlas& a) { a.family = {Family::Kind::positive, 1, 0}; }, "positive");
    CHECK_FALSE(unpack(std::span<const PackedAtlas>{}).has_value());
}
