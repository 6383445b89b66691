#include "wavefog/fogmap/fog_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <new>

#include "exr_io.h"
#include "file_io.h"
#include "fog_meta.h"
#include "wavefog/fogmap/wfog.h"
#include "wavefog/wavelet/quantise.h"

namespace wavefog {

namespace fs = std::filesystem;
using detail::ExrFile;
using detail::ExrImage;
using detail::FogMeta;
using detail::FogTexture;
using detail::PendingFile;

namespace {

constexpr std::uintmax_t kMaxMetaBytes = 16u << 20;

// --- The one place that knows which extension is which format.

enum class FileFormat { exr, description, wfog, unknown };

FileFormat format_of(const fs::path& file) {
    const std::string extension = detail::lower_extension(file);
    return extension == ".exr"    ? FileFormat::exr
           : extension == ".json" ? FileFormat::description
           : extension == ".wfog" ? FileFormat::wfog
                                  : FileFormat::unknown;
}

tl::unexpected<Error> no_such_format(const fs::path& file) {
    return usage_error(
        fmt::format("{}: a fog file ends in .exr (or .json, its description) or .wfog; use one of "
                    "these",
                    file.string()));
}

template <class Function>
void for_each_band(Decomposition<float>& decomposition, Function function) {
    function(decomposition.approximation);
    for (Detail<float>& detail : decomposition.details)
        for (Band<float>* band :
             {&detail.phi_psi, &detail.psi_phi, &detail.psi_psi, &detail.residual})
            function(*band);
}

/// The least power of two that is not below any coefficient; 1 for an empty map.
double power_of_two_scale(Decomposition<float>& decomposition) {
    float largest = 0;
    for_each_band(decomposition, [&](const Band<float>& band) {
        if (band.values.size() > 0) largest = std::max(largest, band.values.abs().maxCoeff());
    });
    if (largest == 0) return 1;
    int exponent = 0;
    const float fraction = std::frexp(largest, &exponent);  // [0.5, 1)
    return std::ldexp(1.0, fraction == 0.5f ? exponent - 1 : exponent);
}

/// Multiplies by a power of two; false if a coefficient became too small to keep all its bits.
bool rescale(Decomposition<float>& decomposition, double factor) {
    bool exact = true;
    for_each_band(decomposition, [&](Band<float>& band) {
        band.values = band.values.unaryExpr([&](float value) {
            const double wanted = static_cast<double>(value) * factor;
            const float stored = static_cast<float>(wanted);
            exact = exact && static_cast<double>(stored) == wanted;
            return stored;
        });
    });
    return exact;
}

// --- Saving

Result<FogMeta> make_meta(const fs::path& file, const Fog& fog, const SaveOptions& options) {
    FogMeta meta;
    meta.layout = options.layout;
    meta.half = options.half;
    meta.fog = fog;
    Decomposition<float>& scaled = meta.fog.decomposition;
    meta.scale = power_of_two_scale(scaled);
    if (!rescale(scaled, 1 / meta.scale) && !options.half) {
        // A map that spans more than float's exponents is kept as it is: bit for bit comes first.
        scaled = fog.decomposition;
        meta.scale = 1;
    }
    if (options.half)
        if (const auto ok = round_to_half_closed_loop(scaled); !ok)
            return data_error(fmt::format("{}: {}", file.string(), ok.error().message));

    const std::string stem = file.stem().string();
    if (options.layout == Layout::atlas) {
        meta.textures.push_back({stem + ".exr", "", pack(scaled)});
        return meta;
    }
    for (PackedAtlas& atlas : pack_levels(scaled)) {
        const std::string level = fmt::format("l{}", atlas.levels.front().level);
        const bool own_file = options.layout == Layout::levels;
        meta.textures.push_back({own_file ? fmt::format("{}.{}.exr", stem, level) : stem + ".exr",
                                 own_file ? "" : level, std::move(atlas)});
    }
    return meta;
}

/// Path-integral tables as further parts, and what the description says of them.
Result<void> add_path_table(const Decomposition<float>& d, const SaveOptions& options,
                            std::vector<ExrImage>& parts, nlohmann::json& description) {
    if (options.layout != Layout::parts || options.half)
        return usage_error(
            "--path-table: tables are float parts of a multi-part file; use --layout parts and "
            "--precision float");
    const bool wavelets = d.form == Form::wavelet && d.levels() > 0;
    auto table = make_path_table(d.family, options.path_table, options.path_layout, wavelets);
    if (!table) return tl::unexpected(table.error());
    nlohmann::json functions = nlohmann::json::array();
    constexpr const char* kNames[] = {"phi phi", "phi psi", "psi phi", "psi psi"};
    for (std::size_t f = 0; f < table->functions.size(); ++f) {
        const auto& function = table->functions[f];
        if (function.pieces_x > 0)
            functions.push_back({{"name", kNames[f]},
                                 {"first_block", function.first_block},
                                 {"pieces", {function.pieces_x, function.pieces_z}}});
    }
    description["path_table"] = {
        {"samples", table->samples},
        {"layout", table->layout == PathLayout::mean ? "mean" : "perimeter"},
        {"psi_first", table->psi_first},
        {"functions", functions}};
    for (auto& [name, texture] :
         {std::pair{"whole_paths", &table->whole}, std::pair{"partial_paths", &table->partial}})
        parts.push_back({name, texture->width, texture->height, std::move(texture->rgba)});
    return {};
}

Result<nlohmann::json> read_description(const fs::path& file) {
    const auto text = detail::read_text_file(file, kMaxMetaBytes);
    if (!text) return tl::unexpected(text.error());
    return detail::parse_json(*text, file.string());
}

/// All files under temporary names first, then all renames: what can fail has failed before the
/// first old file is replaced.
Result<void> save_exr(const fs::path& file, const Fog& fog, const SaveOptions& options) {
    if (const auto ok = fog.validate(); !ok)
        return data_error(fmt::format("{}: {}", file.string(), ok.error().message));
    if (const auto ok = detail::check_writable_place(file); !ok) return ok;
    auto meta = make_meta(file, fog, options);
    if (!meta) return tl::unexpected(meta.error());
    nlohmann::json description = write_meta(*meta);

    std::map<std::string, std::vector<ExrImage>> files;
    for (FogTexture& texture : meta->textures)
        files[texture.image].push_back({texture.part, texture.atlas.width, texture.atlas.height,
                                        std::move(texture.atlas.rgba)});
    if (options.path_table > 0)
        if (const auto ok =
                add_path_table(fog.decomposition, options, files.begin()->second, description);
            !ok)
            return ok;
    std::vector<PendingFile> pending;
    for (const auto& [name, images] : files) {
        const fs::path target = fs::path(file).replace_filename(name);
        if (const auto ok = detail::check_writable_place(target); !ok) return ok;
        pending.emplace_back(target);
        if (const auto ok = write_exr(pending.back().path(), images, options.half, description);
            !ok)
            return ok;
    }
    const fs::path beside = fs::path(file).replace_extension(".json");
    if (const auto ok = detail::check_writable_place(beside); !ok) return ok;
    std::error_code error;
    if (fs::exists(beside, error)) {
        const auto old = read_description(beside);
        if (!old || !detail::is_meta(*old))
            return data_error(
                fmt::format("{}: {} is there and is no fog description (a scene?); choose "
                            "another name",
                            file.string(), beside.string()));
    }
    pending.emplace_back(beside);
    if (const auto ok = detail::write_text_file(pending.back().path(), description.dump(1) + "\n");
        !ok)
        return ok;
    for (PendingFile& each : pending)
        if (const auto ok = each.commit(); !ok) return ok;
    // An older fog under the name itself would be found before the levels beside it.
    if (options.layout == Layout::levels) fs::remove(file, error);
    return {};
}

// --- Loading

bool same_place(const Band<float>& a, const Band<float>& b) {
    if (a.values.size() == 0 && b.values.size() == 0) return true;
    return a.start_x == b.start_x && a.start_z == b.start_z && a.width() == b.width() &&
           a.height() == b.height();
}

/// The bands of a map depend on its size, family, form, levels and border alone: compare with those
/// of an empty map. After this nothing in the file can send the transform astray.
Result<void> check_bands(const Decomposition<float>& found) {
    const auto expected = decompose(Grid<float>(Grid<float>::Zero(found.height, found.width)),
                                    found.family, found.levels(), found.form, found.boundary);
    if (!expected) return tl::unexpected(expected.error());
    bool same = expected->levels() == found.levels() &&
                same_place(expected->approximation, found.approximation);
    for (std::size_t l = 0; same && l < found.details.size(); ++l) {
        const Detail<float>&a = expected->details[l], &b = found.details[l];
        same = same_place(a.phi_psi, b.phi_psi) && same_place(a.psi_phi, b.psi_phi) &&
               same_place(a.psi_psi, b.psi_psi) && same_place(a.residual, b.residual);
    }
    if (!same)
        return data_error("start indices or sizes do not fit a map of map_size; convert it again");
    return {};
}

Result<Fog> assemble(FogMeta meta) {
    double texels = 0;
    std::vector<PackedAtlas> atlases;
    for (FogTexture& texture : meta.textures) {
        texels += double(texture.atlas.width) * texture.atlas.height;
        atlases.push_back(std::move(texture.atlas));
    }
    // Every pixel is at least one coefficient: a larger map than that is a lie to allocate for.
    if (double(atlases[0].map_width) * atlases[0].map_height > 4 * texels)
        return data_error(
            fmt::format("map_size {} x {} is larger than its textures; convert it again",
                        atlases[0].map_width, atlases[0].map_height));
    auto decomposition = unpack(std::span<const PackedAtlas>(atlases));
    if (!decomposition) return tl::unexpected(decomposition.error());
    if (const auto ok = check_bands(*decomposition); !ok) return tl::unexpected(ok.error());
    rescale(*decomposition, meta.scale);
    meta.fog.decomposition = std::move(*decomposition);
    if (const auto ok = meta.fog.validate(); !ok) return tl::unexpected(ok.error());
    return std::move(meta.fog);
}

/// `read` holds files that are in memory already, by name.
Result<Fog> load_described(const fs::path& file, const nlohmann::json& description,
                           std::map<std::string, ExrFile> read) {
    const std::string name = file.string();
    FogMeta meta = read_meta(detail::JsonValue(description, name));
    for (FogTexture& texture : meta.textures) {
        auto found = read.find(texture.image);
        if (found == read.end()) {
            auto images = detail::read_exr(fs::path(file).replace_filename(texture.image), true);
            if (!images) return tl::unexpected(images.error());
            found = read.emplace(texture.image, std::move(*images)).first;
        }
        auto& images = found->second.images;
        const auto image =
            texture.part.empty()
                ? images.begin()
                : std::find_if(images.begin(), images.end(),
                               [&](const ExrImage& each) { return each.name == texture.part; });
        if (image == images.end())
            return data_error(fmt::format("{}: {} has no part {}; convert the map again", name,
                                          texture.image, texture.part));
        if (image->width != texture.atlas.width || image->height != texture.atlas.height ||
            image->rgba.empty())
            return data_error(
                fmt::format("{}: {} is {} x {} texels, its description says {} x {}; convert "
                            "the map again",
                            name, texture.image, image->width, image->height, texture.atlas.width,
                            texture.atlas.height));
        texture.atlas.rgba = std::move(image->rgba);
    }
    auto fog = assemble(std::move(meta));
    if (!fog) return data_error(fmt::format("{}: {}", name, fog.error().message));
    return fog;
}

Result<Fog> load_description(const fs::path& file) {
    const auto description = read_description(file);
    if (!description) return tl::unexpected(description.error());
    return load_described(file, *description, {});
}

Result<Fog> load_exr(const fs::path& file) {
    std::error_code error;
    const fs::path beside = fs::path(file).replace_extension(".json");
    // `levels` has no file of the base name itself.
    if (!fs::exists(file, error) && fs::exists(beside, error)) return load_description(beside);
    auto read = detail::read_exr(file, false);
    if (!read) return tl::unexpected(read.error());
    if (!detail::is_meta(read->attributes))
        return data_error(
            fmt::format("{}: is a picture, not a fog file; convert it first "
                        "(wavefog convert {} -o fog.exr)",
                        file.string(), file.string()));
    const nlohmann::json description = read->attributes;
    read = detail::read_exr(file, true);
    if (!read) return tl::unexpected(read.error());
    std::map<std::string, ExrFile> files;
    // A renamed file still is what its own description calls it, unless it is one of several.
    const bool alone = description.value("layout", "") != "levels";
    const auto& textures = description.find("textures");
    if (alone && textures != description.end() && textures->is_array() && !textures->empty() &&
        (*textures)[0].is_object() && (*textures)[0].contains("image") &&
        (*textures)[0]["image"].is_string())
        files.emplace((*textures)[0]["image"].get<std::string>(), std::move(*read));
    else
        files.emplace(file.filename().string(), std::move(*read));
    return load_described(file, description, std::move(files));
}

// --- Compact files

Result<void> write_wfog(const fs::path& file, std::span<const std::uint8_t> bytes) {
    if (const auto ok = detail::check_writable_place(file); !ok) return ok;
    PendingFile pending(file);
    const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (const auto ok = detail::write_text_file(pending.path(), text); !ok) return ok;
    return pending.commit();
}

Result<void> save_lossless(const fs::path& file, const Fog& fog) {
    WfogOptions options;
    options.best = true;
    const auto encoded = encode_wfog(fog, options);
    if (!encoded) return data_error(fmt::format("{}: {}", file.string(), encoded.error().message));
    return write_wfog(file, encoded->bytes);
}

Result<Fog> load_wfog(const fs::path& file, LoadNotes* notes) {
    constexpr std::uintmax_t most = std::uintmax_t{4} << 30;
    const auto bytes = detail::read_text_file(file, most);
    if (!bytes) return tl::unexpected(bytes.error());
    WfogLimits limits;
    limits.partial = notes != nullptr;
    auto decoded =
        decode_wfog({reinterpret_cast<const std::uint8_t*>(bytes->data()), bytes->size()}, limits);
    if (!decoded) return data_error(fmt::format("{}: {}", file.string(), decoded.error().message));
    if (notes) {
        if (decoded->levels < decoded->of_levels)
            notes->warning =
                fmt::format("{}: ends early; it is shown with the {} coarsest of {} levels",
                            file.string(), decoded->levels, decoded->of_levels);
        notes->map = std::move(decoded->map);
        notes->stream_levels = decoded->levels;
        notes->of_levels = decoded->of_levels;
        notes->max_error = decoded->max_error;
    }
    return std::move(decoded->fog);
}

template <class Function>
auto guarded(const fs::path& file, Function function) -> decltype(function()) {
    try {
        return function();
    } catch (const detail::JsonFailure& failure) {
        return tl::unexpected(failure.error);
    } catch (const std::bad_alloc&) {
        return data_error(fmt::format("{}: not enough memory; use a smaller map", file.string()));
    } catch (const std::exception& error) {
        return data_error(fmt::format("{}: cannot be used ({}); convert the map again",
                                      file.string(), error.what()));
    }
}

}  // namespace

Result<void> save_fog(const fs::path& file, const Fog& fog, const SaveOptions& options) {
    const FileFormat format = format_of(file);
    if (format == FileFormat::wfog) return guarded(file, [&] { return save_lossless(file, fog); });
    if (format != FileFormat::exr) return no_such_format(file);
    return guarded(file, [&] { return save_exr(file, fog, options); });
}

Result<void> save_wfog(const fs::path& file, std::span<const std::uint8_t> bytes) {
    return guarded(file, [&] { return write_wfog(file, bytes); });
}

Result<Fog> load_fog(const fs::path& file, LoadNotes* notes) {
    switch (format_of(file)) {
        case FileFormat::exr:
            return guarded(file, [&] { return load_exr(file); });
        case FileFormat::description:
            return guarded(file, [&] { return load_description(file); });
        case FileFormat::wfog:
            return guarded(file, [&] { return load_wfog(file, notes); });
        case FileFormat::unknown:
            break;
    }
    return no_such_format(file);
}

bool is_fog_file(const fs::path& file) {
    const auto described = guarded(file, [&]() -> Result<bool> {
        std::error_code error;
        switch (format_of(file)) {
            case FileFormat::exr: {
                const fs::path beside = fs::path(file).replace_extension(".json");
                if (!fs::exists(file, error))
                    return fs::exists(beside, error) && is_fog_file(beside);
                const auto read = detail::read_exr(file, false);
                return read && detail::is_meta(read->attributes);
            }
            case FileFormat::description: {
                const auto description = read_description(file);
                return description && detail::is_meta(*description);
            }
            case FileFormat::wfog:
                return fs::exists(file, error);
            case FileFormat::unknown:
                break;
        }
        return false;
    });
    return described && *described;
}

}  // namespace wavefog
