// Camera files: what they hold, and mistakes by file and key.
#include "wavefog/fogmap/camera_file.h"

#include <doctest/doctest.h>

#include "support/temp_dir.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

Result<CameraFile> load(const TempDir& dir, const std::string& more) {
    write_bytes(dir / "cam.json",
                R"({"eye": [0, 2, 0], "target": [0, 2, -1], "far": 500)" + more + "}");
    return load_camera(dir / "cam.json");
}

}  // namespace

TEST_CASE("camera files say what depth means") {
    const TempDir dir;
    const auto gl = load(dir, R"(, "depth_values": "gl", "depth": "reversed", "near": 0.5)");
    REQUIRE_MESSAGE(gl.has_value(), (gl ? "" : gl.error().message));
    CHECK(gl->depth.kind == DepthValues::Kind::gl);
    CHECK(gl->camera.depth == Camera::Depth::reversed);
    CHECK(gl->camera.near_plane == 0.5);
    CHECK(gl->camera.far_plane == 500);
    const auto metres =
        load(dir, R"(, "depth_values": "metres", "measured": "distance", "depth_scale": 65.535)");
    REQUIRE_MESSAGE(metres.has_value(), (metres ? "" : metres.error().message));
    CHECK(metres->depth.kind == DepthValues::Kind::metres);
    CHECK(metres->depth.measured == DepthValues::Measured::distance);
    CHECK(metres->depth.scale == 65.535);
    const auto pair = load(dir, R"(, "depth_values": "inverse", "measured": "axis",
        "depth_scale": 192, "depth_offset": 31.086, "unmeasured": "neighbours")");
    REQUIRE_MESSAGE(pair.has_value(), (pair ? "" : pair.error().message));
    CHECK(pair->depth.offset == 31.086);
    CHECK(pair->depth.unmeasured == DepthValues::Unmeasured::neighbours);
    const auto inverse = load(dir, R"(, "depth_values": "inverse", "measured": "axis")");
    REQUIRE_MESSAGE(inverse.has_value(), (inverse ? "" : inverse.error().message));
    CHECK(inverse->depth.kind == DepthValues::Kind::inverse);
    CHECK(inverse->depth.measured == DepthValues::Measured::axis);
}

TEST_CASE("camera files: mistakes name file and key") {
    const TempDir dir;
    for (const auto& [more, message] :
         {std::pair{"", "depth_values: is missing"},
          {R"(, "depth_values": "z")", "depth_values: is \"z\"; it must be one of"},
          {R"(, "depth_values": "metres")", "measured: is missing"},
          {R"(, "depth_values": "gl", "measured": "axis")", "measured: belongs to depth in metres"},
          {R"(, "depth_values": "gl", "depth_scale": 2)", "depth_scale: belongs"},
          {R"(, "depth_values": "metres", "measured": "axis", "depth_scale": 0)", "depth_scale"},
          {R"(, "depth_values": "gl", "depth_offset": 2)", "depth_offset: belongs"},
          {R"(, "depth_values": "inverse", "measured": "axis", "unmeasured": "near")",
           "unmeasured: is \"near\""},
          {R"(, "depth_values": "gl", "fov": 50)", "fov: unknown key"},
          {R"(, "depth_values": "gl", "near": 600)", "near is 600, far is 500"}}) {
        const auto bad = load(dir, more);
        REQUIRE_FALSE(bad.has_value());
        CHECK_MESSAGE(bad.error().message.find(message) != std::string::npos, bad.error().message);
        CHECK(bad.error().message.find("cam.json") != std::string::npos);
    }
    CHECK_FALSE(load_camera(dir / "none.json").has_value());
}
