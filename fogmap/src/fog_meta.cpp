#include "fog_meta.h"

#include <fmt/format.h>

#include <cmath>

namespace wavefog::detail {

using nlohmann::json;

namespace {

constexpr int kMaxSide = 1 << 30;
constexpr int kMaxLevels = 30;
constexpr const char* kFormat = "wavefog";

json write_level(const PackedLevel& level) {
    json bands = json::array();
    for (const PackedBand& band : level.channels)
        bands.push_back(
            {{"start", {band.start_x, band.start_z}}, {"size", {band.width, band.height}}});
    return {{"level", level.level},
            {"offset", {level.x, level.y}},
            {"size", {level.width, level.height}},
            {"origin", {level.origin_x, level.origin_z}},
            {"bands", bands}};
}

std::pair<int, int> integer_pair(const JsonValue& value, int low) {
    const auto items = value.items();
    if (items.size() != 2) value.fail("must be a list of 2 integers");
    return {items[0].integer(low, kMaxSide), items[1].integer(low, kMaxSide)};
}

PackedLevel read_level(const JsonValue& value) {
    PackedLevel level;
    level.level = value.key("level").integer(0, kMaxLevels);
    std::tie(level.x, level.y) = integer_pair(value.key("offset"), 0);
    std::tie(level.width, level.height) = integer_pair(value.key("size"), 0);
    std::tie(level.origin_x, level.origin_z) = integer_pair(value.key("origin"), -kMaxSide);
    const auto bands = value.key("bands").items();
    if (bands.size() != 4) value.key("bands").fail("must list 4 bands, for R, G, B and A");
    for (std::size_t c = 0; c < 4; ++c) {
        PackedBand& band = level.channels[c];
        std::tie(band.start_x, band.start_z) = integer_pair(bands[c].key("start"), -kMaxSide);
        std::tie(band.width, band.height) = integer_pair(bands[c].key("size"), 0);
    }
    return level;
}

FogTexture read_texture(const JsonValue& value) {
    FogTexture texture;
    const JsonValue image = value.key("image");
    texture.image = image.text();
    // A description must not reach outside its own directory.
    if (texture.image.empty() || texture.image.find_first_of("/\\") != std::string::npos ||
        texture.image == "..")
        image.fail("must be the name of a file beside this one");
    if (const auto part = value.find("part")) texture.part = part->text();
    std::tie(texture.atlas.width, texture.atlas.height) = integer_pair(value.key("size"), 1);
    for (const JsonValue& level : value.key("levels").items())
        texture.atlas.levels.push_back(read_level(level));
    return texture;
}

}  // namespace

json write_meta(const FogMeta& meta) {
    const Fog& fog = meta.fog;
    const Decomposition<float>& d = fog.decomposition;
    json textures = json::array();
    for (const FogTexture& texture : meta.textures) {
        json levels = json::array();
        for (const PackedLevel& level : texture.atlas.levels) levels.push_back(write_level(level));
        json entry = {{"image", texture.image},
                      {"size", {texture.atlas.width, texture.atlas.height}},
                      {"levels", levels}};
        if (!texture.part.empty()) entry["part"] = texture.part;
        textures.push_back(entry);
    }
    const bool wavelet = d.form == Form::wavelet;
    return {{"format", kFormat},
            {"version", kFogFileVersion},
            {"layout", meta.layout == Layout::atlas    ? "atlas"
                       : meta.layout == Layout::levels ? "levels"
                                                       : "parts"},
            {"precision", meta.half ? "half" : "float"},
            {"scale", meta.scale},
            {"basis", basis_name(d.degree())},
            {"degree", d.degree()},
            {"family", d.family.name()},
            {"form", wavelet ? "wavelet" : "scaling"},
            {"wrap", d.boundary == Boundary::zero ? "zero" : "repeat"},
            {"map_size", {d.width, d.height}},
            {"detail_levels", d.levels()},
            {"channels", wavelet ? json{"phi phi", "phi psi", "psi phi", "psi psi"}
                                 : json{"approximation or residual", "", "", ""}},
            {"rect", {fog.rect.x0, fog.rect.z0, fog.rect.x1, fog.rect.z1}},
            {"extinction", fog.extinction},
            {"height", write_profile(fog.profile)},
            {"wind", write_wind(fog.wind)},
            {"textures", textures}};
}

bool is_meta(const json& value) {
    return value.is_object() && value.contains("format") && value["format"] == kFormat;
}

FogMeta read_meta(const JsonValue& value) {
    value.key("format").choice({kFormat});
    const JsonValue version = value.key("version");
    if (const int number = version.integer(1, kMaxSide); number != kFogFileVersion)
        version.fail(fmt::format("is {}; this program reads version {}: use a newer one", number,
                                 kFogFileVersion));
    FogMeta meta;
    switch (value.key("layout").choice({"atlas", "levels", "parts"})) {
        case 0:
            meta.layout = Layout::atlas;
            break;
        case 1:
            meta.layout = Layout::levels;
            break;
        default:
            meta.layout = Layout::parts;
    }
    meta.half = value.key("precision").choice({"half", "float"}) == 0;
    meta.scale = value.key("scale").above(0);

    PackedAtlas common;
    const int degree = value.key("degree").integer(0, kMaxDegree);
    const JsonValue family = value.key("family");
    const auto parsed = parse_family(family.text(), degree);
    if (!parsed) family.fail(parsed.error().message);
    common.family = *parsed;
    common.form =
        value.key("form").choice({"wavelet", "scaling"}) == 0 ? Form::wavelet : Form::scaling;
    common.boundary =
        value.key("wrap").choice({"zero", "repeat"}) == 0 ? Boundary::zero : Boundary::repeat;
    std::tie(common.map_width, common.map_height) = integer_pair(value.key("map_size"), 1);
    common.detail_levels = value.key("detail_levels").integer(0, kMaxLevels);

    Fog& fog = meta.fog;
    fog.rect = value.key("rect").rect();
    fog.extinction = value.key("extinction").number(0, HUGE_VAL);
    fog.profile = read_profile(value.key("height"));
    fog.wind = read_wind(value.key("wind"));

    const JsonValue textures = value.key("textures");
    for (const JsonValue& entry : textures.items()) {
        FogTexture texture = read_texture(entry);
        PackedAtlas layout = common;
        layout.width = texture.atlas.width;
        layout.height = texture.atlas.height;
        layout.levels = std::move(texture.atlas.levels);
        texture.atlas = std::move(layout);
        meta.textures.push_back(std::move(texture));
    }
    if (meta.textures.empty() || meta.textures.size() > kMaxLevels + 1)
        textures.fail(fmt::format("has {} entries; it must have 1 to {}", meta.textures.size(),
                                  kMaxLevels + 1));
    return meta;
}

}  // namespace wavefog::detail
