#include "wavefog/fogmap/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "camera_reader.h"
#include "file_io.h"
#include "json_reader.h"
#include "model_reader.h"
#include "particles_reader.h"
#include "wavefog/fogmap/fog_file.h"

namespace wavefog {

namespace fs = std::filesystem;
using detail::JsonFailure;
using detail::JsonValue;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kMaxPixels = 16384;  // a side; what OpenGL 4.5 drivers offer
constexpr std::uintmax_t kMaxSceneBytes = 16u << 20;

/// Passes a value on or fails with the key's path in front of the inner message.
template <class T>
T value_or_fail(Result<T> result, const JsonValue& at) {
    if (!result) at.fail(result.error().message);
    return std::move(*result);
}

fs::path existing_file(const JsonValue& value, const fs::path& directory) {
    const fs::path file = directory / value.text();
    if (const auto ok = detail::check_is_file(file); !ok) value.fail(ok.error().message);
    return file;
}

std::vector<NamedCamera> read_cameras(const JsonValue& value) {
    std::vector<NamedCamera> cameras;
    for (const JsonValue& item : value.items()) {
        const Camera camera = detail::read_camera(item, {"name"});
        const JsonValue name = item.key("name");
        if (name.text().empty()) name.fail("is \"\"; give the camera a name");
        for (const NamedCamera& other : cameras)
            if (other.name == name.text())
                name.fail(fmt::format("is \"{}\", as another camera's is; choose another name",
                                      other.name));
        cameras.push_back({name.text(), camera});
    }
    return cameras;
}

Sun read_sun(const JsonValue& value) {
    value.only({"direction", "colour"});
    Sun sun;
    if (const auto direction = value.find("direction")) {
        sun.direction = direction->vector3();
        if (!(sun.direction.norm() > 0))
            direction->fail("is [0, 0, 0]; give the direction towards the sun");
    }
    sun.direction.normalize();
    if (const auto colour = value.find("colour")) sun.colour = colour->vector3();
    return sun;
}

Terrain read_terrain(const JsonValue& value, const fs::path& directory) {
    value.only({"heightmap", "rect", "height"});
    Terrain terrain;
    terrain.heightmap = existing_file(value.key("heightmap"), directory);
    terrain.rect = value.key("rect").rect();
    const auto height = value.key("height").numbers(2);
    terrain.height_min = height[0];
    terrain.height_max = height[1];
    return terrain;
}

MeshInstance read_mesh(const JsonValue& value, const fs::path& directory) {
    value.only({"file", "translate", "scale", "rotate_y_deg", "on_terrain"});
    MeshInstance mesh;
    mesh.file = existing_file(value.key("file"), directory);
    if (const auto translate = value.find("translate")) mesh.translate = translate->vector3();
    if (const auto scale = value.find("scale")) mesh.scale = scale->above(0);
    if (const auto angle = value.find("rotate_y_deg")) mesh.rotate_y_deg = angle->number();
    if (const auto on_terrain = value.find("on_terrain")) mesh.on_terrain = on_terrain->boolean();
    return mesh;
}

struct ImageOptions {
    ReadOptions read;
    FogOptions fog;
};

ImageOptions read_image_options(const JsonValue& value) {
    ReadOptions read;
    if (const auto channel = value.find("channel")) read.channel = channel->text();
    if (const auto sanitize = value.find("sanitize")) read.sanitize = sanitize->boolean();

    FogOptions options;
    if (const auto basis = value.find("basis"))
        options.degree = value_or_fail(parse_basis(basis->text()), *basis);
    if (const auto form = value.find("form"))
        options.form = form->choice({"wavelet", "scaling"}) == 0 ? Form::wavelet : Form::scaling;
    if (const auto family = value.find("family")) {
        options.family = family->text();
        value_or_fail(parse_family(options.family, options.degree), *family);
    }
    if (const auto wrap = value.find("wrap"))
        options.boundary =
            wrap->choice({"zero", "repeat"}) == 0 ? Boundary::zero : Boundary::repeat;
    if (const auto levels = value.find("levels")) {
        if (levels->is_text())
            levels->choice({"auto"});
        else
            options.levels = levels->integer(0, 30);
    }
    // Both decide what the fog looks like and have no sensible default; checked before the image is
    // read.
    value.key("rect").rect();
    value.key("extinction").number(0, kInfinity);
    return {read, options};
}

Fog read_image_fog(const JsonValue& value, const fs::path& directory) {
    const JsonValue image = value.key("image");
    const ImageOptions options = read_image_options(value);
    const Fogmap map =
        value_or_fail(read_fogmap(existing_file(image, directory), options.read), image);
    return value_or_fail(make_fog(map.pixels, options.fog), value);
}

/// "images": [{"time": 0, "image": "a.png"}, ...].
MapSequence read_sequence(const JsonValue& value, const fs::path& directory) {
    const JsonValue images = value.key("images");
    const ImageOptions options = read_image_options(value);
    MapSequence sequence{{}, options.read, options.fog, 0, images.place()};
    for (const JsonValue& item : images.items()) {
        item.only({"time", "image"});
        const JsonValue time = item.key("time");
        sequence.keys.push_back({time.number(), existing_file(item.key("image"), directory)});
        if (const std::size_t n = sequence.keys.size();
            n > 1 && !(sequence.keys[n - 2].seconds < sequence.keys[n - 1].seconds))
            time.fail("is not after the one before; times must ascend");
    }
    if (sequence.keys.empty()) images.fail("is empty; give at least one picture");
    return sequence;
}

/// A map that changes is also added to `sequences`.
Fog read_fog(const JsonValue& value, const fs::path& directory,
             std::vector<MapSequence>& sequences) {
    value.only({"model", "image", "images", "file", "channel", "basis", "family", "form", "levels",
                "rect", "extinction", "height", "wind", "wrap", "sanitize", "channels"});
    const auto file = value.find("file");
    const bool changes = value.find("images").has_value();
    if (int(file.has_value()) + int(changes) + int(value.find("image").has_value()) != 1)
        value.fail(
            "needs either \"image\" (a picture), \"images\" (pictures at times) or \"file\" (a fog "
            "file), and not both");

    Fog fog;
    if (file) {
        for (const char* key : {"channel", "basis", "family", "form", "levels", "wrap", "sanitize"})
            if (const auto fixed = value.find(key))
                fixed->fail("is fixed by the fog file; remove the key, or convert the map again");
        fog = value_or_fail(load_fog(directory / file->text()), *file);
    } else if (changes) {
        sequences.push_back(read_sequence(value, directory));
        if (const auto ok = SequencePlayer(sequences.back()).show(0, fog); !ok)
            throw JsonFailure{ok.error()};
    } else {
        fog = read_image_fog(value, directory);
    }
    if (const auto rect = value.find("rect")) fog.rect = rect->rect();
    if (const auto extinction = value.find("extinction"))
        fog.extinction = extinction->number(0, kInfinity);
    if (const auto height = value.find("height")) fog.profile = detail::read_profile(*height);
    if (const auto wind = value.find("wind")) fog.wind = detail::read_wind(*wind);
    if (const auto channels = value.find("channels"))
        fog.channels = detail::read_channels(*channels);
    if (const auto ok = fog.validate(); !ok) value.fail(ok.error().message);
    return fog;
}

Method read_method(const JsonValue& value) {
    value.only({"name", "mu"});
    Method method;
    if (const auto name = value.find("name"))
        method = value_or_fail(parse_method(name->text()), *name);
    if (const auto mu = value.find("mu")) method.mu = mu->number(0, 1);
    return method;
}

Scene read_scene(const JsonValue& root, const fs::path& directory) {
    root.only({"size", "camera", "cameras", "sky", "sun", "terrain", "meshes", "fog_colour", "fog",
               "method"});
    Scene scene;
    if (const auto size = root.find("size")) {
        const auto sides = size->items();
        if (sides.size() != 2) size->fail("must be [width, height] in pixels");
        scene.width = sides[0].integer(1, kMaxPixels);
        scene.height = sides[1].integer(1, kMaxPixels);
    }
    scene.camera = detail::read_camera(root.key("camera"));
    if (const auto cameras = root.find("cameras")) scene.cameras = read_cameras(*cameras);
    if (const auto sky = root.find("sky")) scene.sky = sky->vector3();
    scene.sun = Sun{};
    scene.sun.direction.normalize();
    if (const auto sun = root.find("sun")) scene.sun = read_sun(*sun);
    if (const auto terrain = root.find("terrain"))
        scene.terrain = read_terrain(*terrain, directory);
    if (const auto meshes = root.find("meshes"))
        for (const JsonValue& mesh : meshes->items())
            scene.meshes.push_back(read_mesh(mesh, directory));
    if (const auto colour = root.find("fog_colour")) scene.fog_colour = colour->vector3();
    if (const auto method = root.find("method")) scene.method = read_method(*method);
    if (const auto fogs = root.find("fog"))
        for (const JsonValue& fog : fogs->items()) {
            const auto model = fog.find("model");
            if (!model || model->text() == "wavelet") {
                const std::size_t before = scene.sequences.size();
                scene.fogs.push_back(read_fog(fog, directory, scene.sequences));
                if (scene.sequences.size() > before)
                    scene.sequences.back().fog = scene.fogs.size() - 1;
            } else if (model->text() == "particles") {
                scene.particles.push_back(detail::read_particles(fog));
            } else {
                scene.model_motions.push_back(detail::read_motion(fog));
                const auto& shapes = scene.model_motions.back().shapes;
                scene.models.push_back(shapes.empty() ? detail::read_model(fog)
                                                      : shapes.front().shape);
            }
        }
    // At home in the wind, as the first frame has them.
    scene.models = models_at(std::move(scene.models), scene.model_motions, 0);
    return scene;
}

}  // namespace

Result<Scene> load_scene(const fs::path& file) {
    try {
        const auto text = detail::read_text_file(file, kMaxSceneBytes);
        if (!text) return tl::unexpected(text.error());
        const std::string name = file.string();
        const auto json = detail::parse_json(*text, name);
        if (!json) return tl::unexpected(json.error());
        return read_scene(JsonValue(*json, name), file.parent_path());
    } catch (const JsonFailure& failure) {
        return tl::unexpected(failure.error);
    } catch (const std::bad_alloc&) {
        return data_error(fmt::format("{}: not enough memory; use smaller maps", file.string()));
    }
}

Result<ParticleSource> parse_particles(const std::string& json, const std::string& place) {
    try {
        const auto value = detail::parse_json(json, place);
        if (!value) return tl::unexpected(value.error());
        return detail::read_particles(JsonValue(*value, place));
    } catch (const JsonFailure& failure) {
        return tl::unexpected(failure.error);
    }
}

Result<Camera> find_camera(const Scene& scene, const std::string& name) {
    std::string names;
    for (const NamedCamera& named : scene.cameras) {
        if (named.name == name) return named.camera;
        names += (names.empty() ? "" : ", ") + named.name;
    }
    if (names.empty())
        return usage_error(fmt::format(
            "no camera \"{}\": the scene has its main camera alone; add it to \"cameras\"", name));
    return usage_error(
        fmt::format("no camera \"{}\"; choose one of: {}; or none for the main one", name, names));
}

bool coloured(const std::vector<Fog>& fogs, const std::vector<FogModel>& models,
              const std::vector<Channels>& particles) {
    for (const auto& found : {channels_of(fogs), channels_of(models), particles})
        for (const Channels& channels : found)
            if (channels != kAllChannels) return true;
    return false;
}

Result<SceneFogs> load_fogs(const fs::path& file, LoadNotes* notes) {
    if (const auto ok = detail::check_is_file(file); !ok) return tl::unexpected(ok.error());
    if (is_fog_file(file)) {
        auto fog = load_fog(file, notes);
        if (!fog) return tl::unexpected(fog.error());
        return SceneFogs{{std::move(*fog)}, {}, {}, {}, {}, {}, {}};
    }
    if (detail::lower_extension(file) == ".json") {
        auto scene = load_scene(file);
        if (!scene) return tl::unexpected(scene.error());
        return SceneFogs{std::move(scene->fogs),          std::move(scene->models),
                         std::move(scene->model_motions), std::move(scene->sequences),
                         std::move(scene->particles),     std::move(scene->terrain),
                         std::move(scene->meshes)};
    }
    const auto map = read_fogmap(file);
    if (!map) return tl::unexpected(map.error());
    auto fog = make_fog(map->pixels, {});
    if (!fog) return data_error(fmt::format("{}: {}", file.string(), fog.error().message));
    return SceneFogs{{std::move(*fog)}, {}, {}, {}, {}, {}, {}};
}

}  // namespace wavefog
