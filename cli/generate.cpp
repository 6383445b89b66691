// wavefog generate: noise, particles, or the fogs of a scene become a fogmap.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <random>

#include "command.h"
#include "files.h"
#include "fogs.h"
#include "interrupt.h"
#include "options.h"
#include "parallel.h"
#include "report.h"
#include "scene_map.h"
#include "wavefog/fogmap/image.h"
#include "wavefog/fogmap/noise.h"

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

struct GenerateOptions {
    std::string model;
    fs::path output;
    Size size{512, 512};
    bool tile = false;
    // Noise.
    std::optional<std::uint64_t> seed;
    std::optional<int> features, octaves, lacunarity;
    std::optional<double> gain, warp, coverage;
    // A scene, particles.
    std::optional<Rect> rect;
    std::optional<double> height, time, extinction;
    std::optional<std::vector<double>> mean;
    std::optional<int> channel;
    /// Keys of a scene's particles and what their flags say.
    std::vector<std::pair<std::string, std::string>> source;
    bool json = false;

    std::optional<NoiseOptions::Kind> noise() const {
        if (model == "perlin") return NoiseOptions::Kind::perlin;
        if (model == "simplex") return NoiseOptions::Kind::simplex;
        return std::nullopt;
    }
    bool particles() const { return model == "particles"; }
    bool file() const { return !noise() && !particles(); }
};

struct SourceFlag {
    const char *key, *flag, *value, *help;
};
constexpr SourceFlag kSourceFlags[] = {
    {"source", "--source", "fog|smoke", "what lives long and thin, or short and thick (fog)"},
    {"position", "--position", "X,Y,Z", "where they start, metres (0,0,0)"},
    {"area", "--area", "R", "radius of the level disc they start on, metres (fog: 20)"},
    {"direction", "--direction", "X,Y,Z", "where they are sent (0,1,0)"},
    {"spread_deg", "--spread-deg", "A", "half angle of the cone around it (60)"},
    {"speed", "--speed", "V", "at the start, m/s (1)"},
    {"rate", "--rate", "N", "particles a second (40)"},
    {"life", "--life", "N,N", "least and most steps (fog: 64,128, smoke: 8,16)"},
    {"step", "--step", "S", "seconds of a step (0.1)"},
    {"radius", "--radius", "R,R", "at birth and at the end, metres (2,6)"},
    {"opacity", "--opacity", "O", "the most, below 1 (fog: 0.2, smoke: 0.9)"},
    {"lift", "--lift", "A", "upward acceleration, m/s^2 (0)"},
    {"drag", "--drag", "D", "how fast they take the wind's velocity, 1/s (0)"},
    {"wind", "--wind", "VX,VZ", "m/s, or [[t,vx,vz],...] (calm)"}};

/// Any unsigned number of 64 bits.
Result<std::uint64_t> parse_seed(std::string_view text) {
    std::uint64_t seed = 0;
    const char* end = text.data() + text.size();
    const auto [stop, code] = std::from_chars(text.data(), end, seed);
    if (code != std::errc() || stop != end)
        return usage_error(
            fmt::format("'{}' is no seed; use a whole number from 0 to 2^64 - 1", text));
    return seed;
}

/// What says nothing about the chosen model is a mistake.
Result<void> check_flags(const GenerateOptions& options) {
    const auto unused = [&](const char* flags, const char* remedy) {
        return usage_error(fmt::format("{}: {}; {}", options.model, flags, remedy));
    };
    if (!options.source.empty() && !options.particles())
        return unused("--source to --wind are about model particles",
                      "leave them out, or write them into the scene");
    if (options.noise()) {
        if (options.rect || options.height || options.mean || options.time || options.extinction ||
            options.channel)
            return unused(
                "--rect, --height, --mean, --time, --extinction and --channel are about "
                "scenes and particles",
                "leave them out, and place the map with `convert`");
        return {};
    }
    if ((options.seed && !options.particles()) || options.features || options.octaves ||
        options.lacunarity || options.gain || options.warp || options.coverage)
        return unused(
            "--seed, --features, --octaves, --gain, --lacunarity, --warp and --coverage "
            "are about noise, model perlin or simplex",
            "leave them out");
    if (options.height && options.mean)
        return usage_error("--height Y or --mean Y0,Y1: give one of them");
    if (options.mean && !(options.mean->at(0) < options.mean->at(1)))
        return usage_error("--mean Y0,Y1: the first height must be below the second");
    if (options.particles()) return {};
    if (!fs::exists(options.model) && options.model.find('.') == std::string::npos)
        return usage_error(
            fmt::format("'{}' is no model; use perlin, simplex, particles, or a scene or fog file",
                        options.model));
    return check_input(options.model);
}

Result<Grid<float>> noise_map(const GenerateOptions& options, Facts& facts) {
    NoiseOptions noise{.kind = *options.noise(), .tile = options.tile};
    noise.seed = options.seed ? *options.seed : std::random_device()();
    noise.features = options.features.value_or(noise.features);
    noise.octaves = options.octaves.value_or(noise.octaves);
    noise.gain = options.gain.value_or(noise.gain);
    noise.lacunarity = options.lacunarity.value_or(noise.lacunarity);
    noise.warp = options.warp.value_or(noise.warp);
    const Size size = options.size;
    const auto made = Noise::create(noise, double(size.height) / size.width);
    if (!made) return tl::unexpected(made.error());
    Grid<float> map(size.height, size.width);
    parallel_chunks("generating", static_cast<std::size_t>(size.height), 1,
                    [&](std::size_t begin, std::size_t end) {
                        for (auto j = static_cast<int>(begin); j < static_cast<int>(end); ++j)
                            for (int i = 0; i < size.width; ++i)
                                map(j, i) = static_cast<float>(
                                    (*made)((i + 0.5) / size.width, (j + 0.5) / size.height));
                    });
    keep_highest(map, options.coverage.value_or(0.7));
    facts["seed"] = noise.seed;
    return map;
}

/// A flag's text as JSON: a number, a list ("1,2" or "[1,2]"), or else a text.
Facts json_of(const std::string& text) {
    const bool list = text.find(',') != std::string::npos && text.front() != '[';
    Facts value = Facts::parse(list ? "[" + text + "]" : text, nullptr, false);
    return value.is_discarded() ? Facts(text) : value;
}

/// The source that the flags describe.
Result<ParticleSource> source_of(const GenerateOptions& options) {
    Facts keys = {{"source", "fog"},
                  {"position", {0, 0, 0}},
                  {"spread_deg", 60},
                  {"rate", 40},
                  {"radius", {2, 6}}};
    for (const auto& [key, text] : options.source) keys[key] = json_of(text);
    if (!keys.contains("area") && keys["source"] == "fog") keys["area"] = 20;
    if (options.seed) keys["seed"] = *options.seed;
    Result<ParticleSource> source = parse_particles(keys.dump(), "particles");
    if (!source) return usage_error(source.error().message);
    return source;
}

Result<FogsAt> fogs_of(const GenerateOptions& options) {
    const double seconds = options.time.value_or(0);
    if (!options.particles()) return load_fogs_at(options.model, seconds);
    Result<ParticleSource> source = source_of(options);
    if (!source) return tl::unexpected(source.error());
    SceneFogs fogs;
    fogs.particles.push_back(*std::move(source));
    return fogs_at(std::move(fogs), seconds);
}

Result<Grid<float>> fog_map(const GenerateOptions& options, Facts& facts) {
    const Result<FogsAt> fogs = fogs_of(options);
    if (!fogs) return tl::unexpected(fogs.error());
    if (fogs->fogs.empty() && fogs->models.empty() && fogs->particles.empty())
        return data_error(options.model + ": the scene has no \"fog\"; add one");
    SceneMapOptions how{options.size, options.tile,       options.rect,   options.height,
                        std::nullopt, options.extinction, options.channel};
    if (options.mean) how.mean = {options.mean->at(0), options.mean->at(1)};
    Result<Grid<float>> map = scene_map(*fogs, how, facts);
    if (!map) return map;
    if (options.particles()) facts["seed"] = options.seed.value_or(ParticleSource{}.seed);
    const double densest = double(map->maxCoeff());
    if (densest > 1 && extension_of(options.output) == ".png")
        return data_error(fmt::format(
            "{}: the densest pixel is {:.4g} times --extinction, and a .png ends at 1; raise it to "
            "{:.4g} or write .exr",
            options.output.string(), densest, densest * *options.extinction));
    return map;
}

Result<void> generate(const GenerateOptions& options) {
    if (auto ok = check_flags(options); !ok) return ok;
    std::vector<fs::path> inputs;
    if (options.file()) inputs.push_back(options.model);
    if (auto ok = check_output(options.output, inputs, {".exr", ".tif", ".tiff", ".png"}); !ok)
        return ok;
    Facts facts = {{"wrote", options.output.string()},
                   {"model", options.model},
                   {"size", {options.size.width, options.size.height}}};
    Result<Grid<float>> map = options.noise() ? noise_map(options, facts) : fog_map(options, facts);
    if (!map) return tl::unexpected(map.error());
    facts["mean"] = map->cast<double>().mean();
    if (map->maxCoeff() == 0)
        warn(fmt::format("{}: there is no fog here, every pixel is 0", options.model));
    Image picture{options.size.width, options.size.height, 1, {}};
    picture.pixels.assign(map->data(), map->data() + map->size());
    *map = {};
    {
        const HoldInterrupts hold;
        if (auto ok = write_image(options.output, picture); !ok) return ok;
    }
    print_facts(facts, options.json);
    return {};
}

void add_noise_flags(CLI::App& app, GenerateOptions& options) {
    const auto whole = [](int low, int high) {
        return [low, high](const std::string& text) { return parse_integer_in(text, low, high); };
    };
    const auto number = [](double low, double high) {
        return [low, high](const std::string& text) { return parse_number_in(text, low, high); };
    };
    add_parsed(app, "--seed", options.seed, parse_seed, "S",
               "Noise, particles: another number, another picture (noise: chosen at random, and "
               "printed)");
    add_parsed(app, "--features", options.features, whole(1, 256), "N",
               "Noise: banks across the width, 1 to 256 (4)");
    add_parsed(app, "--octaves", options.octaves, whole(1, 16), "N",
               "Noise: how often finer noise is added, 1 (plain noise) to 16 (6)");
    add_parsed(app, "--gain", options.gain, number(0, 1), "G",
               "Noise: strength of each octave against the one before, 0 to 1 (0.5)");
    add_parsed(app, "--lacunarity", options.lacunarity, whole(2, 8), "N",
               "Noise: how many times finer each octave is, 2 to 8 (2)");
    add_parsed(app, "--warp", options.warp, number(0, 4), "W",
               "Noise: other noise moves every point by up to about W features, 0 to 4 (0)");
    add_parsed(app, "--coverage", options.coverage, number(0, 1), "C",
               "Noise: the share of the map that has fog, 0 to 1 (0.7)");
}

void add_scene_flags(CLI::App& app, GenerateOptions& options) {
    add_parsed(app, "--rect", options.rect, parse_rect, "x0,z0,x1,z1",
               "Scene: the part of the world to draw, metres (its terrain, its first map, or where "
               "its particles are)");
    add_parsed(app, "--height", options.height, parse_number, "Y",
               "Scene: the fog's density at this height, metres");
    add_parsed(
        app, "--mean", options.mean, [](const std::string& text) { return parse_numbers(text, 2); },
        "Y0,Y1",
        "Scene: its mean between two heights, which keeps the optical depth of vertical rays "
        "(particles alone: all of them)");
    add_parsed(app, "--time", options.time, parse_number, "SECONDS",
               "Scene: when, after winds have blown for so long (0)");
    add_parsed(
        app, "--extinction", options.extinction,
        [](const std::string& text) { return parse_number_in(text, 1e-300, 1e300); }, "K",
        "Scene: extinction of a pixel of 1, for maps that belong together (that of the densest)");
    add_parsed(
        app, "--channel", options.channel,
        [](const std::string& text) {
            return parse_choice(text, {"R", "G", "B"});
        },
        "R|G|B", "Scene: the colour whose fog is drawn, where fogs have \"channels\"");
}

void add_particle_flags(CLI::App& app, GenerateOptions& options) {
    for (const SourceFlag& flag : kSourceFlags)
        app.add_option_function<std::string>(
               flag.flag,
               [&options, key = flag.key](const std::string& text) {
                   options.source.emplace_back(key, text);
               },
               std::string("Particles: ") + flag.help)
            ->type_name(flag.value);
}

}  // namespace

Command add_generate(CLI::App& root) {
    auto options = std::make_shared<GenerateOptions>();
    CLI::App* app = root.add_subcommand(
        "generate", "Make a fogmap from noise, from particles or from a scene's fogs");
    app->add_option("MODEL", options->model,
                    "perlin | simplex (noise), particles, or a scene or fog file whose fogs are "
                    "drawn")
        ->required();
    app->add_option("-o,--output", options->output,
                    "The map to write: .png (16 bits), .tif or .exr (floats)")
        ->required()
        ->type_name("OUT");
    add_parsed(*app, "--size", options->size, parse_map_size, "WxH", "Pixels (512x512)");
    app->add_flag("--tile", options->tile,
                  "Make the right edge continue on the left, the bottom one at the top");
    add_noise_flags(*app, *options);
    add_scene_flags(*app, *options);
    add_particle_flags(*app, *options);
    app->add_flag("--json", options->json, "Print what was written as JSON");
    app->footer(
        R"(Noise is a sum of octaves, each finer and weaker than the one before (fractional Brownian
motion). The highest --coverage of it becomes fog, the rest clear air, so that banks have
edges. The same options and seed give the same bytes. With --tile the map has no seam when
it is converted with --wrap repeat.

The fogs of a scene, formulas, maps and particles alike, are added up at the centre of each
pixel. The map is scaled so that its densest pixel is 1 (or by --extinction), and
`extinction` is printed: give it to `convert`. So is the `profile` of --mean, a slab that
keeps the optical depth of every vertical ray through a pixel's centre: of particles -log
of its clarity. --tile fades the first quarter of a scene's map into what lies behind its
other end.

Example: banks of fog that repeat every 400 m
  wavefog generate simplex -o banks.png --seed 7 --coverage 0.6 --tile
  wavefog convert banks.png -o banks.exr --wrap repeat --rect 0,0,400,400 \
                  --extinction 0.05 --profile exponential:0,8
Example: plain noise, one octave
  wavefog generate perlin -o plain.exr --octaves 1 --coverage 1 --features 8
Example: a map in place of formulas
  wavefog generate data/scenes/potentials.json -o mist.exr --mean 0,12
Example: what drifts from a source in the wind, after a minute
  wavefog generate particles -o drift.exr --area 30 --wind 1.5,0.5 --drag 0.3 --time 60)");
    return {app, [options] { return generate(*options); }};
}

}  // namespace wavefog::cli
