// wavefog convert: a greyscale picture becomes a fog file.
#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "command.h"
#include "elapsed.h"
#include "files.h"
#include "interrupt.h"
#include "options.h"
#include "parallel.h"
#include "report.h"
#include "transmittance.h"
#include "wavefog/fogmap/coarsen.h"
#include "wavefog/fogmap/fog_file.h"
#include "wavefog/fogmap/image.h"
#include "wavefog/fogmap/wfog.h"

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

struct ConvertOptions {
    std::vector<fs::path> inputs;
    fs::path output;  ///< a file, or a directory for several
    fs::path input;   ///< the one at hand
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
    WfogOptions compact;
    int promises = 0;  ///< how many of --lossless, --max-error ... were given
    bool json = false;

    bool decomposes_anew() const { return degree || !family.empty() || levels || form || boundary; }
};

/// The fog of a picture.
Result<Fog> fog_of_image(const ConvertOptions& options, Grid<float>& pixels, Facts& facts) {
    ReadOptions read;
    read.channel = options.channel;
    read.sanitize = options.sanitize;
    Result<Fogmap> map = read_fogmap(options.input, read);
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
    pixels = std::move(map->pixels);
    Result<Fog> fog = make_fog(pixels, fog_options);
    if (!fog && fog.error().kind == ErrorKind::data)
        return data_error(fmt::format("{}: {}", options.input.string(), fog.error().message));
    return fog;
}

/// The fog of a fog file, decomposed anew where a flag asks for it.
Result<Fog> fog_of_fog(const ConvertOptions& options, Grid<float>& pixels) {
    if (options.channel || options.sanitize)
        return usage_error(fmt::format(
            "{}: this is a fog file, which has no channels to choose or pixels to sanitize; leave "
            "out --channel and --sanitize",
            options.input.string()));
    LoadNotes notes;
    Result<Fog> fog = load_fog(options.input, &notes);
    if (fog && notes.stream_levels < notes.of_levels)
        return data_error(fmt::format(
            "{}: ends early, with the {} coarsest of {} levels, and what it became would look "
            "whole; get the rest of it, or a picture of what there is (wavefog decode)",
            options.input.string(), notes.stream_levels, notes.of_levels));
    pixels = std::move(notes.map);
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
    if (pixels.size() == 0) pixels = map_of(*fog);
    Result<Fog> changed = make_fog(pixels, again);
    if (!changed) return changed;
    fog->decomposition = std::move(changed->decomposition);
    return fog;
}

bool promises_rays(const ConvertOptions& options) {
    return options.compact.promise == WfogOptions::Promise::max_transmittance_error;
}

void warn_about_ground(double ground, const Profile& profile) {
    const bool known = std::isfinite(ground), uniform = profile.kind == Profile::Kind::uniform;
    const bool endless =
        profile.kind == Profile::Kind::exponential || profile.kind == Profile::Kind::linear;
    if (!known && endless)
        warn(fmt::format(
            "rays far below the base at {} m count too, where fog does not thin; if none go there, "
            "--ground Y makes the file smaller",
            profile.base));
    if (known && uniform) warn("--ground makes no difference in uniform fog");
    const bool slab_above = profile.kind == Profile::Kind::slab && profile.bottom >= ground;
    if (known && !uniform && !slab_above && profile(ground) == 0)
        warn(fmt::format(
            "there is no fog above the ground at {} m, so that any map keeps the promise", ground));
}

void warn_about(const ConvertOptions& options, const Fog& fog) {
    if (promises_rays(options)) warn_about_ground(options.compact.ground, fog.profile);
    const Decomposition<float>& d = fog.decomposition;
    if (options.levels && *options.levels > d.levels())
        warn("--" + level_cap_message(*options.levels, d.levels(), d.width, d.height, d.boundary));
    if (!d.family.stable()) warn(d.family.warning());
}

/// What says nothing about the file that is written is a mistake.
Result<void> check_flags(const ConvertOptions& options, bool compact) {
    if (compact && (options.half || options.layout || options.path_table))
        return usage_error(
            fmt::format("{}: --precision, --layout and --path-table are about .exr; leave them out",
                        options.output.string()));
    if (!compact && (options.promises > 0 || options.compact.best))
        return usage_error(fmt::format(
            "{}: --lossless, --max-error, --max-transmittance-error, --bytes and --best are about "
            ".wfog; write one",
            options.output.string()));
    if (options.promises > 1)
        return usage_error(
            "--lossless, --max-error, --max-transmittance-error, --bytes: give one of them");
    const bool by_path = promises_rays(options);
    if (by_path != (options.compact.path > 0))
        return usage_error(
            "--max-transmittance-error and --path go together: the error is that of rays so long");
    if (!by_path && std::isfinite(options.compact.ground))
        return usage_error(
            "--ground goes with --max-transmittance-error and --path: it says how low rays reach");
    return {};
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

/// The fog of the input, changed as the flags say. `map`: its pixels, where they are at hand.
Result<Fog> fog_of_input(const ConvertOptions& options, Grid<float>& map, Facts& facts) {
    const bool from_fog = is_fog_file(options.input);
    if (!from_fog && !options.family.empty())
        if (const auto family = parse_family(options.family, options.degree.value_or(1)); !family)
            return tl::unexpected(family.error());
    Result<Fog> fog = from_fog ? fog_of_fog(options, map) : fog_of_image(options, map, facts);
    if (!fog) return fog;
    if (options.rect) fog->rect = *options.rect;
    if (options.extinction) fog->extinction = *options.extinction;
    if (options.profile) fog->profile = *options.profile;
    if (auto valid = fog->validate(); !valid) return tl::unexpected(valid.error());
    warn_about(options, *fog);
    return fog;
}

Result<void> write_exr(const ConvertOptions& options, const Fog& fog, Facts& facts) {
    SaveOptions save;
    save.half = options.half;
    save.layout = options.layout.value_or(options.path_table ? Layout::parts : Layout::atlas);
    save.path_table = options.path_table.value_or(0);
    save.path_layout = options.path_layout;
    {
        const HoldInterrupts hold;
        if (auto saved = save_fog(options.output, fog, save); !saved) return saved;
    }
    facts["precision"] = options.half ? "half" : "float";
    std::uintmax_t bytes = 0;
    Facts names = Facts::array();
    for (const fs::path& file : fog_files(options.output)) {
        bytes += file_bytes(file);
        names.push_back(file.string());
    }
    facts["bytes"] = bytes;
    facts["wrote"] = names;
    return {};
}

Result<void> write_wfog(const ConvertOptions& options, const Fog& fog, const Grid<float>& map,
                        Facts& facts) {
    const auto encoded = encode_wfog(fog, options.compact, map.size() > 0 ? &map : nullptr);
    if (!encoded)
        return tl::unexpected(
            Error{encoded.error().kind,
                  fmt::format("{}: {}", options.output.string(), encoded.error().message)});
    {
        const HoldInterrupts hold;
        if (auto saved = save_wfog(options.output, encoded->bytes); !saved) return saved;
    }
    const WfogReport& report = encoded->report;
    facts["profile_of_coder"] = options.compact.best ? "best" : "default";
    facts["bytes"] = report.bytes;
    facts["bits_per_pixel"] = report.bits_per_pixel;
    facts["ratio"] = report.ratio;
    facts["full_scale"] = report.full_scale;
    facts["max_error"] = report.max_error;
    facts["rms_error"] = report.rms_error;
    const auto decoded = decode_wfog(encoded->bytes);
    if (!decoded) return tl::unexpected(decoded.error());
    const SampledError sampled = sampled_transmittance_error(
        fog, decoded->fog, options.compact.path, options.compact.ground);
    facts["worst_dT"] = sampled.worst;
    if (promises_rays(options)) facts["proved_dT"] = report.ray_error;
    facts["sampled_rays"] = sampled.rays;
    facts["wrote"] = Facts::array({options.output.string()});
    return {};
}

/// One file; what was written is told by `facts`.
Result<void> convert_file(const ConvertOptions& options, Facts& facts) {
    const bool compact = extension_of(options.output) == ".wfog";
    if (auto ok = check_input(options.input); !ok) return ok;
    if (auto ok = check_output(options.output, {options.input}, {".exr", ".wfog"}); !ok) return ok;
    if (auto ok = check_flags(options, compact); !ok) return ok;
    if (!compact)
        if (auto ok = check_description(options.output); !ok) return ok;
    facts = {{"input", options.input.string()}};
    Grid<float> map;
    const Result<Fog> fog = fog_of_input(options, map, facts);
    if (!fog) return tl::unexpected(fog.error());
    facts.update(fog_facts(*fog));
    return compact ? write_wfog(options, *fog, map, facts) : write_exr(options, *fog, facts);
}

bool names_directory(const ConvertOptions& options) {
    const std::string extension = extension_of(options.output);
    if (extension == ".exr" || extension == ".wfog") return false;
    std::error_code code;
    return options.inputs.size() > 1 || !options.output.has_filename() ||
           fs::is_directory(options.output, code);
}

/// Where a file of several goes; two must not go to one place.
Result<std::vector<ConvertOptions>> plan_files(const ConvertOptions& options) {
    std::vector<ConvertOptions> plan;
    std::map<fs::path, fs::path> taken;
    for (const fs::path& input : options.inputs) {
        ConvertOptions one = options;
        one.input = input;
        one.output = options.output / input.stem();
        one.output += options.promises > 0 || options.compact.best ? ".wfog" : ".exr";
        one.compact.threads = 1;
        if (const auto [at, added] = taken.emplace(one.output, input); !added)
            return usage_error(
                fmt::format("{}: both {} and {} would become this file; convert "
                            "them into two directories",
                            one.output.string(), at->second.string(), input.string()));
        plan.push_back(std::move(one));
    }
    return plan;
}

Result<void> convert_files(const ConvertOptions& options) {
    const auto plan = plan_files(options);
    if (!plan) return tl::unexpected(plan.error());
    std::error_code code;
    fs::create_directories(options.output, code);
    if (code)
        return data_error(fmt::format("{}: cannot be made a directory ({}); choose another",
                                      options.output.string(), code.message()));
    std::vector<Facts> facts(plan->size());
    std::vector<std::string> errors(plan->size());
    parallel_chunks("converting", plan->size(), 1, [&](std::size_t i, std::size_t) {
        const auto done = convert_file((*plan)[i], facts[i]);
        if (!done) errors[i] = done.error().message;
    });
    std::size_t failed = 0;
    Facts files = Facts::array();
    std::uintmax_t bytes = 0;
    for (std::size_t i = 0; i < plan->size(); ++i) {
        if (errors[i].empty()) {
            bytes += facts[i].at("bytes").get<std::uintmax_t>();
            files.push_back(options.json ? facts[i]
                                         : Facts{{"wrote", (*plan)[i].output.string()},
                                                 {"bytes", facts[i].at("bytes")}});
            continue;
        }
        ++failed;
        fmt::print(stderr, "wavefog: error: {}\n", errors[i]);
    }
    print_facts({{"converted", plan->size() - failed},
                 {"failed", failed},
                 {"bytes", bytes},
                 {"files", files}},
                options.json);
    if (failed > 0)
        return data_error(fmt::format("{}: {} of {} files failed, the others are done; see above",
                                      options.output.string(), failed, plan->size()));
    return {};
}

Result<void> convert(const ConvertOptions& options) {
    if (names_directory(options)) return convert_files(options);
    if (options.inputs.size() > 1)
        return usage_error(
            fmt::format("{}: {} and other files need a directory as the output; name one",
                        options.output.string(), options.inputs[1].string()));
    ConvertOptions one = options;
    one.input = options.inputs.front();
    Facts facts;
    {
        const Elapsed elapsed("converting");
        if (auto done = convert_file(one, facts); !done) return done;
    }
    print_facts(facts, options.json);
    return {};
}

/// The flags of .wfog files.
void add_promises(CLI::App& app, ConvertOptions& options) {
    using Promise = WfogOptions::Promise;
    const auto promise = [&options](Promise which) {
        options.compact.promise = which;
        ++options.promises;
    };
    const auto at_most_one = [](const char* what) {
        return [what](const std::string& text) -> Result<double> {
            const Result<double> value = parse_fraction(text);
            if (value && *value > 1)
                return usage_error(fmt::format("{} is above 1; E is {}", text, what));
            return value;
        };
    };
    app.add_flag_callback(
        "--lossless", [promise] { promise(Promise::lossless); },
        ".wfog: every coefficient comes back bit for bit (so if nothing else is said)");
    add_parsed(
        app, "--max-error", options.compact.error,
        [promise, parse = at_most_one("a fraction of the map's full scale, such as 1/255")](
            const std::string& text) {
            promise(Promise::max_error);
            return parse(text);
        },
        "E", ".wfog: no pixel is off by more than E of the full scale, such as 1/255");
    add_parsed(
        app, "--max-transmittance-error", options.compact.error,
        [promise, parse = at_most_one("a difference of transmittances, such as 0.01")](
            const std::string& text) {
            promise(Promise::max_transmittance_error);
            return parse(text);
        },
        "E",
        ".wfog: no ray of up to --path is off by more than E in transmittance, whatever its "
        "place and direction: proved");
    add_parsed(
        app, "--path", options.compact.path,
        [](const std::string& text) { return parse_fraction(text); }, "L",
        "The longest ray of --max-transmittance-error, metres; longer ones may be off by more");
    add_parsed(
        app, "--ground", options.compact.ground,
        [](const std::string& text) { return parse_number(text); }, "Y",
        "No such ray goes below this height, metres (they may go anywhere); makes files of fog "
        "that thins with height smaller");
    add_parsed(
        app, "--bytes", options.compact.bytes,
        [promise](const std::string& text) {
            promise(Promise::bytes);
            return parse_integer_in(text, 1, std::numeric_limits<int>::max()).map([](int n) {
                return static_cast<std::size_t>(n);
            });
        },
        "N", ".wfog: the least error that fits into N bytes");
    app.add_flag("--best", options.compact.best,
                 ".wfog: the smallest file; ten times slower to write and read");
}

}  // namespace

Command add_convert(CLI::App& root) {
    auto options = std::make_shared<ConvertOptions>();
    CLI::App* app = root.add_subcommand("convert", "Turn a greyscale picture into a fog file");
    app->add_option("IN", options->inputs,
                    "Any pictures, or fog files to change; several go into a directory")
        ->required();
    app->add_option("-o,--output", options->output,
                    "The fog file to write, or a directory for several files")
        ->required()
        ->type_name("OUT.exr|OUT.wfog|DIR");
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
    add_promises(*app, *options);
    app->add_flag("--json", options->json, "Print what was written as JSON");
    app->footer(
        R"(The picture's pixels become the coefficients of a B-spline surface of fog density, which
is split into one coarse map and layers of detail. A renderer can then leave out layers
far away, and read from the textures in OUT.exr what it needs. Black is clear air, white
has the full extinction. Beside OUT.exr, OUT.json describes the layout for engines.

OUT.wfog is small instead: it holds the map to a promised error, coarse levels first, and
every command reads it. Several files go into a directory, which is made if need be: as .wfog
if a flag of .wfog is given, else as .exr; one that fails does not keep the others back. What
is promised about rays is proved for all of them. Where they reach fog that is as dense
without end (uniform, below a base), a ray may stay over one pixel, and files are as large as
for --max-error; else errors even out along them, and files are smaller. The proof takes most
of the time. "worst dT" is the worst of some rays, sought where pixels are off by most.

Example: banks of fog over 400 x 400 m that thin out with every 8 m of height
  wavefog convert banks.png -o banks.exr --rect -200,-200,200,200 \
                  --extinction 0.05 --profile exponential:0,8
Example: small, and no ray of up to 500 m above a ground at -2 m is off by more than 0.01
  wavefog convert banks.exr -o banks.wfog --max-transmittance-error 0.01 --path 500 --ground -2
Example: all maps of a folder, no pixel off by more than one step of 255
  wavefog convert maps/*.png -o packed --max-error 1/255 --best)");
    return {app, [options] { return convert(*options); }};
}

}  // namespace wavefog::cli
