// Fog files: bit for bit in every layout, safe against damage, and no remains of a failure.
#include "wavefog/fogmap/fog_file.h"

#include <OpenImageIO/imageio.h>
#include <tinyexr.h>

#include <cstdlib>
#include <nlohmann/json.hpp>

#include "fogmap/fog_support.h"
#include "support/temp_dir.h"
#include "wavefog/fogmap/image.h"
#include "wavefog/wavelet/pack.h"
#include "wavefog/wavelet/quantise.h"

namespace wavefog::test {
namespace {

bool same(const Band<float>& a, const Band<float>& b) {
    if (a.values.size() == 0 && b.values.size() == 0) return true;
    return a.start_x == b.start_x && a.start_z == b.start_z && a.width() == b.width() &&
           a.height() == b.height() && (a.values == b.values).all();
}

bool same(const Decomposition<float>& a, const Decomposition<float>& b) {
    if (!(a.family == b.family) || a.form != b.form || a.boundary != b.boundary ||
        a.width != b.width || a.height != b.height || a.levels() != b.levels() ||
        !same(a.approximation, b.approximation))
        return false;
    for (std::size_t l = 0; l < a.details.size(); ++l)
        if (!same(a.details[l].phi_psi, b.details[l].phi_psi) ||
            !same(a.details[l].psi_phi, b.details[l].psi_phi) ||
            !same(a.details[l].psi_psi, b.details[l].psi_psi) ||
            !same(a.details[l].residual, b.details[l].residual))
            return false;
    return true;
}

bool same(const Fog& a, const Fog& b) {
    return a.rect == b.rect && a.extinction == b.extinction && a.profile == b.profile &&
           a.wind == b.wind && same(a.decomposition, b.decomposition);
}

Fog saved_fog(const std::filesystem::path& file, const FogOptions& options, const SaveOptions& save,
              Random& random, int width = 19, int height = 13) {
    Fog fog = random_fog(width, height, options, random);
    fog.profile = {.kind = Profile::Kind::exponential, .base = 0.1, .scale = 8};
    fog.wind = {1.5, -1.0 / 3};
    if (options.degree == 2) fog.wind.keys.push_back({1.0 / 7, 2, 0});
    fog.rect.x0 = -1.0 / 3;  // needs all digits of a double
    const auto ok = save_fog(file, fog, save);
    REQUIRE_MESSAGE(ok.has_value(), (ok ? "" : ok.error().message));
    return fog;
}

std::string load_error(const std::filesystem::path& file) {
    const auto fog = load_fog(file);
    return fog ? "loaded" : fog.error().message;
}

}  // namespace

TEST_CASE("a float fog file gives the fog back bit for bit in every layout") {
    Random random(31);
    const TempDir dir;
    int count = 0;
    for (const Layout layout : {Layout::atlas, Layout::levels, Layout::parts})
        for (const Form form : {Form::wavelet, Form::scaling})
            for (const Boundary boundary : {Boundary::zero, Boundary::repeat})
                for (int degree = 0; degree <= 3; ++degree)
                    for (const int levels : {0, 1, 3}) {
                        const auto file = dir / ("fog" + std::to_string(count++) + ".exr");
                        const FogOptions options{
                            .degree = degree, .form = form, .levels = levels, .boundary = boundary};
                        const Fog fog = saved_fog(file, options, {.layout = layout}, random,
                                                  16 + degree % 2 * 8, 8);
                        CAPTURE(static_cast<int>(layout));
                        CAPTURE(degree);
                        CAPTURE(levels);
                        const auto back = load_fog(file);
                        REQUIRE_MESSAGE(back.has_value(), (back ? "" : back.error().message));
                        CHECK(same(*back, fog));
                        CHECK(is_fog_file(file));
                        auto json = file;
                        const auto described = load_fog(json.replace_extension(".json"));
                        REQUIRE(described.has_value());
                        CHECK(same(*described, fog));
                    }
}

TEST_CASE("path-integral tables are parts beside the levels and change nothing else") {
    Random random(37);
    const TempDir dir;
    const auto file = dir / "paths.exr";
    for (const PathLayout layout : {PathLayout::mean, PathLayout::perimeter}) {
        const Fog fog = saved_fog(file, {.degree = 2, .levels = 2},
                                  {.layout = Layout::parts, .path_table = 4, .path_layout = layout},
                                  random, 20, 12);
        const auto back = load_fog(file);
        REQUIRE_MESSAGE(back.has_value(), (back ? "" : back.error().message));
        CHECK(same(*back, fog));
        const auto table = make_path_table(fog.decomposition.family, 4, layout, true);
        REQUIRE(table.has_value());
        // Read by another library, by the part's name.
        auto input = OIIO::ImageInput::open(file.string());
        REQUIRE(input);
        int found = 0;
        for (int part = 0; input->seek_subimage(part, 0); ++part) {
            const std::string name = input->spec().get_string_attribute("oiio:subimagename");
            const PathTexture* texture = name == "whole_paths"     ? &table->whole
                                         : name == "partial_paths" ? &table->partial
                                                                   : nullptr;
            if (!texture) continue;
            ++found;
            REQUIRE(input->spec().width == texture->width);
            REQUIRE(input->spec().height == texture->height);
            std::vector<float> rgba(texture->rgba.size());
            REQUIRE(input->read_image(part, 0, 0, 4, OIIO::TypeDesc::FLOAT, rgba.data()));
            CHECK(rgba == texture->rgba);
        }
        CHECK(found == 2);
    }
    const Fog fog = fog_of(make_map<float>(MapKind::random, 8, 8, random), {.degree = 1});
    const auto refused = save_fog(dir / "atlas.exr", fog, {.path_table = 4});
    REQUIRE(!refused.has_value());
    CHECK(refused.error().kind == ErrorKind::usage);
    CHECK(!std::filesystem::exists(dir / "atlas.exr"));
}

TEST_CASE("odd sizes, other families and wild ranges come back bit for bit") {
    Random random(32);
    const TempDir dir;
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 17}, {23, 1}, {31, 7}})
        for (int degree = 0; degree <= 4; ++degree) {
            const Fog fog =
                saved_fog(dir / "odd.exr", {.degree = degree}, {}, random, width, height);
            const auto back = load_fog(dir / "odd.exr");
            REQUIRE_MESSAGE(back.has_value(), (back ? "" : back.error().message));
            CHECK(same(*back, fog));
        }
    for (const char* family : {"2,4", "chui-wang", "2,0"}) {
        const Fog fog = saved_fog(dir / "family.exr", {.family = family}, {}, random);
        const auto back = load_fog(dir / "family.exr");
        REQUIRE(back.has_value());
        CHECK(same(*back, fog));
    }
    // Coefficients from 1e30 down to 1e-38: scaling to 1 would push the small ones below float's
    // range.
    Grid<float> map = make_map<float>(MapKind::random, 16, 16, random);
    map(3, 3) = 1e30f;
    map(12, 12) = 1e-38f;
    for (const float factor : {1.0f, 1e-30f, 1024.0f}) {
        const Fog fog = fog_of(factor * map.min(1e30f / factor), {.degree = 0, .levels = 0});
        REQUIRE(save_fog(dir / "wild.exr", fog).has_value());
        const auto back = load_fog(dir / "wild.exr");
        REQUIRE(back.has_value());
        CHECK(same(*back, fog));
    }
}

TEST_CASE("a half file holds the closed-loop rounding of the map scaled to 1") {
    Random random(33);
    const TempDir dir;
    for (const Layout layout : {Layout::atlas, Layout::levels, Layout::parts})
        for (int degree = 0; degree <= 2; ++degree) {
            Fog fog = saved_fog(
                dir / "half.exr",
                {.degree = degree, .family = "positive", .form = Form::scaling, .levels = 3},
                {.half = true, .layout = layout}, random, 33, 20);
            const auto back = load_fog(dir / "half.exr");
            REQUIRE_MESSAGE(back.has_value(), (back ? "" : back.error().message));
            const Grid<float> before = reconstruct(fog.decomposition);
            const Grid<float> after = reconstruct(back->decomposition);
            // Rounded up, by at most a half float's step below 1: 2^-11, with float32's own
            // rounding.
            CHECK((after - before).minCoeff() >= -1e-6f);
            CHECK((after - before).maxCoeff() <= 0x1p-11f + 1e-6f);
        }
    // A map far above what half floats hold is scaled first.
    Fog bright =
        fog_of(1e9f * make_map<float>(MapKind::random, 20, 20, random), {.form = Form::scaling});
    REQUIRE(save_fog(dir / "bright.exr", bright, {.half = true}).has_value());
    const auto back = load_fog(dir / "bright.exr");
    REQUIRE(back.has_value());
    const Grid<float> error = reconstruct(back->decomposition) - reconstruct(bright.decomposition);
    CHECK(error.abs().maxCoeff() < 1e9f / 512);
}

TEST_CASE("TinyEXR reads the atlas texel for texel") {
    Random random(34);
    const TempDir dir;
    for (const bool half : {false, true})
        for (const Form form : {Form::wavelet, Form::scaling}) {
            const auto file = dir / "atlas.exr";
            saved_fog(file, {.degree = 2, .form = form, .levels = 3}, {.half = half}, random, 45,
                      30);
            const auto stored = load_fog(file);
            REQUIRE(stored.has_value());
            const PackedAtlas atlas = pack(stored->decomposition);
            const auto description = nlohmann::json::parse(read_bytes(dir / "atlas.json"));
            const float scale = description["scale"].get<float>();

            float* rgba = nullptr;
            int width = 0, height = 0;
            const char* message = nullptr;
            const int code = LoadEXR(&rgba, &width, &height, file.c_str(), &message);
            REQUIRE_MESSAGE(code == TINYEXR_SUCCESS, (message ? message : ""));
            REQUIRE(width == atlas.width);
            REQUIRE(height == atlas.height);
            std::size_t different = 0;
            for (std::size_t i = 0; i < atlas.rgba.size(); ++i)
                if (rgba[i] * scale != atlas.rgba[i]) ++different;
            std::free(rgba);
            CHECK(different == 0);
        }
}

TEST_CASE("each level's own file opens in TinyEXR, and any of them loads the fog") {
    Random random(35);
    const TempDir dir;
    const Fog fog = saved_fog(dir / "banks.exr", {.degree = 1, .form = Form::scaling, .levels = 2},
                              {.layout = Layout::levels}, random);
    CHECK(dir.names() ==
          std::vector<std::string>{"banks.json", "banks.l0.exr", "banks.l1.exr", "banks.l2.exr"});
    for (const char* name :
         {"banks.l0.exr", "banks.l1.exr", "banks.l2.exr", "banks.exr", "banks.json"}) {
        CAPTURE(name);
        const auto back = load_fog(dir / name);
        REQUIRE_MESSAGE(back.has_value(), (back ? "" : back.error().message));
        CHECK(same(*back, fog));
        CHECK(is_fog_file(dir / name));
    }
    float* rgba = nullptr;
    int width = 0, height = 0;
    const char* message = nullptr;
    CHECK(LoadEXR(&rgba, &width, &height, (dir / "banks.l1.exr").c_str(), &message) ==
          TINYEXR_SUCCESS);
    std::free(rgba);

    std::filesystem::remove(dir / "banks.l1.exr");
    CHECK(contains(load_error(dir / "banks.exr"), "banks.l1.exr: no such file"));
}

TEST_CASE("header and JSON say the same, and the picture is an ordinary image too") {
    Random random(36);
    const TempDir dir;
    saved_fog(dir / "a.exr", {.degree = 1, .levels = 2}, {}, random);
    const auto picture = read_image(dir / "a.exr");
    REQUIRE(picture.has_value());
    CHECK(picture->channels == 4);
    const auto description = nlohmann::json::parse(read_bytes(dir / "a.json"));
    const std::string header = read_bytes(dir / "a.exr").substr(0, 8192);
    for (const auto& [key, value] : description.items()) CHECK(contains(header, "wavefog." + key));
    CHECK(description["basis"] == "linear");
    CHECK(description["family"] == "2,2");
    CHECK(description["map_size"] == nlohmann::json{19, 13});
    // The header alone is enough, under any name.
    std::filesystem::rename(dir / "a.exr", dir / "moved.exr");
    CHECK(load_fog(dir / "moved.exr").has_value());
}

TEST_CASE("pictures, other formats and missing files are told apart from fog files") {
    const TempDir dir;
    Image picture{4, 4, 4, std::vector<float>(64, 0.5f)};
    REQUIRE(write_image(dir / "picture.exr", picture).has_value());
    CHECK_FALSE(is_fog_file(dir / "picture.exr"));
    CHECK(contains(load_error(dir / "picture.exr"), "is a picture, not a fog file"));
    write_bytes(dir / "scene.json", "{\"camera\": {}}");
    CHECK_FALSE(is_fog_file(dir / "scene.json"));
    CHECK(contains(load_error(dir / "scene.json"), "format: is missing"));
    CHECK_FALSE(is_fog_file(dir / "nothing.exr"));
    CHECK(contains(load_error(dir / "nothing.exr"), "no such file"));
    CHECK(contains(load_error(dir / "fog.wfog"), "no such file"));
    write_bytes(dir / "fog.wfog", "not one of ours");
    CHECK(contains(load_error(dir / "fog.wfog"), "is no .wfog file"));
    CHECK(contains(load_error(dir / "fog.ktx2"), "ends in .exr"));
    const Fog fog = fog_of(Grid<float>::Constant(4, 4, 1.0f), {});
    CHECK(save_fog(dir / "fog.png", fog).error().kind == ErrorKind::usage);
}

TEST_CASE("a failed save leaves no file and keeps the old one") {
    Random random(37);
    const TempDir dir;
    const Fog fog = saved_fog(dir / "kept.exr", {}, {}, random);
    const auto names = dir.names();
    const std::string before = read_bytes(dir / "kept.exr");

    Fog broken = fog;
    broken.extinction = -1;
    CHECK(contains(save_fog(dir / "kept.exr", broken).error().message, "extinction is -1"));
    CHECK_FALSE(save_fog(dir / "missing" / "fog.exr", fog).has_value());
    std::filesystem::create_directory(dir / "folder.exr");
    CHECK(contains(save_fog(dir / "folder.exr", fog).error().message, "is a directory"));
    std::filesystem::remove(dir / "folder.exr");
    // The last of three files cannot be written: the first two must go as well.
    std::filesystem::create_directory(dir / "late.l2.exr");
    CHECK_FALSE(save_fog(dir / "late.exr", fog, {.layout = Layout::levels}).has_value());
    std::filesystem::remove(dir / "late.l2.exr");
    // A scene of the same name is not overwritten.
    write_bytes(dir / "valley.json", "{}");
    CHECK(contains(save_fog(dir / "valley.exr", fog).error().message, "is no fog description"));
    std::filesystem::remove(dir / "valley.json");

    CHECK(dir.names() == names);
    CHECK(read_bytes(dir / "kept.exr") == before);
}

TEST_CASE("every damaged byte and every truncation of a fog file is an error or a valid fog") {
    Random random(38);
    const TempDir dir;
    saved_fog(dir / "good.exr", {.degree = 1, .levels = 2}, {.half = true}, random, 9, 7);
    const std::string good = read_bytes(dir / "good.exr");
    const auto bad = dir / "bad.exr";
    for (std::size_t length = 0; length < good.size(); length += 1 + good.size() / 300) {
        write_bytes(bad, good.substr(0, length));
        CHECK_FALSE(load_fog(bad).has_value());
    }
    int accepted = 0;
    for (int trial = 0; trial < 1500; ++trial) {
        std::string bytes = good;
        for (int n = random.integer(1, 3); n > 0; --n)
            bytes[static_cast<std::size_t>(random.integer(0, static_cast<int>(bytes.size()) - 1))] =
                static_cast<char>(random.integer(0, 255));
        write_bytes(bad, bytes);
        const auto fog = load_fog(bad);
        if (!fog) continue;
        ++accepted;
        CHECK(fog->validate().has_value());
        approximations(fog->decomposition);  // must not read or write out of range (asan)
    }
    MESSAGE("accepted " << accepted
                        << " of 1500 damaged files (damage in texels or spare attributes)");
}

TEST_CASE("a description that lies about its images is an error") {
    Random random(39);
    const TempDir dir;
    saved_fog(dir / "a.exr", {.degree = 1, .levels = 2}, {}, random);
    const auto good = nlohmann::json::parse(read_bytes(dir / "a.json"));
    const auto error_with = [&](const std::string& pointer, const nlohmann::json& value) {
        auto description = good;
        description[nlohmann::json::json_pointer(pointer)] = value;
        write_bytes(dir / "lie.json", description.dump());
        return load_error(dir / "lie.json");
    };
    REQUIRE(load_fog(dir / "a.json").has_value());
    struct Lie {
        std::string pointer;
        nlohmann::json value;
        std::string message;
    };
    const std::vector<Lie> lies = {
        {"/version", 2, "version: is 2; this program reads version 1"},
        {"/format", "fog", "format: is \"fog\""},
        {"/layout", "cloud", "layout: is \"cloud\""},
        {"/degree", 99, "degree: is 99"},
        {"/degree", 2, "family"},
        {"/family", "9,9", "family"},
        {"/family", "2,4", "do not fit"},
        {"/form", "scaling", "level"},
        {"/wrap", "repeat", "2 levels"},
        {"/map_size", {20, 13}, "do not fit"},
        {"/map_size", {1 << 29, 1 << 29}, "is larger than its textures"},
        {"/map_size", {0, 13}, "map_size[0]: is 0"},
        {"/detail_levels", 3, "level"},
        {"/detail_levels", -1, "detail_levels: is -1"},
        {"/scale", 0, "scale: is 0"},
        {"/scale", 1e300, "infinite"},
        {"/rect", {1, 0, 0, 1}, "rect: is [1, 0, 0, 1]"},
        {"/extinction", -1, "extinction: is -1"},
        {"/height", {{"profile", "exponential"}, {"base", 0}, {"scale", 0}}, "scale is 0"},
        {"/wind", {1}, "wind: has 1 entries"},
        {"/textures", nlohmann::json::array(), "textures: has 0 entries"},
        {"/textures/0/image", "../a.exr", "must be the name of a file"},
        {"/textures/0/image", "gone.exr", "gone.exr: no such file"},
        {"/textures/0/part", "l7", "has no part l7"},
        {"/textures/0/size/0", 5, "its description says 5 x"},
        {"/textures/0/levels/0/offset/0", 1 << 20, "outside"},
        {"/textures/0/levels/0/offset/0", -1, "offset[0]: is -1"},
        {"/textures/0/levels/0/origin/0", -(1 << 30), "out of range"},
        {"/textures/0/levels/0/level", 2, "level"},
        {"/textures/0/levels/0/bands/1/start/0", 1 << 30, "outside"},
        {"/textures/0/levels/0/bands/1/size/0", 1 << 30, "outside"},
        {"/textures/0/levels/0/bands/1/size/0", 1, "do not fit"},
        {"/textures/0/levels/0/bands", {1, 2}, "must list 4 bands"},
    };
    for (const Lie& lie : lies) {
        CAPTURE(lie.pointer);
        const std::string message = error_with(lie.pointer, lie.value);
        CAPTURE(message);
        CHECK(contains(message, "lie.json") == !contains(lie.message, "no such file"));
        CHECK(contains(message, lie.message));
    }
}

}  // namespace wavefog::test
