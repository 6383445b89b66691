// The compact file in memory: promises, levels, and bytes that nobody vouches for.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <sstream>

#include "support/random.h"
#include "wavefog/fogmap/reference.h"
#include "wavefog/fogmap/wfog.h"
#include "wfog/bands.h"
#include "wfog/format.h"

namespace wavefog {
namespace {

using Promise = WfogOptions::Promise;

enum class Kind { smooth, noise, steps, sparse, floats, wild, constant };
constexpr Kind kKinds[] = {Kind::smooth, Kind::noise, Kind::steps,   Kind::sparse,
                           Kind::floats, Kind::wild,  Kind::constant};

Grid<float> make_map(Kind kind, int width, int height, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const auto uniform = [&] { return double(random() >> 11) * 0x1p-53; };
    const double phase = 6 * uniform();
    Grid<float> map(height, width);
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i) {
            const double wave =
                0.5 + 0.5 * std::sin(phase + i * 0.11 + j * 0.07 + std::cos(j * 0.05));
            double v = 0;
            switch (kind) {
                case Kind::smooth:
                    v = std::round(255 * wave) / 255;
                    break;
                case Kind::noise:
                    v = double(random() % 256) / 255;
                    break;
                case Kind::steps:
                    v = ((i / 7 + j / 5) % 4) / 255.0 * 60;
                    break;
                case Kind::sparse:
                    v = wave > 0.8 ? std::round(200 * wave) / 255 : 0;
                    break;
                case Kind::floats:
                    v = wave * 3.7;
                    break;
                case Kind::wild:
                    v = std::exp2(200 * (uniform() - 0.5));
                    break;
                case Kind::constant:
                    v = 0.25;
                    break;
            }
            map(j, i) = static_cast<float>(v);
        }
    return map;
}

Fog fog_of(const Grid<float>& map, const FogOptions& options = {}) {
    const auto fog = make_fog(map, options);
    REQUIRE(fog.has_value());
    return *fog;
}

bool same_bits(const Grid<float>& a, const Grid<float>& b) {
    return a.rows() == b.rows() && a.cols() == b.cols() &&
           std::equal(a.data(), a.data() + a.size(), b.data(), [](float x, float y) {
               return std::bit_cast<std::uint32_t>(x) == std::bit_cast<std::uint32_t>(y);
           });
}

EncodedFog encoded(const Fog& fog, const WfogOptions& options, const Grid<float>* map = nullptr) {
    const auto result = encode_wfog(fog, options, map);
    if (!result) FAIL(result.error().message);
    return *result;
}

DecodedFog decoded(const std::vector<std::uint8_t>& bytes, const WfogLimits& limits = {}) {
    const auto result = decode_wfog(bytes, limits);
    if (!result) FAIL(result.error().message);
    return *result;
}

}  // namespace

TEST_CASE("wfog: lossless maps of every kind and size come back bit for bit") {
    const std::uint64_t seed = 20260811;
    INFO("seed ", seed);
    for (const bool best : {false, true})
        for (const Kind kind : kKinds)
            for (const auto& [w, h] : {std::pair{1, 1},
                                       {2, 1},
                                       {1, 3},
                                       {5, 4},
                                       {17, 16},
                                       {33, 47},
                                       {97, 3},
                                       {64, 64},
                                       {131, 140},
                                       {20000, 1},
                                       {1, 17000}}) {
                CAPTURE(int(kind));
                CAPTURE(w);
                CAPTURE(h);
                CAPTURE(best);
                const Grid<float> map = make_map(kind, w, h, seed);
                WfogOptions options;
                options.best = best;
                const EncodedFog file = encoded(fog_of(map), options, &map);
                const DecodedFog back = decoded(file.bytes);
                CHECK(same_bits(back.map, map));
                CHECK(file.report.max_error == 0);
                CHECK(back.levels == back.of_levels);
            }
}

TEST_CASE("wfog: lossless maps keep the sign of a 0, among integers and among floats") {
    for (const bool best : {false, true})
        for (const Kind kind : kKinds)
            for (const auto& [w, h] : {std::pair{9, 7}, {131, 140}}) {
                CAPTURE(int(kind));
                CAPTURE(w);
                Grid<float> map = make_map(kind, w, h, 5);
                for (Eigen::Index i = 0; i < map.size(); i += 3) map.data()[i] = -0.0f;
                WfogOptions options;
                options.best = best;
                CHECK(same_bits(decoded(encoded(fog_of(map), options, &map).bytes).map, map));
            }
}

TEST_CASE("wfog: every pixel is within the promised error and never below 0") {
    const std::uint64_t seed = 77;
    INFO("seed ", seed);
    for (const bool best : {false, true})
        for (const Kind kind : kKinds)
            for (const double error : {0.5 / 255, 1.0 / 255, 4.0 / 255, 0.2})
                for (const auto& [w, h] : {std::pair{75, 62}, {140, 133}}) {
                    CAPTURE(int(kind));
                    CAPTURE(error);
                    CAPTURE(best);
                    const Grid<float> map = make_map(kind, w, h, seed);
                    WfogOptions options;
                    options.promise = Promise::max_error;
                    options.error = error;
                    options.best = best;
                    const EncodedFog file = encoded(fog_of(map), options, &map);
                    const DecodedFog back = decoded(file.bytes);
                    const double worst = double((back.map - map).abs().maxCoeff());
                    CHECK(worst <= error * file.report.full_scale + map.maxCoeff() * 0x1p-23);
                    CHECK(worst == doctest::Approx(file.report.max_error));
                    CHECK(back.map.minCoeff() >= 0);
                }
}

TEST_CASE("wfog: maps so thin that floats are denormal keep a promised error") {
    test::Random random(411);
    for (int round = 0; round < 40; ++round) {
        Grid<float> map(20, 20);
        for (Eigen::Index i = 0; i < map.size(); ++i)
            map.data()[i] = static_cast<float>(1e-40 * random.uniform(0, 1));
        WfogOptions options;
        options.promise = Promise::max_error;
        for (const double error : {0.1, 0.05, 0.01}) {
            options.error = error;
            const EncodedFog file = encoded(fog_of(map), options, &map);
            const double worst = double((decoded(file.bytes).map - map).abs().maxCoeff());
            CHECK(worst <= error * file.report.full_scale + map.maxCoeff() * 0x1p-23);
        }
    }
}

TEST_CASE("wfog: all metadata come back") {
    const Grid<float> map = make_map(Kind::smooth, 40, 30, 1);
    for (const auto& [degree, family, form] : {std::tuple{0, "", Form::wavelet},
                                               {1, "", Form::wavelet},
                                               {2, "3,5", Form::scaling},
                                               {1, "positive", Form::scaling},
                                               {3, "chui-wang", Form::wavelet}})
        for (const Boundary boundary : {Boundary::zero, Boundary::repeat})
            for (const Profile& profile :
                 {Profile{}, Profile{.kind = Profile::Kind::slab, .bottom = -1, .top = 2.5},
                  Profile{.kind = Profile::Kind::exponential, .base = 3, .scale = 8},
                  Profile{.kind = Profile::Kind::linear, .top = 7, .base = -2}}) {
                Fog fog = fog_of(map, {degree, family, form, 2, boundary});
                fog.rect = {-10, 20.5, 400, 77};
                fog.extinction = 0.05;
                fog.profile = profile;
                fog.wind = {1.5, -0.25};
                if (profile.kind == Profile::Kind::slab)
                    fog.wind.keys = {{-1, 2, 0.5}, {3, 1, 1.0 / 3}, {4, 0, 0}};
                const Fog back = decoded(encoded(fog, {}).bytes).fog;
                CHECK(back.rect == fog.rect);
                CHECK(back.extinction == fog.extinction);
                CHECK(back.profile == fog.profile);
                CHECK(back.wind == fog.wind);
                CHECK(back.decomposition.family == fog.decomposition.family);
                CHECK(back.decomposition.form == form);
                CHECK(back.decomposition.boundary == boundary);
                CHECK(back.decomposition.levels() == fog.decomposition.levels());
                CHECK(same_bits(back.decomposition.approximation.values,
                                fog.decomposition.approximation.values));
            }
}

TEST_CASE("wfog: coefficients that no map gives come back bit for bit") {
    std::mt19937_64 random(5);
    for (const Form form : {Form::wavelet, Form::scaling}) {
        Fog fog = fog_of(make_map(Kind::floats, 37, 29, 5), {1, "", form, 3});
        Decomposition<float>& d = fog.decomposition;
        for (Band<float>* band : {&d.approximation, &d.details[1].phi_psi, &d.details[2].residual})
            for (Eigen::Index i = 0; i < band->values.size(); ++i)
                band->values.data()[i] += float(random() % 1000) * 1e-3f;
        const DecodedFog back = decoded(encoded(fog, {}).bytes);
        const Decomposition<float>& b = back.fog.decomposition;
        CHECK(same_bits(b.approximation.values, d.approximation.values));
        for (std::size_t l = 0; l < d.details.size(); ++l) {
            CHECK(same_bits(b.details[l].phi_psi.values, d.details[l].phi_psi.values));
            CHECK(same_bits(b.details[l].psi_phi.values, d.details[l].psi_phi.values));
            CHECK(same_bits(b.details[l].psi_psi.values, d.details[l].psi_psi.values));
            CHECK(same_bits(b.details[l].residual.values, d.details[l].residual.values));
        }
    }
}

TEST_CASE("wfog: coefficients of half precision take fewer than their 16 bits") {
    for (const Form form : {Form::wavelet, Form::scaling}) {
        Fog fog = fog_of(make_map(Kind::smooth, 256, 200, 7), {1, "", form, 4});
        double bits = 0;
        for (auto& level : wfog::bands_of(fog.decomposition))
            for (Band<float>* band : level) {
                bits += 16 * double(band->values.size());
                for (float& value : band->values.reshaped())
                    value = std::bit_cast<float>(std::bit_cast<std::uint32_t>(value) & ~0x1fffu);
            }
        const EncodedFog file = encoded(fog, {});
        CHECK(8 * double(file.bytes.size()) < 0.9 * bits);
        CHECK(wfog::same_coefficients(decoded(file.bytes).fog.decomposition, fog.decomposition));
    }
}

TEST_CASE("wfog: the same bytes and values for any number of threads") {
    const Grid<float> map = make_map(Kind::smooth, 1100, 600, 3);
    const Fog fog = fog_of(map);
    for (const bool best : {false, true}) {
        WfogOptions options;
        options.promise = Promise::max_error;
        options.error = 2.0 / 255;
        options.best = best;
        options.threads = 1;
        const EncodedFog one = encoded(fog, options);
        for (const int threads : {2, 3, 8}) {
            options.threads = threads;
            CHECK(encoded(fog, options).bytes == one.bytes);
            WfogLimits limits;
            limits.threads = threads;
            CHECK(same_bits(decoded(one.bytes, limits).map, decoded(one.bytes).map));
        }
    }
}

TEST_CASE("wfog: a file that ends early shows the levels that are there") {
    const Grid<float> map = make_map(Kind::smooth, 256, 200, 9);
    const Fog fog = fog_of(map);
    const EncodedFog file = encoded(fog, {});
    const int levels = decoded(file.bytes).of_levels;
    REQUIRE(levels >= 4);
    double last = 10;
    for (int level = 1; level <= levels; ++level) {
        WfogLimits limits;
        limits.levels = level;
        const DecodedFog part = decoded(file.bytes, limits);
        CHECK(part.levels == level);
        const double worst = double((part.map - map).abs().maxCoeff());
        CHECK(worst <= last);
        last = worst;
        CHECK(part.fog.validate().has_value());
    }
    CHECK(last == 0);
    int seen = 0;
    for (std::size_t size = 0; size < file.bytes.size(); ++size) {
        const std::span<const std::uint8_t> part(file.bytes.data(), size);
        CHECK_FALSE(decode_wfog(part).has_value());
        WfogLimits limits;
        limits.partial = true;
        if (size % 97 != 0) continue;
        if (const auto some = decode_wfog(part, limits)) {
            CHECK(some->levels >= seen);
            CHECK(some->levels < some->of_levels);
            seen = some->levels;
        }
    }
    CHECK(seen >= levels - 2);
}

TEST_CASE("wfog: as good as fits into so many bytes") {
    const Grid<float> map = make_map(Kind::smooth, 200, 120, 4);
    const Fog fog = fog_of(map);
    double last = 1e9;
    for (const std::size_t bytes : {400, 800, 1600, 100000}) {
        WfogOptions options;
        options.promise = Promise::bytes;
        options.bytes = bytes;
        const EncodedFog file = encoded(fog, options, &map);
        CHECK(file.bytes.size() <= bytes);
        CHECK(file.report.rms_error <= last);
        last = file.report.rms_error;
    }
    CHECK(last == 0);
    WfogOptions options;
    options.promise = Promise::bytes;
    options.bytes = 10;
    CHECK_FALSE(encode_wfog(fog, options).has_value());
}

TEST_CASE("wfog: errors of smooth maps stay well below the bound") {
    const Grid<float> map = make_map(Kind::floats, 300, 280, 6);
    for (const bool best : {false, true}) {
        WfogOptions options;
        options.promise = Promise::max_error;
        options.error = 4.0 / 255;
        options.best = best;
        const WfogReport report = encoded(fog_of(map), options, &map).report;
        const double bound = options.error * report.full_scale;
        CHECK(report.max_error <= bound * (1 + 1e-6));
        // A quantiser's errors are even over the interval: bound / sqrt(3). 3 dB below that.
        CHECK(report.rms_error <= bound / std::sqrt(3.0) / std::sqrt(2.0));
    }
}

TEST_CASE("wfog: a single pixel, whose full scale is 0, with a promised error") {
    const Grid<float> map = Grid<float>::Constant(1, 1, 1.1e-32f);
    WfogOptions options;
    options.promise = Promise::max_error;
    options.error = 0.2;
    CHECK(same_bits(decoded(encoded(fog_of(map), options, &map).bytes).map, map));
}

TEST_CASE("wfog: gaps between few values cost nothing") {
    constexpr int steps[] = {7, 60, 130, 255};
    for (const bool best : {false, true})
        for (const auto& [w, h] : {std::pair{60, 45}, {150, 140}}) {
            Grid<float> close(h, w), apart(h, w);
            for (int j = 0; j < h; ++j)
                for (int i = 0; i < w; ++i) {
                    const int k = (i / 11 + j / 7) % 4;
                    close(j, i) = float(k) / 255;
                    apart(j, i) = float(double(steps[k]) / 255);
                }
            for (const double error : {0.0, 4.0 / 255}) {
                CAPTURE(w);
                CAPTURE(error);
                WfogOptions options;
                options.best = best;
                const std::size_t fewest = encoded(fog_of(close), options, &close).bytes.size();
                if (error > 0) options.promise = Promise::max_error;
                options.error = error;
                const EncodedFog file = encoded(fog_of(apart), options, &apart);
                // The table of values: a byte or two each.
                CHECK(file.bytes.size() <= fewest + 8);
                CHECK(same_bits(decoded(file.bytes).map, apart));
            }
        }
}

TEST_CASE("wfog: no promise makes a small map larger than no loss") {
    // Few values, some of them next to each other: ranks are fewer than steps.
    Grid<float> map(300, 3);
    for (int j = 0; j < 300; ++j) map.row(j).setConstant(float(j * j % 256) / 255);
    for (const bool best : {false, true}) {
        WfogOptions options;
        options.best = best;
        const std::size_t lossless = encoded(fog_of(map), options, &map).bytes.size();
        options.promise = Promise::max_error;
        for (const double error : {0.4 / 255, 1.0 / 255, 2.0 / 255}) {
            CAPTURE(error);
            options.error = error;
            CHECK(encoded(fog_of(map), options, &map).bytes.size() <= lossless);
        }
        options.promise = Promise::max_transmittance_error;
        options.path = 50;
        for (const double error : {1e-5, 1e-3}) {
            CAPTURE(error);
            options.error = error;
            CHECK(encoded(fog_of(map), options, &map).bytes.size() <= lossless);
        }
    }
}

namespace {

/// The largest |dT| of 3000 rays of up to `path` metres that climb from the height `lowest` or up
/// to `higher` metres above it, level ones and such straight up above a pixel's centre among them.
double worst_of_rays(const Fog& a, const Fog& b, double path, double lowest, double higher,
                     test::Random& random) {
    const Reference first(a), second(b);
    double worst = 0;
    for (int ray = 0; ray < 3000; ++ray) {
        Eigen::Vector3d o(random.uniform(0, a.rect.x1), lowest + random.uniform(0, higher),
                          random.uniform(0, a.rect.z1));
        const double angle = random.uniform(0, 6.2832);
        double rise = random.uniform(0, std::numbers::pi / 2);
        if (ray % 4 == 0) rise = 0;
        if (ray % 4 == 1) {
            rise = std::numbers::pi / 2;
            o.x() = a.cell_x() * (std::floor(o.x() / a.cell_x()) + 0.5);
            o.z() = a.cell_z() * (std::floor(o.z() / a.cell_z()) + 0.5);
        }
        const Eigen::Vector3d u(std::cos(angle) * std::cos(rise), std::sin(rise),
                                std::sin(angle) * std::cos(rise));
        const Eigen::Vector3d p = o + u * random.uniform(1, path);
        worst = std::max(worst, std::fabs(std::exp(-first.optical_depth(o, p)) -
                                          std::exp(-second.optical_depth(o, p))));
    }
    return worst;
}

}  // namespace

TEST_CASE("wfog: no ray's transmittance is off by more than promised, whatever its slope") {
    test::Random random(31);
    const Profile exponential{.kind = Profile::Kind::exponential, .base = 0, .scale = 10};
    for (const Kind kind : {Kind::floats, Kind::noise, Kind::sparse})
        for (const bool repeat : {false, true})
            for (const double extinction : {0.03, 0.3})
                for (const Profile& profile :
                     {exponential, Profile{},
                      Profile{.kind = Profile::Kind::linear, .top = 30, .base = 0},
                      Profile{.kind = Profile::Kind::slab, .bottom = 0, .top = 12}}) {
                    // Every profile once; the one that fogs have most with all maps, and larger.
                    const bool usual = profile == exponential;
                    if (usual ? kind == Kind::sparse
                              : repeat != (kind == Kind::noise) || extinction < 0.1)
                        continue;
                    const int width = usual ? 150 : 70, height = usual ? 130 : 60;
                    const Grid<float> map = make_map(kind, width, height, random.seed());
                    Fog fog = fog_of(
                        map, {1, "", Form::wavelet, 3, repeat ? Boundary::repeat : Boundary::zero});
                    fog.rect = {0, 0, 2.0 * width, 2.0 * height};
                    fog.extinction = extinction;
                    fog.profile = profile;
                    WfogOptions options;
                    options.promise = Promise::max_transmittance_error;
                    options.error = 0.01;
                    options.path = 200;
                    options.ground = 0;
                    const EncodedFog file = encoded(fog, options, &map);
                    const double worst =
                        worst_of_rays(fog, decoded(file.bytes).fog, options.path, 0, 5, random);
                    CHECK(worst <= options.error);
                    // What promises the same pixel by pixel takes more.
                    WfogOptions pixels;
                    pixels.promise = Promise::max_error;
                    pixels.error =
                        options.error / (fog.extinction * options.path * file.report.full_scale);
                    const std::size_t bytes = encoded(fog, pixels, &map).bytes.size();
                    MESSAGE(bytes << " bytes by pixels, " << file.bytes.size() << " by rays, worst "
                                  << worst);
                    CHECK(file.bytes.size() <= bytes);
                    // Noise of 8 bits takes many bits in either way, and all of them where the
                    // promise is below its steps.
                    const int fifths = kind == Kind::floats ? 8 : extinction < 0.1 ? 6 : 5;
                    if (usual) CHECK(file.bytes.size() * std::size_t(fifths) / 5 <= bytes);
                }
}

TEST_CASE("wfog: without a ground, rays far below the fog's base count too") {
    test::Random random(32);
    for (const Profile& profile :
         {Profile{.kind = Profile::Kind::exponential, .base = 20, .scale = 10},
          Profile{.kind = Profile::Kind::linear, .top = 40, .base = 20}}) {
        const Grid<float> map = make_map(Kind::floats, 60, 50, random.seed());
        Fog fog = fog_of(map);
        fog.extinction = 0.02;
        fog.profile = profile;
        WfogOptions options;
        options.promise = Promise::max_transmittance_error;
        options.error = 0.01;
        options.path = 200;
        std::size_t fewest = 0;
        for (const double ground : {30.0, 20.0, -30.0, -HUGE_VAL}) {
            options.ground = ground;
            const EncodedFog file = encoded(fog, options, &map);
            const Fog back = decoded(file.bytes).fog;
            const double lowest = std::max(ground, 20 - options.path);
            CHECK(worst_of_rays(fog, back, options.path, lowest, 5, random) <= options.error);
            // Known ground saves bytes, the more the higher it is, and is needed for that.
            CHECK(file.bytes.size() > fewest);
            fewest = file.bytes.size();
            if (ground == 20)
                CHECK(worst_of_rays(fog, back, options.path, 20 - options.path, 5, random) >
                      options.error);
        }
        options.ground = std::nan("");
        CHECK_FALSE(encode_wfog(fog, options, &map).has_value());
    }
}

TEST_CASE("wfog: dense fog that hides errors is coarser, with the same bytes for any threads") {
    // Over two tiles, clear air to fog that a ray does not get through.
    Grid<float> map = make_map(Kind::floats, 600, 40, 8);
    std::mt19937_64 random(8);
    for (Eigen::Index i = 0; i < map.size(); ++i)
        map.data()[i] = std::max(0.0f, map.data()[i] * (1 + float(random() % 100) * 1e-3f) - 0.5f);
    Fog fog = fog_of(map);
    fog.extinction = 1;
    for (const bool best : {false, true}) {
        WfogOptions options;
        options.promise = Promise::max_transmittance_error;
        options.error = 0.02;
        options.path = 20;
        options.best = best;
        options.threads = 1;
        const EncodedFog file = encoded(fog, options, &map);
        const auto chunks = wfog::read_chunks(file.bytes, false);
        REQUIRE(chunks.has_value());
        CHECK(chunks->head.scale.kind == wfog::Scale::Kind::companded);
        const DecodedFog back = decoded(file.bytes);
        CHECK(back.map.minCoeff() >= 0);
        const Grid<float> error = (back.map - map).abs();
        const double largest = double(error.maxCoeff());
        CHECK(largest == doctest::Approx(file.report.max_error));
        const Grid<float> thin = (map < 0.05f).select(error, 0.0f);
        CHECK(double(thin.maxCoeff()) < largest / 2);
        for (const int threads : {2, 5}) {
            options.threads = threads;
            CHECK(encoded(fog, options, &map).bytes == file.bytes);
            WfogLimits limits;
            limits.threads = threads;
            CHECK(same_bits(decoded(file.bytes, limits).map, back.map));
        }
    }
}

TEST_CASE("wfog: limits, cancelling and streams") {
    const Grid<float> map = make_map(Kind::smooth, 300, 200, 4);
    const Fog fog = fog_of(map);
    std::stringstream stream;
    const auto report = encode_wfog(stream, fog, {}, &map);
    REQUIRE(report.has_value());
    CHECK(report->bytes == stream.str().size());
    const auto back = decode_wfog(stream);
    REQUIRE(back.has_value());
    CHECK(same_bits(back->map, map));

    const std::string text = stream.str();
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    WfogLimits limits;
    limits.max_map_bytes = 300 * 200 * 4 - 1;
    const auto large = decode_wfog(bytes, limits);
    REQUIRE_FALSE(large.has_value());
    CHECK(large.error().message.find("above the limit") != std::string::npos);

    std::stop_source stop;
    stop.request_stop();
    WfogOptions options;
    options.stop = stop.get_token();
    const auto stopped = encode_wfog(fog, options);
    REQUIRE_FALSE(stopped.has_value());
    CHECK(stopped.error().message.find("cancelled") != std::string::npos);
    WfogLimits stopping;
    stopping.stop = stop.get_token();
    CHECK_FALSE(decode_wfog(bytes, stopping).has_value());
}

}  // namespace wavefog
