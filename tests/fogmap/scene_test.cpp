// Scene files: what they mean, and the message of every mistake.
#include "wavefog/fogmap/scene.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "fogmap/fog_support.h"
#include "support/temp_dir.h"
#include "wavefog/fogmap/fog_file.h"

namespace wavefog::test {
namespace {

using nlohmann::json;

/// A directory with a map, a fog file, a height map and a mesh to point at.
class Stage {
  public:
    Stage() {
        Image map{4, 3, 1, {}};
        for (int k = 0; k < 12; ++k) map.pixels.push_back(static_cast<float>(k) / 11);
        REQUIRE(write_image(dir_ / "banks.tif", map).has_value());
        map.pixels[5] = -1;
        REQUIRE(write_image(dir_ / "bad.tif", map).has_value());
        Fog fog = fog_of(Grid<float>::Constant(5, 6, 0.5f), {.degree = 2});
        fog.rect = {1, 2, 3, 4};
        fog.extinction = 0.125;
        REQUIRE(save_fog(dir_ / "banks.exr", fog).has_value());
        write_bytes(dir_ / "house.glb", "glTF");
    }

    std::filesystem::path write(const std::string& text) const {
        write_bytes(dir_ / "scene.json", text);
        return dir_ / "scene.json";
    }
    Scene load(const json& scene) const {
        auto result = load_scene(write(scene.dump()));
        REQUIRE_MESSAGE(result.has_value(), (result ? "" : result.error().message));
        return std::move(*result);
    }
    std::string error(const std::string& text) const {
        const auto result = load_scene(write(text));
        return result ? "loaded" : result.error().message;
    }
    const TempDir& dir() const { return dir_; }

  private:
    TempDir dir_;
};

json full_scene() {
    return json::parse(R"({
        "size": [320, 200],
        "camera": {"eye": [0, 6, 90], "target": [0, 3, 0], "up": [0, 1, 0], "fov_y_deg": 40,
                   "near": 0.5, "far": "infinite", "depth": "reversed", "lens_shift": [0.25, -0.5]},
        "cameras": [{"name": "hill", "eye": [9, 8, 7], "target": [0, 1, 0], "fov_y_deg": 30},
                    {"name": "lake", "eye": [1, 2, 3], "target": [0, 0, 0]}],
        "sky": [0.1, 0.2, 0.3], "sun": {"direction": [0, 2, 0], "colour": [1, 0.9, 0.8]},
        "terrain": {"heightmap": "banks.tif", "rect": [-200, -100, 200, 100], "height": [0, 40]},
        "meshes": [{"file": "house.glb", "translate": [1, 2, 3], "scale": 2, "rotate_y_deg": 30,
                    "on_terrain": true}],
        "fog_colour": [0.8, 0.82, 0.85],
        "fog": [{"model": "wavelet", "image": "banks.tif", "channel": "0", "basis": "quadratic",
                 "family": "3,5", "form": "scaling", "levels": 1, "rect": [-20, -10, 20, 10],
                 "extinction": 0.05, "height": {"profile": "exponential", "base": 0, "scale": 8},
                 "wind": [1.5, 0.5], "wrap": "zero", "sanitize": false},
                {"file": "banks.exr", "wind": [1, 0]}],
        "method": {"name": "march:64", "mu": 0.5}
    })");
}

}  // namespace

TEST_CASE("a scene with every key is read as written") {
    const Stage stage;
    const Scene scene = stage.load(full_scene());
    CHECK(scene.width == 320);
    CHECK(scene.height == 200);
    CHECK(scene.camera.eye == Eigen::Vector3d(0, 6, 90));
    CHECK(scene.camera.fov_y_deg == 40);
    CHECK(scene.camera.near_plane == 0.5);
    CHECK(std::isinf(scene.camera.far_plane));
    CHECK(scene.camera.depth == Camera::Depth::reversed);
    CHECK(scene.camera.lens_shift == Eigen::Vector2d(0.25, -0.5));
    REQUIRE(scene.cameras.size() == 2);
    CHECK(scene.cameras[0].name == "hill");
    CHECK(scene.cameras[0].camera.eye == Eigen::Vector3d(9, 8, 7));
    CHECK(scene.cameras[0].camera.fov_y_deg == 30);
    CHECK(scene.cameras[1].camera.fov_y_deg == 50);  // its own defaults, not the main camera's
    CHECK(find_camera(scene, "lake")->eye == Eigen::Vector3d(1, 2, 3));
    CHECK(find_camera(scene, "sea").error().message.find("one of: hill, lake;") !=
          std::string::npos);
    CHECK(scene.sky == Eigen::Vector3d(0.1, 0.2, 0.3));
    CHECK(scene.sun.direction == Eigen::Vector3d(0, 1, 0));
    CHECK(scene.sun.colour == Eigen::Vector3d(1, 0.9, 0.8));
    REQUIRE(scene.terrain.has_value());
    CHECK(scene.terrain->heightmap == stage.dir() / "banks.tif");
    CHECK(scene.terrain->rect == Rect{-200, -100, 200, 100});
    CHECK(scene.terrain->height_max == 40);
    REQUIRE(scene.meshes.size() == 1);
    CHECK(scene.meshes[0].translate == Eigen::Vector3d(1, 2, 3));
    CHECK(scene.meshes[0].scale == 2);
    CHECK(scene.meshes[0].rotate_y_deg == 30);
    CHECK(scene.meshes[0].on_terrain);
    CHECK(scene.fog_colour == Eigen::Vector3d(0.8, 0.82, 0.85));
    REQUIRE(scene.fogs.size() == 2);
    const Fog& banks = scene.fogs[0];
    CHECK(banks.degree() == 2);
    CHECK(banks.decomposition.family.name() == "3,5");
    CHECK(banks.decomposition.form == Form::scaling);
    CHECK(banks.decomposition.levels() == 1);
    CHECK(banks.decomposition.width == 4);
    CHECK(banks.rect == Rect{-20, -10, 20, 10});
    CHECK(banks.extinction == 0.05);
    CHECK(banks.profile == Profile{.kind = Profile::Kind::exponential, .base = 0, .scale = 8});
    CHECK(banks.wind == Wind(1.5, 0.5));
    CHECK(scene.fogs[1].rect == Rect{1, 2, 3, 4});  // from the fog file
    CHECK(scene.fogs[1].extinction == 0.125);
    CHECK(scene.fogs[1].wind == Wind(1, 0));
    CHECK(scene.method.name() == "march:64");
    CHECK(scene.method.mu == 0.5);
}

TEST_CASE("the least scene has the documented defaults") {
    const Stage stage;
    const Scene scene = stage.load({{"camera", {{"eye", {0, 2, 0}}, {"target", {0, 2, -1}}}}});
    CHECK(scene.width == 800);
    CHECK(scene.height == 600);
    CHECK(scene.camera.fov_y_deg == 50);
    CHECK(scene.camera.far_plane == 4000);
    CHECK(scene.sun.direction.norm() == doctest::Approx(1));
    CHECK(scene.fogs.empty());
    CHECK_FALSE(scene.terrain.has_value());
    CHECK(scene.method.name() == "exact");

    const Scene ortho = stage.load({{"camera",
                                     {{"eye", {0, 50, 0}},
                                      {"target", {0, 0, 0}},
                                      {"up", {0, 0, -1}},
                                      {"projection", "orthographic"},
                                      {"ortho_height", 30},
                                      {"near", -5}}}});
    CHECK(ortho.camera.projection == Camera::Projection::orthographic);
    CHECK(ortho.camera.ortho_height == 30);
    CHECK(ortho.camera.near_plane == -5);

    // Levels, family and border of an image fog without those keys.
    auto fog = full_scene()["fog"][0];
    for (const char* key : {"family", "form", "levels", "basis", "wrap", "sanitize", "wind",
                            "channel", "height", "model"})
        fog.erase(key);
    auto least = full_scene();
    least["fog"] = json::array({fog});
    const Scene with_fog = stage.load(least);
    CHECK(with_fog.fogs[0].degree() == 1);
    CHECK(with_fog.fogs[0].decomposition.family.name() == "2,2");
    CHECK(with_fog.fogs[0].decomposition.levels() == 2);  // ceil(log2 4)
    CHECK(with_fog.fogs[0].profile == Profile{});
}

TEST_CASE("every mistake in a scene names the file, the key and what to do") {
    const Stage stage;
    struct Mistake {
        std::string pointer;
        json value;
        std::string message;
    };
    const double huge = 1e308;
    const std::vector<Mistake> mistakes = {
        {"/colour", 1, "colour: unknown key; valid keys here: size, camera, cameras, sky"},
        {"/camera/fov", 1, "camera.fov: unknown key; valid keys here: eye, target"},
        {"/fog/0/density", 1, "fog[0].density: unknown key"},
        {"/fog/0/height/top", 1,
         "fog[0].height.top: unknown key; valid keys here: profile, base, scale"},
        {"/size", {800}, "size: must be [width, height]"},
        {"/size", {0, 600}, "size[0]: is 0; it must be 1 to 16384"},
        {"/size", {800, 16385}, "size[1]: is 16385; it must be 1 to 16384"},
        {"/size", {800.5, 600}, "size[0]: is 800.5; it must be a whole number"},
        {"/size", "800x600", "size: is string; it must be a list"},
        {"/camera", 3, "camera: is number; it must be an object"},
        {"/camera/eye", {1, 2}, "camera.eye: has 2 entries; it must be a list of 3 numbers"},
        {"/camera/eye", {1, "b", 3}, "camera.eye[1]: is \"b\"; it must be a number"},
        {"/camera/target", {0, 6, 90}, "camera.target: is the same point as eye"},
        {"/camera/up", {0, 0, 0}, "camera.up: is [0, 0, 0]"},
        {"/camera/up", {0, -6, -180}, "camera: up is parallel to the view"},
        {"/camera/fov_y_deg", 0, "camera.fov_y_deg: is 0; it must be above 0"},
        {"/camera/fov_y_deg", 180, "camera.fov_y_deg: is 180; it must be below 180"},
        {"/camera/near", 0, "camera.near: is 0; it must be above 0"},
        {"/camera/far", 0.25, "camera: near is 0.5, far is 0.25; near must be smaller"},
        {"/camera/far", "far away", "camera.far: is \"far away\"; it must be one of: infinite"},
        {"/camera/projection", "fisheye", "one of: perspective, orthographic"},
        {"/camera/projection", "orthographic",
         "camera.far: is \"infinite\"; an orthographic camera"},
        {"/camera/depth", "inverse", "one of: standard, reversed"},
        {"/camera/lens_shift", {1, 2, 3}, "camera.lens_shift: has 3 entries"},
        {"/cameras", {{"eye", {1, 2, 3}}}, "cameras: is object; it must be a list"},
        {"/cameras/0/fov", 1, "cameras[0].fov: unknown key; valid keys here: name, eye, target"},
        {"/cameras/0/target", {9, 8, 7}, "cameras[0].target: is the same point as eye"},
        {"/cameras/1/name", "hill", "cameras[1].name: is \"hill\", as another camera's is"},
        {"/cameras/1/name", "", "cameras[1].name: is \"\"; give the camera a name"},
        {"/cameras/1/name", 7, "cameras[1].name: is 7; it must be"},
        {"/cameras/1", {{"name", "x"}, {"eye", {1, 2, 3}}}, "cameras[1].target: is missing"},
        {"/cameras/1", {{"eye", {1, 2, 3}}, {"target", {0, 0, 0}}}, "cameras[1].name: is missing"},
        {"/sun/direction", {0, 0, 0}, "sun.direction: is [0, 0, 0]"},
        {"/terrain/heightmap", "none.png", "terrain.heightmap: "},
        {"/terrain/rect",
         {0, 0, -1, 1},
         "terrain.rect: is [0, 0, -1, 1]; it must be [x0, z0, x1, z1]"},
        {"/terrain/height", 40, "terrain.height: is number; it must be a list"},
        {"/meshes/0/file", "none.glb", "none.glb: no such file"},
        {"/meshes/0/scale", -1, "meshes[0].scale: is -1; it must be above 0"},
        {"/meshes/0/on_terrain", "yes",
         "meshes[0].on_terrain: is \"yes\"; it must be true or false"},
        {"/meshes/0/rotate_y_deg", nullptr, "meshes[0].rotate_y_deg: is null; it must be a number"},
        {"/fog", {{"image", 1}}, "fog: is object; it must be a list"},
        {"/fog/0/model", "dust", "fog[0].model: is \"dust\"; it must be one of: wavelet"},
        {"/fog/0/image", "none.png", "fog[0].image: "},
        {"/fog/0/image", "bad.tif", "pixel (1, 1) is -1, 1 such pixel in all"},
        {"/fog/0/file", "banks.exr", "fog[0]: needs either \"image\""},
        {"/fog/0/channel", "G", "has no channel \"G\""},
        {"/fog/0/basis", "cosine", "fog[0].basis: "},
        {"/fog/0/family", "2,2", "fog[0].family: "},
        {"/fog/0/form", "fourier", "one of: wavelet, scaling"},
        {"/fog/0/levels", -1, "fog[0].levels: is -1; it must be 0 to 30"},
        {"/fog/0/levels", "many", "fog[0].levels: is \"many\"; it must be one of: auto"},
        {"/fog/0/rect", {0, 0, 0, 1}, "fog[0].rect: is [0, 0, 0, 1]"},
        {"/fog/0/rect", {-huge, 0, huge, 1}, "wider than a double"},
        {"/fog/0/extinction", -0.1, "fog[0].extinction: is -0.1; it must be 0 or more"},
        {"/fog/0/height/profile", "cubic", "one of: uniform, slab, exponential, linear"},
        {"/fog/0/height/scale", 0, "fog[0].height: scale is 0; it must be above 0"},
        {"/fog/0/height",
         {{"profile", "slab"}, {"bottom", 3}, {"top", 3}},
         "top must be above bottom"},
        {"/fog/0/height",
         {{"profile", "linear"}, {"base", 3}, {"top", 2}},
         "top must be above base"},
        {"/fog/0/height", {{"profile", "linear"}, {"top", 2}}, "fog[0].height.base: is missing"},
        {"/fog/0/wind", {1, 2, 3}, "fog[0].wind: has 3 entries"},
        {"/fog/0/wind", json::array({{0, 1, 2}, {0, 1}}), "fog[0].wind[1]: has 2 entries"},
        {"/fog/0/wind", json::array({{3, 1, 2}, {2, 1, 0}}),
         "fog[0].wind: [1]: time is 2, after 3"},
        {"/fog/0/wrap", "mirror", "one of: zero, repeat"},
        {"/fog/0/sanitize", 1, "fog[0].sanitize: is 1; it must be true or false"},
        {"/fog/1/basis", "haar", "fog[1].basis: is fixed by the fog file"},
        {"/fog/1/file", "none.exr", "fog[1].file: "},
        {"/fog/1/file", "banks.wfog", "no such file"},
        {"/fog/1/file", "banks.tif", "ends in .exr"},
        {"/method/name", "raymarch",
         "method.name: method \"raymarch\" does not exist; choose one of: reference"},
        {"/method/name", "march:0", "N must be 1 to 65536"},
        {"/method/mu", 1.5, "method.mu: is 1.5; it must be 0 to 1"},
    };
    for (const Mistake& mistake : mistakes) {
        json scene = full_scene();
        scene[json::json_pointer(mistake.pointer)] = mistake.value;
        const std::string message = stage.error(scene.dump());
        CAPTURE(mistake.pointer);
        CAPTURE(message);
        CHECK(contains(message, "scene.json: "));
        CHECK(contains(message, mistake.message));
    }
    for (const auto& [pointer, key] : {std::pair{"", "camera"},
                                       {"/camera", "eye"},
                                       {"/camera", "target"},
                                       {"/terrain", "heightmap"},
                                       {"/terrain", "rect"},
                                       {"/terrain", "height"},
                                       {"/meshes/0", "file"},
                                       {"/fog/0", "rect"},
                                       {"/fog/0", "extinction"},
                                       {"/fog/0/height", "profile"},
                                       {"/fog/0/height", "scale"}}) {
        json scene = full_scene();
        scene[json::json_pointer(pointer)].erase(key);
        CHECK(
            contains(stage.error(scene.dump()), std::string(key) + ": is missing; it is required"));
    }
}

TEST_CASE("broken JSON gives its line and column") {
    const Stage stage;
    CHECK(contains(stage.error("{\n  \"size\": [800, 600],\n  \"camera\": }\n"),
                   "line 3, column 13: syntax error"));
    CHECK(contains(stage.error("{\"size\": [1, 1], \"size\": [2, 2]}"),
                   "key \"size\" appears twice"));
    CHECK(contains(stage.error("{\"camera\": {\"eye\": [1e999, 0, 0]}}"), "1e999"));
    CHECK(contains(stage.error("{\"camera\": {\"eye\": [NaN, 0, 0]}}"), "line 1, column"));
    CHECK(contains(stage.error(""), "line 1, column 1"));
    CHECK(contains(stage.error("[]"), "scene.json: is array; it must be an object"));
    CHECK(contains(stage.error("{\"camera\": \"\xff\xfe\"}"), "line 1"));
    CHECK(stage.error(std::string(200000, '[')) != "loaded");
    const auto missing = load_scene(stage.dir() / "none.json");
    REQUIRE_FALSE(missing.has_value());
    CHECK(contains(missing.error().message, "none.json: no such file"));
}

TEST_CASE("fogs come from scenes, fog files and images") {
    const Stage stage;
    const auto scene = load_fogs(stage.write(full_scene().dump()));
    REQUIRE(scene.has_value());
    CHECK(scene->fogs.size() == 2);
    for (const char* name : {"banks.exr", "banks.json"}) {
        const auto fog = load_fogs(stage.dir() / name);
        REQUIRE(fog.has_value());
        CHECK(fog->fogs.front().extinction == 0.125);
    }
    const auto image = load_fogs(stage.dir() / "banks.tif");
    REQUIRE(image.has_value());
    CHECK(image->fogs.front().rect == Rect{0, 0, 4, 3});
    CHECK(image->fogs.front().degree() == 1);
    write_bytes(stage.dir() / "x.wfog", "");
    for (const auto& [name, message] : {std::pair{"none.png", "no such file"},
                                        {"bad.tif", "--sanitize"},
                                        {"x.wfog", "is no .wfog file"},
                                        {"house.glb", "cannot be read as an image"}}) {
        const auto result = load_fogs(stage.dir() / name);
        REQUIRE_FALSE(result.has_value());
        CHECK(contains(result.error().message, message));
    }
}

TEST_CASE("methods are parsed and named") {
    for (const char* name :
         {"reference", "exact", "paper", "paper:16", "paper-scaling:32:perimeter", "march:1",
          "march:32", "march:65536", "froxel:160x90x64", "homogeneous", "radial", "radial:1024x256",
          "radial:step", "radial:1024x256:step", "exact@256x256", "march:8@1x16384:average",
          "radial:64x64:step@20x30", "homogeneous@vertices", "paper:16@vertices"}) {
        const auto method = parse_method(name);
        REQUIRE(method.has_value());
        CHECK(method->name() == name);
    }
    for (const char* name : {"",
                             "Exact",
                             "exact:1",
                             "march",
                             "march:",
                             "march:0",
                             "march:-1",
                             "march:65537",
                             "march:3x",
                             "march:99999999999",
                             "march:3:4",
                             "paper:1",
                             "paper:32:round",
                             "froxel",
                             "froxel:1x1",
                             "froxel:0x1x1",
                             "froxel:1x1x1x1",
                             "homogeneous:2",
                             "radial:",
                             "radial:256",
                             "radial:1x256",
                             "radial:256x9999",
                             "radial:2x2x2",
                             "radial:8x8:2",
                             "radial:step:8x8",
                             "radial:step:step",
                             "radial:8x8:stop",
                             "@256x256",
                             "exact@",
                             "exact@256",
                             "exact@0x256",
                             "exact@256x16385",
                             "exact@256x256x3",
                             "exact@256x256:best",
                             "exact@256x256:average:average",
                             "exact@vertices:average",
                             "exact@vertices@256x256",
                             "radial@vertices",
                             "froxel:8x8x8@256x256",
                             "froxel:8x8x8@vertices",
                             "reference@256x256"}) {
        const auto method = parse_method(name);
        CAPTURE(std::string(name));
        REQUIRE_FALSE(method.has_value());
        CHECK(method.error().kind == ErrorKind::usage);
    }
}

TEST_CASE("make_fog refuses what is no map and no basis") {
    const auto message = [](const Grid<float>& map, const FogOptions& options) {
        const auto fog = make_fog(map, options);
        return fog ? std::string("made") : fog.error().message;
    };
    Grid<float> map = Grid<float>::Constant(4, 5, 1.0f);
    CHECK(message(map, {}) == "made");
    CHECK(message(Grid<float>(0, 0), {}) != "made");
    CHECK(contains(message(map, {.degree = -1}), "spline degree -1"));
    CHECK(contains(message(map, {.degree = kMaxDegree + 1}), "does not exist"));
    CHECK(contains(message(map, {.levels = -2}), "levels is -2"));
    CHECK(message(map, {.family = "no,ne"}) != "made");
    CHECK(message(map, {.family = "positive", .form = Form::wavelet}) != "made");
    map(2, 3) = -1;
    CHECK(contains(message(map, {}), "pixel (3, 2) is -1"));
    map(2, 3) = NAN;
    CHECK(contains(message(map, {}), "pixel (3, 2) is nan"));
    // Auto levels: as many as gain anything, at most five.
    CHECK(fog_of(Grid<float>::Constant(1, 1, 1.0f), {}).decomposition.levels() == 0);
    CHECK(fog_of(Grid<float>::Constant(64, 64, 1.0f), {}).decomposition.levels() == 5);
    for (int degree = 0; degree <= kMaxDegree; ++degree)
        CHECK(message(Grid<float>::Constant(40, 40, 1.0f), {.degree = degree}) == "made");
}

TEST_CASE("profiles have their values and limits") {
    const Profile slab{.kind = Profile::Kind::slab, .bottom = 1, .top = 2};
    CHECK(slab(0.999) == 0);
    CHECK(slab(1) == 1);
    CHECK(slab(2) == 1);
    CHECK(slab(2.001) == 0);
    const Profile fade{.kind = Profile::Kind::exponential, .base = 1, .scale = 2};
    CHECK(fade(-1e9) == 1);
    CHECK(fade(3) == doctest::Approx(std::exp(-1.0)));
    const Profile linear{.kind = Profile::Kind::linear, .top = 5, .base = 1};
    CHECK(linear(0) == 1);
    CHECK(linear(2) == 0.75);
    CHECK(linear(6) == 0);
    CHECK_FALSE(Profile{.kind = Profile::Kind::exponential, .scale = -1}.validate().has_value());
    CHECK_FALSE(Profile{.kind = Profile::Kind::linear, .top = NAN}.validate().has_value());
}

}  // namespace wavefog::test
