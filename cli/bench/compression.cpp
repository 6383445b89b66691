#include "bench/compression.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <string_view>

#include "bench/progress.h"
#include "bench/ray_promise.h"
#include "bench/stability.h"
#include "bench/table_text.h"
#include "report.h"
#include "wavefog/fogmap/image.h"
#include "wavefog/fogmap/wfog.h"
#include "wavefog/gpu/timer.h"

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

constexpr double errors[] = {0, 1, 2, 4};  // in 1/255 of full scale
constexpr const char* ours[] = {"wavefog", "wavefog --best"};

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// A folder for the files of other programs, removed at the end.
class Workplace {
  public:
    Workplace() {
        std::string name = (fs::temp_directory_path() / "wavefog-bench-XXXXXX").string();
        if (const char* made = mkdtemp(name.data())) folder_ = made;
    }
    Workplace(const Workplace&) = delete;
    Workplace& operator=(const Workplace&) = delete;
    ~Workplace() {
        std::error_code ignored;
        if (!folder_.empty()) fs::remove_all(folder_, ignored);
    }
    const fs::path& folder() const { return folder_; }

  private:
    fs::path folder_;
};

/// Every value a whole number of steps?
bool in_steps(const Grid<float>& map, int steps) {
    return std::all_of(map.data(), map.data() + map.size(), [&](float value) {
        return static_cast<float>(std::round(double(value) * steps) / steps) == value;
    });
}

Result<CodecMap> read_codec_map(const fs::path& file) {
    ReadOptions read;
    read.sanitize = true;
    Result<Fogmap> map = read_fogmap(file, read);
    if (!map) return tl::unexpected(map.error());
    if (map->sanitized > 0)
        warn(fmt::format("{}: {} of {} pixels are no densities; they count as 0", file.string(),
                         map->sanitized, map->pixels.size()));
    CodecMap result{file.stem().string(), std::move(map->pixels), 1, 0};
    for (const int steps : {255, 65535})
        if (result.steps == 0 && in_steps(result.densities, steps)) result.steps = steps;
    return result;
}

/// Three maps that are made up: smooth waves, fractal noise of H = 0.7, and discs with hard edges.
std::vector<CodecMap> made_up_maps() {
    constexpr int size = 512;
    const auto in_bytes = [](std::string name, Grid<float> map) {
        const float low = map.minCoeff(), high = map.maxCoeff();
        map = ((map - low) / (high - low) * 255).round() / 255;
        return CodecMap{std::move(name), std::move(map), 1, 255};
    };
    Grid<float> smooth(size, size), fractal = Grid<float>::Zero(size, size);
    for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i)
            smooth(j, i) = float(std::sin(i * 0.021 + 2 * std::sin(j * 0.013)) +
                                 std::cos(j * 0.017 + i * 0.006));
    Random random(3);
    for (int cells = 4; cells <= size; cells *= 2) {
        Grid<float> nodes(cells + 1, cells + 1);
        for (Eigen::Index k = 0; k < nodes.size(); ++k)
            nodes.data()[k] = float(random.uniform(-1, 1) * std::pow(cells, -0.7));
        for (int j = 0; j < size; ++j)
            for (int i = 0; i < size; ++i) {
                const float u = float(i) * float(cells) / size, v = float(j) * float(cells) / size;
                const int x = int(u), y = int(v);
                const float a = u - float(x), b = v - float(y);
                fractal(j, i) += (nodes(y, x) * (1 - a) + nodes(y, x + 1) * a) * (1 - b) +
                                 (nodes(y + 1, x) * (1 - a) + nodes(y + 1, x + 1) * a) * b;
            }
    }
    std::vector<CodecMap> maps;
    maps.push_back(in_bytes("smooth", std::move(smooth)));
    maps.push_back(in_bytes("fractal", std::move(fractal)));
    maps.push_back(in_bytes("hard edges", hard_edged_map(size)));
    return maps;
}

void compare(const CodecMap& map, CodecRun& run) {
    const auto difference =
        (map.densities.cast<double>() - run.densities.cast<double>()) / map.full_scale;
    run.max_error = difference.abs().maxCoeff() * 255;
    const double mean = difference.square().mean();
    if (mean > 0) run.psnr = -10 * std::log10(mean);
}

/// The file and the way back to densities, on one thread. The encoder's time includes that it
/// decodes and checks its own bytes.
Result<CodecRun> run_ours(CodecMap& map, const Fog& fog, double error, bool best) {
    WfogOptions options;
    options.best = best;
    options.threads = 1;
    if (error > 0) {
        options.promise = WfogOptions::Promise::max_error;
        options.error = error / 255;
    }
    CodecRun run;
    auto start = std::chrono::steady_clock::now();
    const auto encoded = encode_wfog(fog, options, &map.densities);
    if (!encoded) return tl::unexpected(encoded.error());
    run.encode_s = seconds_since(start);
    run.bytes = encoded->bytes.size();
    WfogLimits limits;
    limits.threads = 1;
    start = std::chrono::steady_clock::now();
    auto decoded = decode_wfog(encoded->bytes, limits);
    if (!decoded) return tl::unexpected(decoded.error());
    run.decode_s = seconds_since(start);
    map.full_scale = encoded->report.full_scale;
    run.densities = std::move(decoded->map);
    return run;
}

/// A codec's run with the medians of its times: as many runs as some time allows, so that of quick
/// ones neither a cold cache nor a busy moment of the machine tells.
template <class Run>
Result<CodecRun> repeated(Run run_once) {
    constexpr std::size_t kMostRuns = 9;
    constexpr double kSeconds = 0.5;
    Result<CodecRun> run = run_once();
    if (!run) return run;
    Samples encode, decode;
    double total = 0;
    const auto add = [&](const CodecRun& one) {
        encode.add(one.encode_s);
        decode.add(one.decode_s);
        total += one.encode_s + one.decode_s;
    };
    add(*run);
    while (encode.size() < kMostRuns &&
           total * double(encode.size() + 1) <= kSeconds * double(encode.size())) {
        const Result<CodecRun> again = run_once();
        if (!again) return again;
        add(*again);
    }
    const auto spread = [](const Samples& seconds) {
        return (seconds.percentile(100) - seconds.percentile(0)) / seconds.median();
    };
    run->encode_s = encode.median();
    run->decode_s = decode.median();
    run->encode_spread = spread(encode);
    run->decode_spread = spread(decode);
    return run;
}

Facts run_facts(const CodecMap& map, const std::string& codec, double error, const CodecRun& run) {
    const auto pixels = double(map.densities.size());
    return {{"map", map.name},
            {"pixels", map.densities.size()},
            {"codec", codec},
            {"error", error},
            {"bytes", run.bytes},
            {"bits_per_pixel", 8 * double(run.bytes) / pixels},
            {"encode_mpixel_s", pixels / 1e6 / run.encode_s},
            {"decode_mpixel_s", pixels / 1e6 / run.decode_s},
            {"encode_spread", run.encode_spread},
            {"decode_spread", run.decode_spread},
            {"max_error", run.max_error ? Facts(*run.max_error) : Facts()},
            {"psnr", run.psnr ? Facts(*run.psnr) : Facts()}};
}

constexpr double kTimedPixels = 60000;  // a smaller map takes too little time

/// The runs of a codec at an error on the maps that all have; `timed`: on those large enough.
std::vector<Facts> runs_of(const Facts& runs, const std::string& codec, double error,
                           const std::set<std::string>& maps, bool timed) {
    std::vector<Facts> found;
    for (const Facts& run : runs)
        if (run.at("codec") == codec && run.at("error") == error &&
            maps.count(run.at("map").get<std::string>()) > 0 &&
            (!timed || run.at("pixels").get<double>() >= kTimedPixels))
            found.push_back(run);
    return found;
}

/// Geometric mean of a key over them.
std::optional<double> mean_of(const Facts& runs, const std::string& codec, double error,
                              const std::set<std::string>& maps, const char* key) {
    const bool timed = std::string_view(key).ends_with("mpixel_s");
    double sum = 0;
    int count = 0;
    for (const Facts& run : runs_of(runs, codec, error, maps, timed))
        if (run.at(key).is_number()) {
            sum += std::log(run.at(key).get<double>());
            ++count;
        }
    if (count == 0) return {};
    return std::exp(sum / count);
}

/// The mean speed at 1/255 and the median spread of what ran more than once: "34.6 ± 4 %".
std::string speed_text(const Facts& runs, const std::string& codec,
                       const std::set<std::string>& maps, const std::string& way) {
    const auto speed = mean_of(runs, codec, 1, maps, (way + "_mpixel_s").c_str());
    Samples spreads;
    for (const Facts& run : runs_of(runs, codec, 1, maps, true))
        if (const double spread = run.value(way + "_spread", 0.0); spread > 0) spreads.add(spread);
    std::string text = short_number(speed);
    if (spreads.size() > 0) text += fmt::format(" ± {:.0f} %", 50 * spreads.median());
    return text;
}

std::vector<std::string> in_order(const Facts& runs, const char* key) {
    std::vector<std::string> names;
    for (const Facts& run : runs)
        if (std::find(names.begin(), names.end(), run.at(key).get<std::string>()) == names.end())
            names.push_back(run.at(key));
    return names;
}

/// Maps that every codec has coded at this error.
std::set<std::string> common_maps(const Facts& runs, double error) {
    std::map<std::string, std::set<std::string>> codecs;
    std::set<std::string> all;
    for (const Facts& run : runs) {
        if (run.at("error") != error) continue;
        codecs[run.at("map")].insert(run.at("codec").get<std::string>());
        all.insert(run.at("codec").get<std::string>());
    }
    std::set<std::string> maps;
    for (const auto& [map, has] : codecs)
        if (has == all) maps.insert(map);
    return maps;
}

}  // namespace

Result<void> study_compression(const std::vector<fs::path>& pictures, Results& results) {
    std::vector<CodecMap> maps;
    for (const fs::path& file : pictures) {
        Result<CodecMap> map = read_codec_map(file);
        if (!map) return tl::unexpected(map.error());
        maps.push_back(*std::move(map));
    }
    for (CodecMap& map : made_up_maps()) maps.push_back(std::move(map));
    const std::vector<std::string> peers = installed_peers();
    const Workplace workplace;
    results.compression = Facts::array();
    const auto start = std::chrono::steady_clock::now();
    for (std::size_t m = 0; m < maps.size(); ++m) {
        CodecMap& map = maps[m];
        const Result<Fog> fog = make_fog(map.densities, {});
        if (!fog) return tl::unexpected(fog.error());
        for (const double error : errors) {
            show_progress_line(double(m) / double(maps.size()), seconds_since(start), map.name);
            for (const bool best : {false, true}) {
                Result<CodecRun> run = repeated([&] { return run_ours(map, *fog, error, best); });
                if (!run) return tl::unexpected(run.error());
                compare(map, *run);
                results.compression.push_back(run_facts(map, ours[best ? 1 : 0], error, *run));
            }
            const std::optional<Prequantised> input = prequantise(map, error);
            if (!input) continue;
            for (const std::string& peer : peers) {
                Result<CodecRun> run = repeated(
                    [&] { return run_peer(peer, map, error, *input, workplace.folder()); });
                if (!run) {
                    results.skipped.push_back(map.name + ": " + run.error().message);
                    continue;
                }
                compare(map, *run);
                results.compression.push_back(run_facts(map, peer, error, *run));
            }
        }
        if (auto ok = measure_ray_promise(map, results.ray_promise); !ok) return ok;
    }
    clear_progress_line();
    return {};
}

std::string compression_text(const Facts& runs, bool markdown) {
    const std::vector<std::string> codecs = in_order(runs, "codec");
    std::map<double, std::set<std::string>> maps;
    for (const double error : errors) maps[error] = common_maps(runs, error);
    std::string text = fmt::format(
        "Bits a pixel (geometric means of {} maps; without loss {}), PSNR at 4/255 in dB, and "
        "Mpixel/s at 1/255 on maps of at least 60000 pixels, one thread (ours with the check of "
        "its own bytes; medians of up to 9 runs where they are quick, ± half their range)\n\n",
        maps[1].size(), maps[0].size());
    Table table({"codec", "lossless", "1/255", "2/255", "4/255", "PSNR", "in", "out"});
    for (const std::string& codec : codecs) {
        std::vector<std::string> row = {codec};
        for (const double error : errors) {
            const auto bits = mean_of(runs, codec, error, maps[error], "bits_per_pixel");
            row.push_back(bits ? fmt::format("{:.2f}", *bits) : "-");
        }
        const auto psnr = mean_of(runs, codec, 4, maps[4], "psnr");
        row.push_back(psnr ? fmt::format("{:.1f}", *psnr) : "-");
        row.push_back(speed_text(runs, codec, maps[1], "encode"));
        row.push_back(speed_text(runs, codec, maps[1], "decode"));
        table.add(row);
    }
    text += table.text(markdown) + "\nBits a pixel at 1/255 → 4/255\n\n";
    std::vector<std::string> header = {"map"};
    header.insert(header.end(), codecs.begin(), codecs.end());
    Table each(header);
    for (const std::string& map : in_order(runs, "map")) {
        std::vector<std::string> row = {map};
        for (const std::string& codec : codecs) {
            const auto tight = mean_of(runs, codec, 1, {map}, "bits_per_pixel");
            const auto loose = mean_of(runs, codec, 4, {map}, "bits_per_pixel");
            row.push_back(tight && loose ? fmt::format("{:.2f} → {:.2f}", *tight, *loose) : "-");
        }
        each.add(row);
    }
    return text + each.text(markdown);
}

std::vector<Figure> compression_figures(const Facts& runs) {
    const std::vector<std::string> codecs = in_order(runs, "codec");
    Figure distortion, speed;
    distortion.id = "rate-distortion";
    distortion.title = "Bits against distortion";
    distortion.subtitle = "means over all maps at 1, 2 and 4/255 of full scale";
    distortion.x = {"bits a pixel", true};
    distortion.y = {"PSNR, dB", false};
    speed.id = "rate-speed";
    speed.title = "Speed against bits";
    speed.subtitle = "means over maps of at least 60000 pixels at 1/255 of full scale, one thread";
    speed.x = {"bits a pixel", true};
    speed.y = {"Mpixel a second", true};
    for (const std::string& codec : codecs) {
        Curve curve{codec, codec, Curve::Style::line, {}};
        for (const double error : {1.0, 2.0, 4.0}) {
            const auto maps = common_maps(runs, error);
            const auto bits = mean_of(runs, codec, error, maps, "bits_per_pixel");
            const auto psnr = mean_of(runs, codec, error, maps, "psnr");
            if (bits && psnr) curve.points.emplace_back(*bits, *psnr);
        }
        if (codec == zfp_name && !curve.points.empty())
            // Its errors are far below the promise: with it the others are one heap.
            distortion.subtitle +=
                fmt::format("; zfp lies outside, {:.1f} bits and {:.0f} dB at 4/255",
                            curve.points.back().first, curve.points.back().second);
        else
            distortion.curves.push_back(curve);
        const auto maps = common_maps(runs, 1);
        const auto bits = mean_of(runs, codec, 1, maps, "bits_per_pixel");
        const auto in = mean_of(runs, codec, 1, maps, "encode_mpixel_s");
        const auto out = mean_of(runs, codec, 1, maps, "decode_mpixel_s");
        if (!bits || !in || !out) continue;
        speed.curves.push_back({codec, codec, Curve::Style::dashed, {{*bits, *in}, {*bits, *out}}});
        speed.notes.push_back({*bits, *in, "in", codec});
        speed.notes.push_back({*bits, *out, "out", codec});
    }
    return {distortion, speed};
}

}  // namespace wavefog::cli
