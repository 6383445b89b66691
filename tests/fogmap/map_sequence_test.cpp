// Pictures as keyframes of a fog.
#include <doctest/doctest.h>

#include <cmath>

#include "fogmap/make_png.h"
#include "support/temp_dir.h"
#include "support/maps.h"
#include "wavefog/fogmap/reference.h"
#include "wavefog/fogmap/scene.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

void write_map(const std::filesystem::path& file, int width, int height, MapKind kind,
               Random& random) {
    const auto map = make_map<float>(kind, width, height, random);
    Image image{width, height, 1, std::vector<float>(map.data(), map.data() + map.size())};
    REQUIRE(write_image(file, image).has_value());
}

}  // namespace

TEST_CASE("sequences: optical depth is linear between two keys, and a frame knows no other") {
    const TempDir dir;
    Random random(421);
    for (const char* name : {"a.exr", "b.exr", "c.exr"})
        write_map(dir / name, 20, 12, MapKind::random, random);
    write_map(dir / "wide.exr", 21, 12, MapKind::random, random);
    const auto load = [&](const std::string& images) {
        write_bytes(dir / "scene.json",
                    R"({"camera": {"eye": [0, 2, 0], "target": [0, 2, -1]}, "fog": [
                    {"model": "halfspace", "normal": [0, 1, 0], "point": [0, 0, 0], "extinction": 0},
                    {"images": [)" +
                        images + R"(], "rect": [0, 0, 40, 24], "extinction": 0.1}]})");
        return load_scene(dir / "scene.json");
    };
    const auto scene = load(R"({"time": 1, "image": "a.exr"}, {"time": 3, "image": "b.exr"},
                               {"time": 7, "image": "c.exr"})");
    REQUIRE_MESSAGE(scene.has_value(), (scene ? "" : scene.error().message));
    REQUIRE(scene->sequences.size() == 1);
    CHECK(scene->sequences[0].fog == 0);
    SequencePlayer player(scene->sequences[0]);
    const auto tau = [&](SequencePlayer& from, double seconds) {
        Fog fog = scene->fogs[0];
        const auto ok = from.show(seconds, fog);
        REQUIRE_MESSAGE(ok.has_value(), (ok ? "" : ok.error().message));
        return Reference(fog).optical_depth({-1, 0, 3}, {39, 0, 20});
    };
    const double a = tau(player, 1), b = tau(player, 3), c = tau(player, 7);
    CHECK(a != b);
    CHECK(tau(player, 0) == a);
    CHECK(tau(player, 99) == c);
    // Coefficients are floats: a few roundings of tau, at most 4.
    for (const double share : {0.25, 0.5, 0.9})
        CHECK_LE(std::abs(tau(player, 1 + 2 * share) - ((1 - share) * a + share * b)), 4e-6);
    for (const double time : {6.5, 1.5, 4.0, 2.5}) {
        SequencePlayer fresh(scene->sequences[0]);
        CHECK(tau(fresh, time) == tau(player, time));
    }

    CHECK(load("").error().message.find("fog[1].images: is empty") != std::string::npos);
    CHECK(load(R"({"time": 1, "image": "a.exr"}, {"time": 1, "image": "b.exr"})")
              .error()
              .message.find("fog[1].images[1].time: is not after") != std::string::npos);
    CHECK(load(R"({"time": 1, "image": "none.exr"})")
              .error()
              .message.find("fog[1].images[0].image") != std::string::npos);
    const auto odd = load(R"({"time": 1, "image": "a.exr"}, {"time": 2, "image": "wide.exr"})");
    REQUIRE(odd.has_value());
    Fog fog = odd->fogs[0];
    const auto failed = SequencePlayer(odd->sequences[0]).show(1.5, fog);
    REQUIRE(!failed.has_value());
    CHECK(failed.error().message.find("fog[1].images: [0] (") != std::string::npos);
    CHECK(failed.error().message.find("resize one of them") != std::string::npos);
}
