#include <cmath>
#include <cstdint>

#include "gl_support.h"

using namespace wavefog;
using namespace wavefog::test;

namespace {

/// A square in the plane z = 0 from (-1,-1) to (1,1), without normals, bright red.
constexpr const char* square_obj =
    "mtllib square.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nusemtl red\nf 1 2 3 4\n";
constexpr const char* square_mtl = "newmtl red\nKd 0.9 0.05 0.05\n";

std::string little_endian(std::uint32_t value) {
    std::string bytes;
    for (int k = 0; k < 4; ++k) bytes.push_back(char(value >> (8 * k) & 0xff));
    return bytes;
}

/// The same square as a GLB whose node is scaled by 2 and moved by (0, 3, 0), green.
std::string square_glb() {
    std::string binary;
    const float corners[][3] = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    binary.append(reinterpret_cast<const char*>(corners), sizeof corners);
    const std::uint16_t indices[] = {0, 1, 2, 0, 2, 3};
    binary.append(reinterpret_cast<const char*>(indices), sizeof indices);
    std::string json =
        R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],)"
        R"("nodes":[{"mesh":0,"translation":[0,3,0],"scale":[2,2,2]}],)"
        R"("meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1,"material":0}]}],)"
        R"("materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.05,0.9,0.05,1]}}],)"
        R"("buffers":[{"byteLength":60}],)"
        R"("bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],)"
        R"("accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3",)"
        R"("min":[-1,-1,0],"max":[1,1,0]},)"
        R"({"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"}]})";
    while (json.size() % 4 != 0) json.push_back(' ');
    const auto total = std::uint32_t(12 + 8 + json.size() + 8 + binary.size());
    return "glTF" + little_endian(2) + little_endian(total) +
           little_endian(std::uint32_t(json.size())) + "JSON" + json +
           little_endian(std::uint32_t(binary.size())) + std::string("BIN\0", 4) + binary;
}

Scene looking_at_origin() {
    Scene scene;
    scene.width = scene.height = 40;
    scene.camera.eye = {0, 0, 10};
    scene.camera.target = {0, 0, 0};
    scene.camera.fov_y_deg = 90;  // 20 m high at the origin: a pixel is half a metre
    scene.camera.far_plane = 100;
    scene.sun.direction = {0, 0, 1};
    return scene;
}

}  // namespace

TEST_CASE("an OBJ mesh is placed, scaled and turned, with its material's colour") {
    const TempDir scratch;
    scratch.write("square.mtl", square_mtl);
    Scene scene = looking_at_origin();
    MeshInstance instance;
    instance.file = scratch.write("square.obj", square_obj);
    instance.translate = {5, -5, 0};
    instance.scale = 2;
    scene.meshes = {instance};
    const Picture picture = draw(osmesa().gl(), scene);
    int covered = 0;
    for (const float d : picture.depth.pixels) covered += d < 1;
    CHECK(covered == 64);  // 4 m x 4 m
    // Centre at 30, 30 of 40 pixels from the top left.
    const Eigen::Vector3d p =
        world_point(scene.camera, 40, 40, 30, 30, picture.depth.at(30, 30, 0));
    CHECK((p - Eigen::Vector3d(5.25, -5.25, 0)).norm() < 1e-3);
    CHECK(picture.colour.at(30, 30, 0) > 5 * picture.colour.at(30, 30, 1));

    // Turned by 90 degrees about y it is seen edge-on; by 60, half as wide, its right half further.
    scene.meshes[0].translate = {0, 0, 0};
    scene.meshes[0].rotate_y_deg = 60;
    const Picture turned = draw(osmesa().gl(), scene);
    const Eigen::Vector3d right =
        world_point(scene.camera, 40, 40, 21, 20, turned.depth.at(21, 20, 0));
    CHECK(right.x() > 0);
    CHECK(right.z() ==
          doctest::Approx(-right.x() * std::tan(60 * 3.14159265358979 / 180)).epsilon(1e-3));
}

TEST_CASE("a material that gives out light needs no sun") {
    const TempDir scratch;
    scratch.write("square.mtl", "newmtl red\nKd 0 0 0\nKe 0.25 1.5 0\n");
    Scene scene = looking_at_origin();
    scene.sun.colour = {0, 0, 0};
    scene.meshes = {MeshInstance{.file = scratch.write("square.obj", square_obj)}};
    const Picture picture = draw(osmesa().gl(), scene);
    CHECK(picture.colour.at(20, 20, 0) == doctest::Approx(0.25).epsilon(1e-3));
    CHECK(picture.colour.at(20, 20, 1) == doctest::Approx(1.5).epsilon(1e-3));
}

TEST_CASE("a GLB mesh keeps its node's transform and base colour") {
    const TempDir scratch;
    Scene scene = looking_at_origin();
    MeshInstance instance;
    instance.file = scratch.write("square.glb", square_glb());
    scene.meshes = {instance};
    const Picture picture = draw(osmesa().gl(), scene);
    int covered = 0;
    for (const float d : picture.depth.pixels) covered += d < 1;
    CHECK(covered == 64);
    CHECK(picture.depth.at(20, 14, 0) < 1);  // 3 m up is 6 pixels
    CHECK(picture.depth.at(20, 20, 0) == 1);
    CHECK(picture.colour.at(20, 14, 1) > 5 * picture.colour.at(20, 14, 0));
}

TEST_CASE("a mesh stands on the terrain and keeps its place 1000 km from the origin") {
    const TempDir scratch;
    scratch.write("square.mtl", square_mtl);
    const auto flat = scratch / "flat.exr";
    REQUIRE(write_image(flat, Image{2, 1, 1, {0, 1}}).has_value());
    Scene scene = looking_at_origin();
    const Eigen::Vector3d base(1e6, 0, -2e6);
    scene.terrain =
        Terrain{flat, {base.x() - 50, base.z() - 50, base.x() + 50, base.z() + 50}, -80, -40};
    MeshInstance instance;
    instance.file = scratch.write("square.obj", square_obj);
    instance.translate = base + Eigen::Vector3d(-25, 60, 0);  // ground there: -80 m
    instance.on_terrain = true;
    scene.meshes = {instance};
    scene.camera.eye = base + Eigen::Vector3d(-25, -20, 10);
    scene.camera.target = base + Eigen::Vector3d(-25, -20, 0);
    const Picture picture = draw(osmesa().gl(), scene);
    const Eigen::Vector3d p =
        world_point(scene.camera, 40, 40, 20, 20, picture.depth.at(20, 20, 0));
    CHECK((p - (base + Eigen::Vector3d(-24.75, -20.25, 0))).norm() < 1e-3);
}

TEST_CASE("meshes throw shadows on meshes") {
    const TempDir scratch;
    scratch.write("square.mtl", square_mtl);
    Scene scene = looking_at_origin();
    scene.sun.direction = Eigen::Vector3d(0, 0.2, 1).normalized();
    MeshInstance wall;
    wall.file = scratch.write("square.obj", square_obj);
    wall.scale = 6;
    scene.meshes = {wall};
    const float lit = draw(osmesa().gl(), scene).colour.at(12, 12, 0);
    MeshInstance blocker = wall;
    blocker.scale = 1;
    blocker.translate = {0, 0, 5};  // seen from the sun it covers the wall one metre below
    scene.meshes = {wall, blocker};
    const Picture shaded = draw(osmesa().gl(), scene);
    CHECK(shaded.colour.at(12, 12, 0) == doctest::Approx(lit).epsilon(0.02));
    scene.camera.eye = {4, -1, 1.5};  // past the blocker, from the side
    scene.camera.target = {0, -1, 0};
    const Picture beside = draw(osmesa().gl(), scene);
    CHECK(beside.colour.at(20, 20, 0) < 0.5f * lit);
}

TEST_CASE("missing and unreadable meshes are errors that name the file") {
    const TempDir scratch;
    const struct {
        std::filesystem::path file;
        const char* what;
    } cases[] = {
        {scratch / "nowhere.glb", "cannot open"},
        {scratch.write("noise.glb", "these are not the bytes of a mesh"), "not a readable"},
        {scratch.write("cut.glb", square_glb().substr(0, 300)), "not a readable"},
        {scratch.write("points.obj", "v 0 0 0\nv 1 0 0\n"), "points.obj"},
    };
    for (const auto& item : cases) {
        CAPTURE(item.file);
        Scene scene = looking_at_origin();
        scene.meshes = {MeshInstance{.file = item.file}};
        const auto renderer = SceneRenderer::create(osmesa().gl(), scene);
        REQUIRE_FALSE(renderer.has_value());
        CHECK(renderer.error().kind == ErrorKind::data);
        CHECK(renderer.error().message.find(item.file.filename().string()) != std::string::npos);
        CHECK(renderer.error().message.find(item.what) != std::string::npos);
    }
}
