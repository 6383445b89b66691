// wavefog convert: a greyscale picture becomes a fog file.
#include <fmt/format.h>

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "command.h"
#include "files.h"
#include "interrupt.h"
#include "options.h"
#include "report.h"
#include "wavefog/fogmap/fog_file.h"
#include "wavefog/fogmap/image.h"

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

struct ConvertOptions {
    fs::path input, output;
    std::optional<int> degree;
    std::string family;
    std::optional<int> levels;
    std::optional<Form> form;
    std::optional<Boundary> boundary;
    std::optional<Rect> rect;
    std::optional<double> extinction;
    std::optional<Profile> profile;
    std::optional<std::string> channel;
    bool sanitize = false;
    bool half = false;
    std::optional<Layout> layout;
    std::optional<int> path_table;
    PathLayout path_layout = PathLayout::mean;
    bool json = false;

    bool decomposes_anew() const { return degree || !family.empty() || levels || form || boundary; }
};

/// The fog of a picture.
Result<Fog> fog_of_image(const ConvertOptions& options, Facts& facts) {
    ReadOptions read;
    read.channel = options.channel;
    read.sanitize = options.sanitize;
    const Result<Fogmap> map = read_fogmap(options.input, read);
    if (!map) return tl::unexpected(map.error());
    facts["source"] = map->source_format;
    facts["sanitized"] = map->sanitized;
    if (map->sanitized > 0)
        warn(fmt::format("{}: {} of {} pixels were NaN, Inf or negative and became 0",
                         options.input.string(), map->sanitized, map->pixels.size()));
    FogOptions fog_options;
    fog_options.degree = options.degree.value_or(fog_options.degree);
    fog_options.family = options.family;
    fog_options.levels = options.levels.value_or(fog_options.levels);
    fog_options.form = options.form.value_or(fog_options.form);
    fog_options.boundary = options.boundary.value_or(fog_options.boundary);
    return make_fog(map->pixels, fog_options);
}

/// The fog of a fog file, decomposed anew where a flag asks for it.
Result<Fog> fog_of_fog(const ConvertOptions& options) {
    if (options.channel || options.sanitize)
        return usage_error(fmt::format(
            "{}: this is a fog file, which has no channels to choose or pixels to sanitize; leave "
            "out --channel and --sanitize",
            options.input.string()));
    Result<Fog> fog = load_fog(options.input);
    if (!fog || !options.decomposes_anew()) return fog;
    FogOptions again;
    const Decomposition<float>& old = fog->decomposition;
    again.degree = options.degree.value_or(old.degree());
    again.form = options.form.value_or(old.form);
    again.boundary = options.boundary.value_or(old.boundary);
    again.levels = options.levels.value_or(old.levels());
    again.family = options.family;
    if (again.family.empty() && again.degree == old.degree() && again.form == old.form)
        again.family = old.family.name();
    // Coefficients that were 0 can come back as -1e-9; a map has none below 0.
    const Grid<float> map = reconstruct(old).cwiseMax(0.0f);
    Result<Fog> changed = make_fog(map, again);
    if (!changed) return changed;
    fog->decomposition = std::move(changed->decomposition);
    return fog;
}

void warn_about(const ConvertOptions& options, const Fog& fog) {
    const Decomposition<float>& d = fog.decomposition;
    if (options.levels && *options.levels > d.levels())
        warn("--" + level_cap_message(*options.levels, d.levels(), d.width, d.height, d.boundary));
    if (!d.family.stable()) warn(d.family.warning());
}

/// The description beside OUT.exr must not replace a JSON file of another kind, such as a scene.
Result<void> check_description(const fs::path& output) {
    const fs::path description = description_of(output);
    std::error_code code;
    if (!fs::exists(description, code) || is_fog_file(description)) return {};
    return data_error(
        fmt::format("{}: this file describes no fog, and the description of {} would replace it; "
                    "choose another "
                    "name for the output",
                    description.string(), output.string()));
}

Result<void> convert(const ConvertOptions& options) {
    if (extension_of(options.output) == ".wfog")
        return usage_error(
            fmt::format("{}: this version cannot write .wfog files yet; write an "
                        ".exr, which holds the same coefficients",
                        options.output.string()));
    if (auto ok = check_input(options.input); !ok) return ok;
    if (auto ok = check_output(options.output, {options.input}, {".exr"}); !ok) return ok;
    if (auto ok = check_description(options.output); !ok) return ok;
    const bool from_fog = is_fog_file(options.input);
    if (!from_fog && !options.family.empty())
        if (const auto family = parse_family(options.family, options.degree.value_or(1)); !family)
            return tl::unexpected(family.error());

    Facts facts = {{"input", options.input.string()}};
    Result<Fog> fog = from_fog ? fog_of_fog(options) : fog_of_image(options, facts);
    if (!fog) return tl::unexpected(fog.error());
    if (options.rect) fog->rect = *options.rect;
    if (options.extinction) fog->extinction = *options.extinction;
    if (options.profile) fog->profile = *options.profile;
    if (auto valid = fog->validate(); !valid) return valid;
    warn_about(options, *fog);

    SaveOptions save;
    save.half = options.half;
    save.layout = options.layout.value_or(options.path_table ? Layout::parts : Layout::atlas);
    save.path_table = options.path_table.value_or(0);
    save.path_layout = options.path_layout;
    {
        const HoldInterrupts hold;
        if (auto saved = save_fog(options.output, *fog, save); !saved) return saved;
    }

    facts.update(fog_facts(*fog));
    facts["precision"] = options.half ? "half" : "float";
    std::uintmax_t bytes = 0;
    Facts names = Facts::array();
    for (const fs::path& file : fog_files(options.output)) {
        bytes += file_bytes(file);
        names.push_back(file.string());
    }
    facts["bytes"] = bytes;
    facts["wrote"] = names;
    print_facts(facts, options.json);
    return {};
}

}  // namespace

Command add_convert(CLI::App& root) {
    auto options = std::make_shared<ConvertOptions>();
    CLI::App* app = root.add_subcommand("convert", "Turn a greyscale picture into a fog file");
    app->add_option("IN", options->input, "Any picture, or a fog file to change")->required();
    app->add_option("-o,--output", options->output, "The fog file to write: OUT.exr")
        ->required()
        ->type_name("OUT.exr");
    add_parsed(*app, "--basis", options->degree, parse_basis, "haar|linear|quadratic",
               "How the fog varies between pixels: steps, ramps or curves (linear)");
    app->add_option("--family", options->family,
                    "How detail is split off: 2,2 3,5 chui-wang positive ... (the basis's default)")
        ->type_name("F");
    add_parsed(*app, "--levels", options->levels, parse_levels, "N|auto",
               "How many times the map is halved (auto: at most 5)");
    add_choice(*app, "--form", options->form, {"wavelet", "scaling"},
               "Details as three wavelet bands or one residual grid a level (wavelet)");
    add_parsed(*app, "--rect", options->rect, parse_rect, "x0,z0,x1,z1",
               "Where the picture's outer edges lie, metres (one metre a pixel)");
    add_parsed(
        *app, "--extinction", options->extinction,
        [](const std::string& text) {
            return parse_number_in(text, 0, std::numeric_limits<double>::infinity());
        },
        "K", "Extinction where the picture is 1, in 1/m (1); sight ends at about 4/K metres");
    add_parsed(*app, "--profile", options->profile, parse_profile, "PROFILE",
               "uniform | slab:BOTTOM,TOP | exponential:BASE,SCALE | linear:BASE,TOP (uniform)");
    app->add_flag("--sanitize", options->sanitize,
                  "Turn NaN, Inf and negative pixels into 0 and count them (else an error)");
    app->add_option("--channel", options->channel,
                    "Channel to read: R, G, B, A, Y or a number (luminance)")
        ->type_name("C");
    add_choice(*app, "--wrap", options->boundary, {"zero", "repeat"},
               "Outside the map: no fog, or the map again as tiles (zero)");
    add_parsed(
        *app, "--precision", options->half,
        [](const std::string& text) {
            return parse_choice(text, {"float", "half"}).map([](int i) { return i == 1; });
        },
        "half|float",
        "Bits of a coefficient: 16, in --form scaling rounded so that fog stays >= 0, or 32 "
        "(float)");
    add_choice(*app, "--layout", options->layout, {"atlas", "levels", "parts"},
               "One RGBA picture, one file a level, or one multi-part file (atlas)");
    add_parsed(
        *app, "--path-table", options->path_table,
        [](const std::string& text) { return parse_integer_in(text, 2, 128); }, "N",
        "Add path-integral tables of N samples an edge, 2 to 128 (with --layout parts)");
    add_choice(
        *app, "--path-layout", options->path_layout, {"mean", "perimeter"},
        "What the tables hold: mean density by pair of edges, or the integral itself (mean)");
    app->add_flag("--json", options->json, "Print what was written as JSON");
    app->footer(
        "The picture's pixels become the coefficients of a B-spline surface of fog density, which\n"
        "is split into one coarse map and layers of detail. A renderer can then leave out layers\n"
        "far away, and read from the textures in OUT.exr what it needs. Black is clear air, white\n"
        "has the full extinction. Beside OUT.exr, OUT.json describes the layout for engines.\n"
        "\n"
        "Example: banks of fog over 400 x 400 m that thin out with every 8 m of height\n"
        "  wavefog convert banks.png -o banks.exr --rect -200,-200,200,200 \\\n"
        "                  --extinction 0.05 --profile exponential:0,8");
    return {app, [options] { return convert(*options); }};
}

}  // namespace wavefog::cli
