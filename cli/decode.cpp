// wavefog decode: the map of a fog file as a picture.
#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <memory>
#include <optional>

#include "command.h"
#include "files.h"
#include "interrupt.h"
#include "options.h"
#include "report.h"
#include "wavefog/fogmap/fog_file.h"
#include "wavefog/fogmap/image.h"
#include "wavefog/fogmap/wfog.h"

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

struct DecodeOptions {
    fs::path input, output;
    std::optional<int> level, streams;
    bool json = false;
};

Image picture_of(const Grid<float>& values) {
    Image image{int(values.cols()), int(values.rows()), 1, {}};
    image.pixels.assign(values.data(), values.data() + values.size());
    return image;
}

/// The fog of a .wfog file's first streams.
Result<Fog> load_streams(const fs::path& file, int streams, LoadNotes& notes) {
    if (extension_of(file) != ".wfog")
        return usage_error(
            fmt::format("--streams is about .wfog files; leave it out for {}", file.string()));
    std::ifstream stream(file, std::ios::binary);
    WfogLimits limits;
    limits.partial = true;
    limits.levels = streams;
    auto decoded = decode_wfog(stream, limits);
    if (!decoded)
        return tl::unexpected(Error{decoded.error().kind,
                                    fmt::format("{}: {}", file.string(), decoded.error().message)});
    notes.map = std::move(decoded->map);
    notes.stream_levels = decoded->levels;
    notes.of_levels = decoded->of_levels;
    notes.max_error = decoded->max_error;
    return std::move(decoded->fog);
}

Result<void> decode(const DecodeOptions& options) {
    // A fog of --layout levels is found by the name it was saved under, which is no file's.
    if (auto ok = check_input(options.input); !ok && !is_fog_file(options.input)) return ok;
    if (auto ok = check_output(options.output, {options.input}, {".exr", ".tif", ".tiff", ".png"});
        !ok)
        return ok;
    LoadNotes notes;
    const Result<Fog> fog = options.streams ? load_streams(options.input, *options.streams, notes)
                                            : load_fog(options.input, &notes);
    if (!fog) return tl::unexpected(fog.error());
    if (!notes.warning.empty()) warn(notes.warning);
    const Decomposition<float>& d = fog->decomposition;
    const int level = options.level.value_or(d.levels());
    if (level > d.levels())
        return usage_error(
            fmt::format("--level {}: {} has levels 0 (coarsest) to {} (the map "
                        "itself); choose one of them",
                        level, options.input.string(), d.levels()));
    Band<float> band;
    if (level == d.levels())
        band.values = notes.map.size() > 0 ? std::move(notes.map) : reconstruct(d);
    else
        band = approximations(d).levels[static_cast<std::size_t>(level)];

    constexpr float half_step = 0.5f / 65535;  // of a 16-bit PNG: less is lost by rounding anyway
    const auto outside = ((band.values < -half_step) || (band.values > 1 + half_step)).count();
    if (extension_of(options.output) == ".png" && outside > 0)
        warn(
            fmt::format("{}: {} of {} coefficients lie outside [0,1] and were clamped; .exr and "
                        ".tif keep them",
                        options.output.string(), outside, band.values.size()));
    {
        const HoldInterrupts hold;
        if (auto ok = write_image(options.output, picture_of(band.values)); !ok) return ok;
    }
    const double cell = double(1 << (d.levels() - level));
    Facts facts = {{"wrote", options.output.string()},
                   {"level", level},
                   {"size", {band.width(), band.height()}},
                   {"start", {band.start_x, band.start_z}},
                   {"cell", {cell * fog->cell_x(), cell * fog->cell_z()}},
                   {"min", band.values.minCoeff()},
                   {"max", band.values.maxCoeff()},
                   {"bytes", file_bytes(options.output)}};
    facts.update(stream_facts(notes));
    print_facts(facts, options.json);
    return {};
}

}  // namespace

Command add_decode(CLI::App& root) {
    auto options = std::make_shared<DecodeOptions>();
    CLI::App* app = root.add_subcommand("decode", "Turn a fog file back into a picture");
    app->add_option("FOG", options->input, "A fog file")->required();
    app->add_option("-o,--output", options->output, "The picture to write: .exr, .tif or .png")
        ->required()
        ->type_name("OUT");
    add_parsed(
        *app, "--level", options->level,
        [](const std::string& text) { return parse_integer_in(text, 0, 30); }, "L",
        "Which approximation: 0 the coarsest, the number of levels the map itself (the map)");
    add_parsed(
        *app, "--streams", options->streams,
        [](const std::string& text) { return parse_integer_in(text, 1, 64); }, "N",
        ".wfog: the map from the first N of its streams alone, as a download shows it (all)");
    app->add_flag("--json", options->json, "Print what was written as JSON");
    app->footer(
        R"(Without --level the picture is the map that was converted, one pixel a coefficient, up to
rounding. With --level it is the map after only the first L layers of detail were added,
which is what a renderer sees far away. A coarse map reaches past the edges of the fine
one by a few pixels: `start` says where its first pixel lies, in its own cells.
.exr and .tif hold floats; .png holds 16 bits of [0,1]. A .wfog holds the map in streams, each
of every second pixel of the one after it; from the first of them the rest is interpolated.

Example: the coarsest map
  wavefog decode banks.exr -o coarse.tif --level 0)");
    return {app, [options] { return decode(*options); }};
}

}  // namespace wavefog::cli
