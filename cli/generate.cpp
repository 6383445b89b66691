// wavefog generate: noise, or the fogs of a scene, become a fogmap.
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
#include "interrupt.h"
#include "options.h"
#include "parallel.h"
#include "report.h"
#include "wavefog/fogmap/image.h"
#include "wavefog/fogmap/noise.h"
#include "wavefog/fogmap/reference.h"
#include "wavefog/fogmap/scene.h"

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
    // A scene.
    std::optional<Rect> rect;
    std::optional<double> height;
    std::optional<std::vector<double>> mean;
    bool json = false;

    std::optional<NoiseOptions::Kind> noise() const {
        if (model == "perlin") return NoiseOptions::Kind::perlin;
        if (model == "simplex") return NoiseOptions::Kind::simplex;
        return std::nullopt;
    }
};

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
    if (options.noise()) {
        if (options.rect || options.height || options.mean)
            return usage_error(fmt::format("{}: --rect, --height and --mean are about scenes; "
                                           "leave them out, and place the map with `convert`",
                                           options.model));
        return {};
    }
    if (options.seed || options.features || options.octaves || options.lacunarity || options.gain ||
        options.warp || options.coverage)
        return usage_error(fmt::format(
            "{}: --seed, --features, --octaves, --gain, --lacunarity, --warp and --coverage are "
            "about noise, model perlin or simplex; leave them out",
            options.model));
    if (!fs::exists(options.model) && options.model.find('.') == std::string::npos)
        return usage_error(fmt::format(
            "'{}' is no model; use perlin, simplex, or a scene or fog file", options.model));
    if (options.height.has_value() == options.mean.has_value())
        return usage_error(
            "--height Y or --mean Y0,Y1: give one of them, since a scene's fog changes with height");
    return check_input(options.model);
}

/// Calls value(x, z) for each pixel, its column and row, on all cores.
template <class Value>
Grid<float> fill(Size size, const Value& value) {
    Grid<float> map(size.height, size.width);
    parallel_chunks("generating", static_cast<std::size_t>(size.height), 1,
                    [&](std::size_t begin, std::size_t end) {
                        for (auto j = static_cast<int>(begin); j < static_cast<int>(end); ++j)
                            for (int i = 0; i < size.width; ++i)
                                map(j, i) = static_cast<float>(value(i, j));
                    });
    return map;
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
    Grid<float> map = fill(size, [&](int i, int j) {
        return (*made)((i + 0.5) / size.width, (j + 0.5) / size.height);
    });
    keep_highest(map, options.coverage.value_or(0.7));
    facts["seed"] = noise.seed;
    return map;
}

/// The sum of a scene's fogs at a place of the map, 1/m.
class SceneColumn {
  public:
    SceneColumn(const SceneFogs& fogs, const GenerateOptions& options)
        : maps_(fogs.fogs.begin(), fogs.fogs.end()),
          models_(&fogs.models),
          low_(options.mean ? options.mean->at(0) : *options.height),
          high_(options.mean ? options.mean->at(1) : *options.height) {}

    double operator()(double x, double z) const {
        const Eigen::Vector3d low(x, low_, z), high(x, high_, z);
        double sum = 0;
        if (low_ == high_) {
            for (const Reference& map : maps_) sum += std::max(map.extinction(low), 0.0);
            for (const FogModel& model : *models_) sum += std::max(extinction(model, low), 0.0);
            return sum;
        }
        for (const Reference& map : maps_) sum += map.optical_depth(low, high);
        return (sum + std::max(optical_depth(*models_, low, high), 0.0)) / (high_ - low_);
    }

  private:
    std::vector<Reference> maps_;
    const std::vector<FogModel>* models_;
    double low_, high_;
};

/// --rect, or where the scene's own terrain or map lies.
Result<Rect> rect_of(const GenerateOptions& options, const SceneFogs& fogs) {
    if (options.rect) return *options.rect;
    if (extension_of(options.model) == ".json")
        if (const auto scene = load_scene(options.model); scene && scene->terrain)
            return scene->terrain->rect;
    if (!fogs.fogs.empty()) return fogs.fogs.front().rect;
    return usage_error("--rect x0,z0,x1,z1: say which part of the world the map covers; the scene "
                       "has no terrain that would");
}

Result<Grid<float>> scene_map(const GenerateOptions& options, Facts& facts) {
    if (options.mean && !(options.mean->at(0) < options.mean->at(1)))
        return usage_error("--mean Y0,Y1: the first height must be below the second");
    LoadNotes notes;
    const Result<SceneFogs> fogs = load_fogs(options.model, &notes);
    if (!fogs) return tl::unexpected(fogs.error());
    if (!notes.warning.empty()) warn(notes.warning);
    if (fogs->fogs.empty() && fogs->models.empty())
        return data_error(options.model + ": the scene has no \"fog\"; add one");
    const Result<Rect> rect = rect_of(options, *fogs);
    if (!rect) return tl::unexpected(rect.error());

    const Size size = options.size;
    const double width = rect->x1 - rect->x0, depth = rect->z1 - rect->z0;
    const SceneColumn column(*fogs, options);
    // A tile's first quarter fades from what lies behind its other end into its own.
    const auto own_share = [](double place) {
        const double t = std::min(4 * place, 1.0);
        return t * t * (3 - 2 * t);
    };
    Grid<float> map = fill(size, [&](int i, int j) {
        const double u = (i + 0.5) / size.width, v = (j + 0.5) / size.height;
        const double x = rect->x0 + u * width, z = rect->z0 + v * depth;
        if (!options.tile) return column(x, z);
        const double a = own_share(u), b = own_share(v);
        double sum = a * b * column(x, z);
        if (a < 1) sum += (1 - a) * b * column(x + width, z);
        if (b < 1) sum += a * (1 - b) * column(x, z + depth);
        if (a < 1 && b < 1) sum += (1 - a) * (1 - b) * column(x + width, z + depth);
        return sum;
    });
    const float densest = map.maxCoeff();
    if (densest > 0) map /= densest;
    facts["rect"] = {rect->x0, rect->z0, rect->x1, rect->z1};
    facts["extinction"] = densest;
    return map;
}

Result<void> generate(const GenerateOptions& options) {
    if (auto ok = check_flags(options); !ok) return ok;
    std::vector<fs::path> inputs;
    if (!options.noise()) inputs.push_back(options.model);
    if (auto ok = check_output(options.output, inputs, {".exr", ".tif", ".tiff", ".png"}); !ok)
        return ok;
    Facts facts = {{"wrote", options.output.string()},
                   {"model", options.model},
                   {"size", {options.size.width, options.size.height}}};
    Result<Grid<float>> map =
        options.noise() ? noise_map(options, facts) : scene_map(options, facts);
    if (!map) return tl::unexpected(map.error());
    facts["mean"] = map->cast<double>().mean();
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
               "Noise: another number, another picture (chosen at random, and printed)");
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

}  // namespace

Command add_generate(CLI::App& root) {
    auto options = std::make_shared<GenerateOptions>();
    CLI::App* app =
        root.add_subcommand("generate", "Make a fogmap from noise or from a scene's fogs");
    app->add_option("MODEL", options->model,
                    "perlin | simplex (noise), or a scene or fog file whose fogs are drawn")
        ->required();
    app->add_option("-o,--output", options->output,
                    "The map to write: .png (16 bits), .tif or .exr (floats)")
        ->required()
        ->type_name("OUT");
    add_parsed(*app, "--size", options->size, parse_map_size, "WxH", "Pixels (512x512)");
    app->add_flag("--tile", options->tile,
                  "Make the right edge continue on the left, the bottom one at the top");
    add_noise_flags(*app, *options);
    add_parsed(*app, "--rect", options->rect, parse_rect, "x0,z0,x1,z1",
               "Scene: the part of the world to draw, metres (its terrain, or its first map)");
    add_parsed(*app, "--height", options->height, parse_number, "Y",
               "Scene: the fog's density at this height, metres");
    add_parsed(
        *app, "--mean", options->mean,
        [](const std::string& text) { return parse_numbers(text, 2); }, "Y0,Y1",
        "Scene: its mean between two heights, which keeps the optical depth of vertical rays");
    app->add_flag("--json", options->json, "Print what was written as JSON");
    app->footer(
        "Noise is a sum of octaves, each finer and weaker than the one before (fractional Brownian\n"
        "motion). The highest --coverage of it becomes fog, the rest clear air, so that banks have\n"
        "edges. The same options and seed give the same bytes. With --tile the map has no seam when\n"
        "it is converted with --wrap repeat.\n"
        "\n"
        "The fogs of a scene, formulas and maps alike, are added up at the centre of each pixel. The\n"
        "map is scaled so that its densest pixel is 1, and `extinction` is printed: give it to\n"
        "`convert`. With --mean, --profile slab:Y0,Y1 there keeps the optical depth of every\n"
        "vertical ray through the pixel. --tile fades the first quarter of a scene's map into what\n"
        "lies behind its other end.\n"
        "\n"
        "Example: banks of fog that repeat every 400 m\n"
        "  wavefog generate simplex -o banks.png --seed 7 --coverage 0.6 --tile\n"
        "  wavefog convert banks.png -o banks.exr --wrap repeat --rect 0,0,400,400 \\\n"
        "                  --extinction 0.05 --profile exponential:0,8\n"
        "Example: plain noise, one octave\n"
        "  wavefog generate perlin -o plain.exr --octaves 1 --coverage 1 --features 8\n"
        "Example: a map in place of formulas\n"
        "  wavefog generate data/scenes/potentials.json -o mist.exr --mean 0,12");
    return {app, [options] { return generate(*options); }};
}

}  // namespace wavefog::cli
