#include "encoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "bands.h"
#include "decoder.h"
#include "format.h"
#include "plane.h"
#include "ray_errors.h"

namespace wavefog::wfog {

namespace {

using std::int32_t;
using std::int64_t;
using std::size_t;

/// A reconstruction is off by up to 16 * 2^-24 of the maximum (decomposition.h).
constexpr double kRounding = 2e-6;
/// Lossy floats become integers of a 31st of the promised interval, so that the predictor works
/// below the bound.
constexpr int64_t kStepsOfBound = 15;

/// The map that gives exactly the fog's coefficients, if one is found.
bool gives(const Grid<float>& map, const Fog& fog) {
    const auto again = decompose_as(map, fog.decomposition, fog.decomposition.levels());
    return again && same_coefficients(*again, fog.decomposition);
}

/// The fog's pixels and, if they are multiples of a common fraction, which.
struct Source {
    const Grid<float>* given = nullptr;  ///< its pixels, unless `made`
    std::optional<Grid<float>> made;
    std::optional<Scale> ratio;
    bool exact = false;  ///< decomposing the map gives the fog's own bits; known if lossless

    const Grid<float>& map() const { return made ? *made : *given; }
};

Source source_of(const Fog& fog, const Grid<float>* map, bool lossless) {
    Source source;
    source.given = map;
    if (!map) source.made = reconstruct(fog.decomposition);
    source.ratio = ratio_of(source.map(), 0);
    source.exact = lossless && gives(source.map(), fog);
    if (source.ratio || (map && source.exact)) return source;
    // Rounding may hide the steps of an integer picture.
    if (const auto ratio = ratio_of(source.map(), kRounding)) {
        Source snapped;
        snapped.ratio = ratio;
        snapped.made = source.map().unaryExpr(
            [&](float value) { return ratio->density(*ratio->integer(value)); });
        snapped.exact = lossless && gives(snapped.map(), fog);
        if (snapped.exact || !source.exact) return snapped;
    }
    return source;
}

std::vector<int32_t> integers_of(const Grid<float>& map, const Scale& scale) {
    std::vector<int32_t> integers(static_cast<size_t>(map.size()));
    scale.integers(map.data(), integers.size(), integers.data());
    return integers;
}

struct Errors {
    double most = 0, rms = 0;
    bool negative = false;  ///< somewhere below 0 where the original is not
};

Errors compare(const Grid<float>& original, const Grid<float>& decoded) {
    // Sums of every fourth pixel, side by side: an order that vectors can keep.
    constexpr Eigen::Index kLanes = 4;
    std::array<double, kLanes> most{}, squares{};
    int negative = 0;
    const auto add = [&](Eigen::Index i, size_t lane) {
        const double a = double(original.data()[i]), b = double(decoded.data()[i]);
        const double error = std::fabs(a - b);
        most[lane] = most[lane] < error ? error : most[lane];
        squares[lane] += error * error;
        negative |= (a >= 0 ? 1 : 0) & (b < 0 ? 1 : 0);
    };
    Eigen::Index i = 0;
    for (; i + kLanes <= original.size(); i += kLanes)
        for (Eigen::Index lane = 0; lane < kLanes; ++lane) add(i + lane, static_cast<size_t>(lane));
    for (; i < original.size(); ++i) add(i, 0);
    const double sum = std::accumulate(squares.begin(), squares.end(), 0.0);
    return {*std::max_element(most.begin(), most.end()),
            std::sqrt(sum / static_cast<double>(original.size())), negative != 0};
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

/// A file and what a decoder must make of it.
struct Trial {
    EncodedFog file;
    Head head;
    std::vector<int32_t> integers;
    Grid<float> map;
    bool negative = false;  ///< somewhere below 0 where the original is not
};

/// Errors between two that whole steps of the picture allow: rays do not care whether pixels are
/// off by whole steps.
bool wants_finer_steps(double steps) {
    constexpr double kMostSteps = 16;
    return steps < kMostSteps && steps - std::floor(steps) > 0.5;
}

/// How many pixels inside the map the mean of the four around them foretells within the bound; of
/// every other row. `Int` holds four times any integer and the bound.
template <class Int>
size_t count_foretold(const std::vector<int32_t>& integers, size_t width, Int bound) {
    size_t foretold = 0;
    for (size_t row = 1; (row + 2) * width <= integers.size(); row += 2) {
        const int32_t* const here = integers.data() + row * width;
        const int32_t *const above = here - width, *const below = here + width;
        int32_t in_row = 0;
        for (size_t i = 1; i + 1 < width; ++i) {
            const Int around = Int(here[i - 1]) + here[i + 1] + above[i] + below[i];
            const Int off = 4 * Int(here[i]) - around;
            in_row += (off <= 4 * bound ? 1 : 0) & (off >= -4 * bound ? 1 : 0);
        }
        foretold += static_cast<size_t>(in_row);
    }
    return foretold;
}

/// The share of pixels that follow from their neighbours.
double share_foretold(const std::vector<int32_t>& integers, int width, int64_t bound) {
    const auto w = static_cast<size_t>(width);
    const size_t rows = integers.size() / w;
    if (w < 3 || rows < 3) return 0;
    const auto [least, most] = std::minmax_element(integers.begin(), integers.end());
    const int64_t largest = std::max({int64_t(*most), -int64_t(*least), bound});
    const size_t foretold = largest < (1 << 27)
                                ? count_foretold(integers, w, static_cast<int32_t>(bound))
                                : count_foretold(integers, w, bound);
    return static_cast<double>(foretold) / static_cast<double>((rows - 1) / 2 * (w - 2));
}

/// Bounds of a smooth map: that of the finest level as a share of what is allowed, and those of the
/// levels before it, each a share of the next.
struct Tightness {
    double finest = 1, coarser = 1;
};
/// The share of a prequantiser's RMS error that smooth maps may have.
constexpr double kThreeDecibels = 0.71;

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

    Result<Trial> encode(double error) {
        choose_scale(error);
        return encode_within(kTightness[0]);
    }

    /// The same, with errors that are 3 dB below a prequantiser's where the map is smooth.
    Result<Trial> encode_well(double error) {
        choose_scale(error);
        Result<Trial> trial;
        std::optional<Bounds> last;  ///< of the trial
        double rms_prequantised = 0;
        for (const Tightness& by : kTightness) {
            if (last && *last == tightened(allowed_, head_.stream_levels, by)) continue;
            trial = encode_within(by);
            last = head_.bounds;
            if (!trial || last->coarser.empty()) break;
            if (rms_prequantised == 0) rms_prequantised = prequantised();
            if (trial->file.report.rms_error <= kThreeDecibels * rms_prequantised) break;
        }
        return trial;
    }

  private:
    /// With the scale as it is.
    Result<Trial> encode_within(const Tightness& by) {
        Trial trial;
        trial.integers = integers_of(source_.map(), head_.scale);
        const Decomposition<float>& d = head_.fog.decomposition;
        // Where most pixels follow from their neighbours, exact neighbours are worth their bits.
        head_.bounds = {.finest = allowed_};
        if (allowed_ > 1 && share_foretold(trial.integers, d.width, allowed_) > 0.95)
            head_.bounds = tightened(allowed_, head_.stream_levels, by);
        PlaneStreams streams;
        if (!encode_plane(trial.integers, coding_of(head_, d.width, d.height, head_.stream_levels),
                          options_.best, options_.threads, options_.stop, streams))
            return cancelled();
        trial.map = densities_of(trial.integers, head_.scale, d.width, d.height);
        const Errors made = compare(source_.map(), trial.map);
        head_.max_error = static_cast<float>(made.most);
        std::vector<Bytes> chunks;
        for (std::vector<Bytes>& level : streams) chunks.push_back(join(level));
        trial.head = head_;
        trial.file.bytes = write_chunks(head_, chunks);
        trial.file.report.max_error = made.most;
        trial.file.report.rms_error = made.rms;
        trial.negative = made.negative;
        return trial;
    }

    /// RMS error of every integer moved to the nearest of those that are 2 allowed_ + 1 apart.
    double prequantised() const {
        const std::vector<int32_t> integers = integers_of(source_.map(), head_.scale);
        const int64_t low = *std::min_element(integers.begin(), integers.end());
        double squares = 0;
        for (const int32_t k : integers) {
            const auto off =
                static_cast<double>((k - low + allowed_) % (2 * allowed_ + 1) - allowed_);
            squares += off * off;
        }
        return std::sqrt(squares / static_cast<double>(integers.size())) *
               double(head_.scale.density(1));
    }

    void choose_scale(double error) {
        allowed_ = 0;
        const bool by_rays = options_.promise == WfogOptions::Promise::max_transmittance_error;
        if (source_.ratio && !(by_rays && wants_finer_steps(error * source_.ratio->divisor))) {
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
        if (usable <= 0 || most / step > double(1 << 29)) {
            head_.scale = exact_scale(source_.map());
            return;
        }
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
};

/// A file of the coefficients themselves: for fogs that no map of floats gives bit for bit.
Result<EncodedFog> encode_coefficients(const Fog& fog, const WfogOptions& options) {
    Head head = head_of(fog);
    head.content = Content::coefficients;
    head.scale.kind = Scale::Kind::float_bits;
    std::vector<Bytes> chunks;
    Decomposition<float> d = fog.decomposition;
    for (const auto& level : bands_of(d)) {
        Writer chunk;
        for (const Band<float>* band : level) {
            if (band->values.size() == 0) continue;
            std::vector<int32_t> integers = integers_of(band->values, head.scale);
            PlaneStreams streams;
            const PlaneCoding coding =
                coding_of(head, band->width(), band->height(), band_levels(*band, head.tile_bits));
            if (!encode_plane(integers, coding, options.best, options.threads, options.stop,
                              streams))
                return cancelled();
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

/// The largest error whose rays still keep the promise. What guarantees the same pixel by pixel,
/// E / (extinction * path), is where the search starts; it ends where no larger error is worth it.
Result<Trial> fit_rays(PixelEncoder& encoder, const Fog& fog, const Source& source,
                       const WfogOptions& options, double scale) {
    constexpr int kFewAngles = 12, kAngles = 64;
    const auto ray_error = [&](const Trial& trial, int angles) {
        return worst_ray_error(fog, source.map(), trial.map - source.map(), options.path, angles);
    };
    const double sure = options.error / std::max(fog.extinction * options.path, 1e-300);
    double low = std::log(sure), high = std::log(std::max(scale, sure));
    auto best = encoder.encode(std::min(sure, scale));
    if (!best) return best;
    for (int i = 0; i < 10 && high - low > 0.02; ++i) {
        // White errors add up like the root of the cells: the answer is nearer to the low end.
        const double middle = low + (high - low) * (i == 0 ? 0.4 : 0.5);
        auto trial = encoder.encode(std::exp(middle));
        if (!trial) return trial;
        if (ray_error(*trial, kFewAngles) <= options.error &&
            ray_error(*trial, kAngles) <= options.error) {
            low = middle;
            if (trial->file.bytes.size() <= best->file.bytes.size()) best = std::move(trial);
        } else {
            high = middle;
        }
    }
    return best;
}

tl::unexpected<Error> broken_promise() {
    return data_error("the encoded bytes do not keep the promise; this is a bug, please report it");
}

/// Every pixel of the decoded bytes is what the encoder measured, and keeps the promise.
Result<void> verify(const Trial& trial, const Source& source, double allowed,
                    const WfogOptions& options) {
    const auto chunks = read_chunks(trial.file.bytes, false);
    if (!chunks) return tl::unexpected(chunks.error());
    WfogLimits limits;
    limits.threads = options.threads;
    limits.stop = options.stop;
    const auto decoded = decode_integers(*chunks, limits, chunks->expected());
    if (!decoded) return tl::unexpected(decoded.error());
    // k / 255 and k' / 255 are floats, each off by half of its last bit.
    const double rounding = allowed > 0 ? double(source.map().abs().maxCoeff()) * 0x1p-23 : 0;
    if (*decoded != trial.integers || chunks->head.scale != trial.head.scale ||
        trial.file.report.max_error > allowed + rounding || (allowed > 0 && trial.negative))
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
            break;
        case Promise::bytes:
            trial = fit_bytes(encoder, std::max(scale, 1e-30), options.bytes);
            break;
        case Promise::max_transmittance_error:
            trial = fit_rays(encoder, fog, source, options, std::max(scale, 1e-30));
            break;
    }
    if (!trial) return tl::unexpected(trial.error());
    if (auto ok = verify(*trial, source, allowed, options); !ok) return tl::unexpected(ok.error());
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
