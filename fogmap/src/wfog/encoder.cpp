#include "encoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>

#include "bands.h"
#include "decoder.h"
#include "format.h"
#include "plane.h"
#include "ray_errors.h"
#include "smoothness.h"
#include "source.h"
#include "tile_errors.h"

namespace wavefog::wfog {

namespace {

using std::int32_t;
using std::int64_t;
using std::size_t;

/// Lossy floats become integers of a 31st of the promised interval, so that the predictor works
/// below the bound.
constexpr int64_t kStepsOfBound = 15;

/// Maps of so many pixels are tried without loss too.
constexpr Eigen::Index kSmallMap = 128 * 128;

/// A density that occurs so often is worth its entry in a table.
constexpr size_t kUsesOfTable = 8;

tl::unexpected<Error> broken_promise() {
    return data_error("the encoded bytes do not keep the promise; this is a bug, please report it");
}

/// Tiles of a map as integers. What the scale does not have, the check of the decoded bytes finds.
TileSource tiles_of(const Grid<float>& map, const Scale& scale) {
    return [&](const Place& place, Tile& tile) {
        for (int j = 0; j < place.height; ++j)
            scale.integers(map.data() + place.index(j, static_cast<int>(map.cols())),
                           size_t(place.width), tile.row(j));
    };
}

/// Encodes a map; the errors are those of its tiles as decoded from the streams. `exact`: they must
/// be the map's own integers. `decoded`: gets the decoded map; or null.
Result<Errors> encode_map(const Grid<float>& map, const Scale& scale, const PlaneCoding& coding,
                          const WfogOptions& options, bool exact, Grid<float>* decoded,
                          PlaneStreams& streams) {
    TileErrors errors(map, scale, coding.tiles(), exact, decoded);
    const PlaneResult result = encode_plane(
        coding, options.best, options.threads, options.stop, tiles_of(map, scale),
        [&](size_t tile, const Place& place, const Tile& values) {
            return errors.add(tile, place, values);
        },
        streams);
    if (result == PlaneResult::stopped) return cancelled();
    if (result == PlaneResult::damaged) return broken_promise();
    return errors.sum();
}

Head head_of(const Fog& fog) {
    Head head;
    head.fog.rect = fog.rect;
    head.fog.extinction = fog.extinction;
    head.fog.profile = fog.profile;
    head.fog.wind = fog.wind;
    Decomposition<float>& d = head.fog.decomposition;
    d.family = fog.decomposition.family;
    d.form = fog.decomposition.form;
    d.boundary = fog.decomposition.boundary;
    d.width = fog.decomposition.width;
    d.height = fog.decomposition.height;
    head.levels = fog.decomposition.levels();
    return head;
}

/// A file and what a decoder makes of it.
struct Trial {
    EncodedFog file;
    Grid<float> map;        ///< where rays are promised
    bool negative = false;  ///< somewhere below 0 where the original is not
};

/// The smaller file, or what went wrong.
Result<Trial> smaller_of(Result<Trial> a, Result<Trial> b) {
    const bool second = a && (!b || b->file.bytes.size() < a->file.bytes.size());
    return std::move(second ? b : a);
}

/// Errors between two that whole steps of the picture allow: rays do not care whether pixels are
/// off by whole steps.
bool wants_finer_steps(double steps) {
    constexpr double kMostSteps = 16;
    return steps < kMostSteps && steps - std::floor(steps) > 0.5;
}

/// Bounds of a smooth map: that of the finest level as a share of what is allowed, and those of the
/// levels before it, each a share of the next.
struct Tightness {
    double finest = 1, coarser = 1;
};
/// The share of a prequantiser's RMS error that smooth maps may have.
constexpr double kThreeDecibels = 0.7079;

/// Each with more bits and less error than the one before; bounds of 0.7 at coarse levels bring
/// most smooth maps 3 dB for 3 % more bits.
constexpr Tightness kTightness[] = {{1, 0.7}, {1, 0.6}, {0.75, 0.85}, {0.75, 0.7}};

Bounds tightened(int64_t allowed, int levels, const Tightness& by) {
    Bounds bounds;
    const int64_t least = std::min<int64_t>(allowed, 1);
    bounds.finest = std::max(least, int64_t(std::lround(double(allowed) * by.finest)));
    bounds.coarser.resize(static_cast<size_t>(levels));
    auto bound = static_cast<double>(bounds.finest);
    for (size_t l = bounds.coarser.size(); l-- > 0;) {
        bound *= by.coarser;
        bounds.coarser[l] = std::max(least, int64_t(std::lround(bound)));
    }
    return bounds;
}

/// One file from a fog's pixels, with at most `error` (in densities; 0: none) at any pixel.
class PixelEncoder {
  public:
    PixelEncoder(const Fog& fog, const Source& source, const WfogOptions& options)
        : source_(source), options_(options), head_(head_of(fog)) {
        const Decomposition<float>& d = fog.decomposition;
        head_.stream_levels = default_stream_levels(d.width, d.height, head_.tile_bits);
    }

    /// `coarseness`: how many times `error` the densest pixels may be off, at least 1.
    Result<Trial> encode(double error, double coarseness = 1) {
        choose_scale(error, coarseness);
        return encode_within(bounds_by(kTightness[0]));
    }

    /// How many bits a pixel less the coarseness takes than 1, about.
    double saving(double error, double coarseness) {
        find_scale(error, coarseness);
        return head_.scale.kind == Scale::Kind::companded
                   ? mean_coarseness(head_.scale, source_.map())
                   : 0;
    }

    /// The same, with errors that are 3 dB below a prequantiser's where the map is smooth.
    Result<Trial> encode_well(double error) {
        choose_scale(error);
        std::vector<Bounds> choices;
        for (const Tightness& by : kTightness)
            if (const Bounds bounds = bounds_by(by); choices.empty() || choices.back() != bounds)
                choices.push_back(bounds);
        if (choices.size() == 1) return encode_within(choices[0]);
        // Estimates are off by a few percent; where that matters there is a second, unless it is as
        // well to try.
        constexpr double kUnsure = 0.04, kLikely = 0.985;
        bool rough = true;
        double enough =
            kThreeDecibels * prequantised_rms(source_.map(), head_.scale, allowed_, true);
        const auto unsure = [&](double rms) { return std::fabs(rms / enough - 1) < kUnsure; };
        const auto suffices = [&](double rms) {
            if (rough && unsure(rms)) {
                rough = false;
                enough =
                    kThreeDecibels * prequantised_rms(source_.map(), head_.scale, allowed_, false);
            }
            return rms <= enough;
        };
        size_t choice = 0;
        for (; choice + 1 < choices.size(); ++choice) {
            auto rms = rms_of(choices[choice], Strips::first);
            if (rms && unsure(*rms) && *rms > kLikely * enough)
                if (const auto other = rms_of(choices[choice], Strips::third))
                    rms = std::hypot(*rms, *other) * std::sqrt(0.5);
            if (!rms || suffices(*rms)) break;
        }
        Result<Trial> trial;
        for (; choice < choices.size(); ++choice) {
            trial = encode_within(choices[choice]);
            if (!trial || suffices(trial->file.report.rms_error)) break;
        }
        return trial;
    }

  private:
    /// Where most pixels follow from their neighbours, exact neighbours are worth their bits.
    Bounds bounds_by(const Tightness& by) const {
        if (smooth_) return tightened(allowed_, head_.stream_levels, by);
        return {.finest = allowed_};
    }

    PlaneCoding coding() const {
        const Decomposition<float>& d = head_.fog.decomposition;
        return coding_of(head_, d.width, d.height, head_.stream_levels);
    }

    std::optional<double> rms_of(const Bounds& bounds, Strips strips) {
        head_.bounds = bounds;
        const auto square = squared_error_of(coding(), strips, options_.threads, options_.stop,
                                             tiles_of(source_.map(), head_.scale));
        if (!square) return {};
        return std::sqrt(*square) * double(head_.scale.density(1));
    }

    /// With the scale as it is.
    Result<Trial> encode_within(const Bounds& bounds) {
        head_.bounds = bounds;
        Trial trial;
        const Grid<float>& map = source_.map();
        const bool by_rays = options_.promise == WfogOptions::Promise::max_transmittance_error;
        if (by_rays) trial.map.resize(map.rows(), map.cols());
        const PlaneCoding plane = coding();
        PlaneStreams streams;
        const auto errors = encode_map(map, head_.scale, plane, options_, allowed_ == 0,
                                       by_rays ? &trial.map : nullptr, streams);
        if (!errors) return tl::unexpected(errors.error());
        const Errors& made = *errors;
        head_.max_error = static_cast<float>(made.most);
        if (!heed_bounds(streams[0])) head_.bounds = {};
        std::vector<Bytes> chunks;
        for (const std::vector<Bytes>& level : streams) chunks.push_back(join(level));
        trial.file.bytes = write_chunks(head_, chunks);
        if (!holds(trial.file.bytes, streams)) return broken_promise();
        trial.file.report.max_error = made.most;
        trial.file.report.rms_error = std::sqrt(made.squares / static_cast<double>(map.size()));
        trial.negative = made.negative;
        return trial;
    }

    /// The bytes of the file are those of the tiles that were decoded, and its head says what they
    /// were decoded by.
    bool holds(const Bytes& bytes, const PlaneStreams& streams) const {
        const auto chunks = read_chunks(bytes, false);
        if (!chunks) return false;
        const Head& head = chunks->head;
        const Decomposition<float>&ours = head_.fog.decomposition, &its = head.fog.decomposition;
        if (its.width != ours.width || its.height != ours.height || head.scale != head_.scale ||
            head.bounds != head_.bounds || head.tile_bits != head_.tile_bits ||
            head.stream_levels != head_.stream_levels || head.content != head_.content ||
            chunks->streams.size() != streams.size())
            return false;
        for (size_t level = 0; level < streams.size(); ++level) {
            std::vector<View> tiles;
            if (!split_chunk(chunks->streams[level], streams[level].size(), tiles)) return false;
            for (size_t t = 0; t < tiles.size(); ++t)
                if (!std::equal(tiles[t].begin(), tiles[t].end(), streams[level][t].begin(),
                                streams[level][t].end()))
                    return false;
        }
        return true;
    }

    void choose_scale(double error, double coarseness = 1) {
        find_scale(error, coarseness);
        smooth_ = allowed_ > 1 && mostly_foretold(source_.map(), head_.scale, allowed_, 0.95);
    }

    void find_scale(double error, double coarseness) {
        allowed_ = 0;
        const bool by_rays = options_.promise == WfogOptions::Promise::max_transmittance_error;
        if (source_.ratio && coarseness == 1 &&
            !(by_rays && wants_finer_steps(error * source_.ratio->divisor))) {
            head_.scale = *source_.ratio;
            // The last bits of a double must not cost a whole step.
            allowed_ = static_cast<int64_t>(
                std::min(error * head_.scale.divisor * (1 + 1e-12), double(1 << 29)));
            return;
        }
        const double most = double(source_.map().abs().maxCoeff());
        // Float rounding of the decoded density comes on top.
        const double usable = error - most * 1.2e-7;
        const double step = usable / (double(kStepsOfBound) + 0.5);
        // Steps near the denormal floats would have too few digits.
        if (usable < 0x1p-100 || most / step > double(1 << 29)) {
            head_.scale = exact_scale(source_.map(), kUsesOfTable);
            return;
        }
        if (coarseness > 1)
            head_.scale = companded_scale(step, coarseness, most);
        else
            head_.scale = {.kind = Scale::Kind::step, .step = step};
        allowed_ = kStepsOfBound;
    }

    static Bytes join(const std::vector<Bytes>& tiles) {
        if (tiles.size() == 1) return tiles[0];
        Writer w;
        for (const Bytes& tile : tiles) w.length(tile.size());
        for (const Bytes& tile : tiles) w.append(tile);
        return std::move(w.bytes);
    }

    const Source& source_;
    const WfogOptions& options_;
    Head head_;
    int64_t allowed_ = 0;  ///< how far an integer may be off
    bool smooth_ = false;  ///< most pixels follow from their neighbours
};

/// All coefficients, one after another.
Grid<float> coefficients_of(const Decomposition<float>& d) {
    std::vector<float> all;
    for (const auto& level : bands_of(d))
        for (const Band<float>* band : level)
            all.insert(all.end(), band->values.data(), band->values.data() + band->values.size());
    return Eigen::Map<const Grid<float>>(all.data(), 1, static_cast<Eigen::Index>(all.size()));
}

Result<EncodedFog> encode_coefficients(const Fog& fog, const Scale& scale,
                                       const WfogOptions& options) {
    const Decomposition<float>& d = fog.decomposition;
    Head head = head_of(fog);
    head.content = Content::coefficients;
    head.scale = scale;
    std::vector<Bytes> chunks;
    for (const auto& level : bands_of(d)) {
        Writer chunk;
        for (const Band<float>* band : level) {
            if (band->values.size() == 0) continue;
            PlaneStreams streams;
            const PlaneCoding coding =
                coding_of(head, band->width(), band->height(), band_levels(*band, head.tile_bits));
            const auto errors =
                encode_map(band->values, head.scale, coding, options, true, nullptr, streams);
            if (!errors) return tl::unexpected(errors.error());
            for (const auto& stream : streams)
                for (const Bytes& tile : stream) {
                    chunk.length(tile.size());
                    chunk.append(tile);
                }
        }
        chunks.push_back(std::move(chunk.bytes));
    }
    EncodedFog encoded;
    encoded.bytes = write_chunks(head, chunks);
    return encoded;
}

/// A file of the coefficients themselves: for fogs that no map of floats gives bit for bit.
Result<EncodedFog> encode_coefficients(const Fog& fog, const WfogOptions& options) {
    const Grid<float> all = coefficients_of(fog.decomposition);
    const Scale ranks = exact_scale(all, 1), bits = exact_scale(all, kUsesOfTable);
    auto encoded = encode_coefficients(fog, bits, options);
    if (!encoded || ranks.kind == bits.kind) return encoded;
    auto by_ranks = encode_coefficients(fog, ranks, options);
    const bool smaller = !by_ranks || by_ranks->bytes.size() < encoded->bytes.size();
    return smaller ? std::move(by_ranks) : std::move(encoded);
}

Result<void> check_options(const WfogOptions& options) {
    using Promise = WfogOptions::Promise;
    const bool has_error = options.promise == Promise::max_error ||
                           options.promise == Promise::max_transmittance_error;
    if (has_error && !(options.error > 0 && std::isfinite(options.error)))
        return usage_error(
            fmt::format("the promised error is {}; it must be above 0", options.error));
    if (options.promise == Promise::max_transmittance_error &&
        !(options.path > 0 && std::isfinite(options.path)))
        return usage_error(fmt::format("the path is {}; it must be above 0 metres", options.path));
    if (std::isnan(options.ground)) return usage_error("the ground's height is not a number");
    if (options.promise == Promise::bytes && options.bytes == 0)
        return usage_error("the file cannot have 0 bytes; allow some");
    return {};
}

/// The largest error whose file still fits; by halving the range of its logarithm.
Result<Trial> fit_bytes(PixelEncoder& encoder, double scale, size_t bytes) {
    auto lossless = encoder.encode(0);
    if (!lossless || lossless->file.bytes.size() <= bytes) return lossless;
    double fits = std::log(scale), too_large = std::log(scale * 1e-6);
    auto best = encoder.encode(scale);
    if (!best) return best;
    if (best->file.bytes.size() > bytes)
        return data_error(fmt::format("cannot be as small as {} bytes; {} are the least here",
                                      bytes, best->file.bytes.size()));
    for (int i = 0; i < 12; ++i) {
        const double middle = (fits + too_large) / 2;
        auto trial = encoder.encode(std::exp(middle));
        if (!trial) return trial;
        if (trial->file.bytes.size() <= bytes) {
            fits = middle;
            if (trial->file.report.rms_error <= best->file.report.rms_error)
                best = std::move(trial);
        } else {
            too_large = middle;
        }
    }
    return best;
}

/// Looks for the smallest file whose rays are proved to keep their promise.
class RaySearch {
  public:
    RaySearch(PixelEncoder& encoder, const Fog& fog, const Source& source,
              const WfogOptions& options)
        : encoder_(encoder),
          fog_(fog),
          source_(source),
          options_(options),
          parts_(parts_of(fog, source.map().size(), options.path)) {}

    /// What guarantees the same pixel by pixel, E / (extinction * path), is where the search
    /// starts; it ends where no larger error is worth it. Then dense fog, which hides errors, gets
    /// coarser steps while that pays.
    Result<Trial> run(double scale) {
        const double sure = options_.error / std::max(fog_.extinction * options_.path, 1e-300);
        auto best = smaller_of(encoder_.encode(std::min(sure, scale)), encoder_.encode(0));
        if (!best) return best;
        best->file.report.ray_error = worst_ray(*best, parts_);
        const Range all{.low = std::log(sure), .high = std::log(std::max(scale, sure))};
        // White errors add up like the root of the cells: the answer is nearer to the low end.
        const auto rough = widen(all, std::lerp(all.low, all.high, 0.4), 1, 1, kRough, *best);
        if (!rough) return tl::unexpected(rough.error());
        auto found =
            widen({.low = *rough, .high = all.high}, *rough + kRough, 1, parts_, kFine, *best);
        if (!found) return tl::unexpected(found.error());
        for (double coarseness = kMoreCoarse; coarseness <= kMostCoarse;
             coarseness *= kMoreCoarse) {
            // Below the lowest error, coarser steps save less than they cost.
            const double saved = std::log(2.0) * encoder_.saving(std::exp(*found), coarseness);
            if (saved < kFine) break;
            const size_t bytes = best->file.bytes.size();
            const auto other = widen({.low = *found - saved, .high = *found + kRough},
                                     *found - saved / 2, coarseness, parts_, kFine, *best);
            if (!other) return tl::unexpected(other.error());
            if (best->file.bytes.size() == bytes) break;
        }
        return best;
    }

  private:
    /// Of the logarithm of an error.
    struct Range {
        double low, high;
        bool refused = false;  ///< so large an error was
    };
    static constexpr double kRough = 0.25, kFine = 0.04;
    static constexpr double kMoreCoarse = 2, kMostCoarse = 64;

    /// Of a cell, by which lines are told apart: what bounds long ones misses by more.
    static int parts_of(const Fog& fog, Eigen::Index pixels, double path) {
        const double cells = path / std::min(fog.cell_x(), fog.cell_z());
        if (pixels > 1 << 25) return 1;
        return pixels >= 1 << 20 || cells <= 128 ? 2 : 4;
    }

    /// The largest error in the range that is proved by so many parts of a cell, about; `best` gets
    /// the smallest file that keeps the promise.
    Result<double> widen(Range range, double next, double coarseness, int parts, double width,
                         Trial& best) {
        next = std::clamp(next, range.low, range.high);
        for (int i = 0; i < 8 && range.high - range.low > width; ++i) {
            auto trial = encoder_.encode(std::exp(next), coarseness);
            if (!trial) return tl::unexpected(trial.error());
            // Larger files need no proof, and other errors may make the same file.
            const bool smaller = trial->file.bytes.size() < best.file.bytes.size();
            const bool refused = trial->file.bytes == refused_.bytes && parts <= refused_.parts;
            const double worst = !smaller ? 0 : refused ? refused_.worst : worst_ray(*trial, parts);
            next = narrow(range, next, worst);
            if (worst > options_.error) refused_ = {trial->file.bytes, worst, parts};
            if (worst > options_.error || !smaller) continue;
            best = std::move(*trial);
            best.file.report.ray_error = worst;
        }
        return range.low;
    }

    /// Narrows a range by a trial; the next one.
    double narrow(Range& range, double tried, double worst) const {
        const bool kept = worst <= options_.error;
        (kept ? range.low : range.high) = tried;
        range.refused |= !kept;
        const double middle = (range.low + range.high) / 2;
        if (kept) return range.refused ? middle : std::min(middle, range.low + 2 * kRough);
        // Rays are off by more than in proportion to pixels.
        const double less = tried + std::log(options_.error / worst);
        return std::clamp(less, middle, std::max(middle, range.high - kFine / 2));
    }

    double worst_ray(const Trial& trial, int parts) const {
        return worst_ray_error(fog_, source_.map(), trial.map - source_.map(), options_, parts);
    }

    PixelEncoder& encoder_;
    const Fog& fog_;
    const Source& source_;
    const WfogOptions& options_;
    const int parts_;  ///< of a cell
    struct {
        Bytes bytes;
        double worst = 0;
        int parts = 0;
    } refused_;  ///< the last file that does not keep the promise
};

/// Every pixel, as decoded from the file's bytes, keeps the promise.
Result<void> check_promise(const Trial& trial, const Source& source, double allowed) {
    // k / 255 and k' / 255 are floats, each off by half of its last bit.
    const double rounding = allowed > 0 ? double(source.map().abs().maxCoeff()) * 0x1p-23 : 0;
    if (trial.file.report.max_error > allowed + rounding || (allowed > 0 && trial.negative))
        return broken_promise();
    return {};
}

Result<EncodedFog> encode_pixels(const Fog& fog, const Source& source, double scale,
                                 const WfogOptions& options) {
    using Promise = WfogOptions::Promise;
    PixelEncoder encoder(fog, source, options);
    Result<Trial> trial;
    double allowed = std::numeric_limits<double>::infinity();
    switch (options.promise) {
        case Promise::lossless:
            allowed = 0;
            trial = encoder.encode(0);
            break;
        case Promise::max_error:
            allowed = options.error * scale;
            trial = encoder.encode_well(allowed);
            // It takes no time, and may have few values.
            if (trial && source.map().size() <= kSmallMap)
                trial = smaller_of(std::move(trial), encoder.encode(0));
            break;
        case Promise::bytes:
            // An error of all of the map's range leaves nothing to tell apart.
            trial = fit_bytes(
                encoder,
                std::max(double(source.map().maxCoeff()) - double(source.map().minCoeff()), 1e-30),
                options.bytes);
            break;
        case Promise::max_transmittance_error:
            trial = RaySearch(encoder, fog, source, options).run(std::max(scale, 1e-30));
            break;
    }
    if (!trial) return tl::unexpected(trial.error());
    if (auto ok = check_promise(*trial, source, allowed); !ok) return tl::unexpected(ok.error());
    return std::move(trial->file);
}

}  // namespace

Result<EncodedFog> encode(const Fog& fog, const WfogOptions& options, const Grid<float>* map) {
    const bool lossless = options.promise == WfogOptions::Promise::lossless;
    if (auto ok = check_options(options); !ok) return tl::unexpected(ok.error());
    if (auto ok = fog.validate(); !ok) return tl::unexpected(ok.error());
    const Decomposition<float>& d = fog.decomposition;
    if (d.width > kMaxWfogSide || d.height > kMaxWfogSide)
        return data_error(fmt::format("{} x {} pixels; a side of at most {} fits into a .wfog file",
                                      d.width, d.height, kMaxWfogSide));
    const Source source = source_of(fog, map, lossless);
    const double scale = full_scale(source.map(), source.ratio);
    const bool by_coefficients = lossless && !source.exact;
    Result<EncodedFog> encoded = by_coefficients ? encode_coefficients(fog, options)
                                                 : encode_pixels(fog, source, scale, options);
    if (!encoded) return encoded;
    if (by_coefficients) {
        WfogLimits limits;
        limits.max_map_bytes = std::numeric_limits<size_t>::max();
        limits.threads = options.threads;
        limits.stop = options.stop;
        const auto decoded = decode(encoded->bytes, limits);
        if (!decoded) return tl::unexpected(decoded.error());
        if (!same_coefficients(decoded->fog.decomposition, fog.decomposition))
            return broken_promise();
    }
    WfogReport& report = encoded->report;
    const auto pixels = static_cast<double>(source.map().size());
    report.bytes = encoded->bytes.size();
    report.bits_per_pixel = 8 * static_cast<double>(report.bytes) / pixels;
    report.ratio = pixels * sizeof(float) / static_cast<double>(report.bytes);
    report.full_scale = scale;
    return encoded;
}

}  // namespace wavefog::wfog
