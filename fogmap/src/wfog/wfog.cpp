#include "wavefog/fogmap/wfog.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <istream>
#include <iterator>
#include <limits>
#include <new>
#include <optional>
#include <ostream>

#include "bands.h"
#include "format.h"
#include "plane.h"
#include "ray_errors.h"

namespace wavefog {

using namespace wfog;

namespace {

using std::int32_t;
using std::int64_t;
using std::size_t;

/// A reconstruction is off by up to 16 * 2^-24 of the maximum (decomposition.h).
constexpr double kRounding = 2e-6;
/// Lossy floats become integers of a 31st of the promised interval, so that the predictor works
/// below the bound.
constexpr int64_t kStepsOfBound = 15;

tl::unexpected<Error> cancelled() {
    return data_error("cancelled; nothing was written");
}

Result<Decomposition<float>> decompose_as(const Grid<float>& map, const Decomposition<float>& like,
                                          int levels) {
    return decompose(map, like.family, levels, like.form, like.boundary);
}

/// The map that gives exactly the fog's coefficients, if one is found.
bool gives(const Grid<float>& map, const Fog& fog) {
    const auto again = decompose_as(map, fog.decomposition, fog.decomposition.levels());
    return again && same_coefficients(*again, fog.decomposition);
}

/// The fog's pixels and, if they are multiples of a common fraction, which.
struct Source {
    Grid<float> map;
    std::optional<Scale> ratio;
    bool exact = true;  ///< decomposing the map gives the fog's own bits
};

Source source_of(const Fog& fog, const Grid<float>* map) {
    Source source;
    source.map = map ? *map : reconstruct(fog.decomposition);
    source.ratio = ratio_of(source.map, 0);
    source.exact = gives(source.map, fog);
    if (source.ratio || (map && source.exact)) return source;
    // Rounding may hide the steps of an integer picture.
    if (const auto ratio = ratio_of(source.map, kRounding)) {
        Source snapped;
        snapped.ratio = ratio;
        snapped.map = source.map.unaryExpr(
            [&](float value) { return ratio->density(*ratio->integer(value)); });
        snapped.exact = gives(snapped.map, fog);
        if (snapped.exact || !source.exact) return snapped;
    }
    return source;
}

std::vector<int32_t> integers_of(const Grid<float>& map, const Scale& scale) {
    std::vector<int32_t> integers(static_cast<size_t>(map.size()));
    std::transform(map.data(), map.data() + map.size(), integers.begin(),
                   [&](float value) { return *scale.integer(value); });
    return integers;
}

Grid<float> densities_of(const std::vector<int32_t>& integers, const Scale& scale, int width,
                         int height) {
    Grid<float> map(height, width);
    std::transform(integers.begin(), integers.end(), map.data(),
                   [&](int32_t k) { return scale.density(k); });
    return map;
}

struct Errors {
    double most = 0, rms = 0;
    bool negative = false;  ///< somewhere below 0 where the original is not
};

Errors compare(const Grid<float>& original, const Grid<float>& decoded) {
    Errors errors;
    double squares = 0;
    for (Eigen::Index i = 0; i < original.size(); ++i) {
        const double a = double(original.data()[i]), b = double(decoded.data()[i]);
        errors.most = std::max(errors.most, std::fabs(a - b));
        squares += (a - b) * (a - b);
        errors.negative = errors.negative || (a >= 0 && b < 0);
    }
    errors.rms = std::sqrt(squares / static_cast<double>(original.size()));
    return errors;
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

PlaneCoding coding_of(const Head& head, int width, int height, int levels) {
    return {width, height, head.tile_bits, levels, head.bound};
}

/// One file from a fog's pixels, with at most `error` (in densities; 0: none) at any pixel.
class PixelEncoder {
  public:
    PixelEncoder(const Fog& fog, const Source& source, const WfogOptions& options)
        : source_(source), options_(options), head_(head_of(fog)) {
        const Decomposition<float>& d = fog.decomposition;
        head_.stream_levels = default_stream_levels(d.width, d.height, head_.tile_bits);
    }

    Result<EncodedFog> encode(double error) {
        choose_scale(error);
        std::vector<int32_t> integers = integers_of(source_.map, head_.scale);
        const Decomposition<float>& d = head_.fog.decomposition;
        PlaneStreams streams;
        if (!encode_plane(integers, coding_of(head_, d.width, d.height, head_.stream_levels),
                          options_.best, options_.threads, options_.stop, streams))
            return cancelled();
        const Errors made =
            compare(source_.map, densities_of(integers, head_.scale, d.width, d.height));
        head_.max_error = static_cast<float>(made.most);
        std::vector<Bytes> chunks;
        for (std::vector<Bytes>& level : streams) chunks.push_back(join(level));
        EncodedFog encoded;
        encoded.bytes = write_chunks(head_, chunks);
        encoded.report.max_error = made.most;
        encoded.report.rms_error = made.rms;
        return encoded;
    }

  private:
    void choose_scale(double error) {
        head_.bound = 0;
        if (source_.ratio) {
            head_.scale = *source_.ratio;
            // The last bits of a double must not cost a whole step.
            head_.bound = static_cast<int64_t>(
                std::min(error * head_.scale.divisor * (1 + 1e-12), double(1 << 29)));
            return;
        }
        const double most = double(source_.map.abs().maxCoeff());
        // Float rounding of the decoded density comes on top.
        const double usable = error - most * 1.2e-7;
        const double step = usable / (double(kStepsOfBound) + 0.5);
        if (usable <= 0 || most / step > double(1 << 29)) {
            head_.scale = exact_scale(source_.map);
            return;
        }
        head_.scale = {Scale::Kind::step, 1, step};
        head_.bound = kStepsOfBound;
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
Result<EncodedFog> fit_bytes(PixelEncoder& encoder, double scale, size_t bytes) {
    auto lossless = encoder.encode(0);
    if (!lossless || lossless->bytes.size() <= bytes) return lossless;
    double fits = std::log(scale), too_large = std::log(scale * 1e-6);
    auto best = encoder.encode(scale);
    if (!best) return best;
    if (best->bytes.size() > bytes)
        return data_error(fmt::format("cannot be as small as {} bytes; {} are the least here",
                                      bytes, best->bytes.size()));
    for (int i = 0; i < 12; ++i) {
        const double middle = (fits + too_large) / 2;
        auto trial = encoder.encode(std::exp(middle));
        if (!trial) return trial;
        if (trial->bytes.size() <= bytes) {
            fits = middle;
            if (trial->report.rms_error <= best->report.rms_error) best = std::move(trial);
        } else {
            too_large = middle;
        }
    }
    return best;
}

/// The largest error whose rays still keep the promise. What guarantees the same pixel by pixel,
/// E / (extinction * path), is where the search starts; it ends where no larger error is worth it.
Result<EncodedFog> fit_rays(PixelEncoder& encoder, const Fog& fog, const Source& source,
                            const WfogOptions& options, double scale) {
    constexpr int kFewAngles = 24, kAngles = 128;
    const auto ray_error = [&](const EncodedFog& encoded, int angles) -> Result<double> {
        WfogLimits limits;
        limits.max_map_bytes = std::numeric_limits<size_t>::max();
        limits.threads = options.threads;
        limits.stop = options.stop;
        const auto decoded = decode_wfog(encoded.bytes, limits);
        if (!decoded) return tl::unexpected(decoded.error());
        return worst_ray_error(fog, decoded->map - source.map, options.path, angles);
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
        auto worst = ray_error(*trial, kFewAngles);
        if (worst && *worst <= options.error) worst = ray_error(*trial, kAngles);
        if (!worst) return tl::unexpected(worst.error());
        if (*worst <= options.error) {
            low = middle;
            if (trial->bytes.size() <= best->bytes.size()) best = std::move(trial);
        } else {
            high = middle;
        }
    }
    return best;
}

/// Decodes the bytes and holds them against the promise; fills in the report.
Result<void> verify(const Fog& fog, const Source& source, double allowed,
                    const WfogOptions& options, double scale, EncodedFog& encoded) {
    WfogLimits limits;
    limits.max_map_bytes = std::numeric_limits<size_t>::max();
    limits.threads = options.threads;
    limits.stop = options.stop;
    const auto decoded = decode_wfog(encoded.bytes, limits);
    if (!decoded) return tl::unexpected(decoded.error());
    const Errors errors = compare(source.map, decoded->map);
    WfogReport& report = encoded.report;
    report.bytes = encoded.bytes.size();
    const auto pixels = static_cast<double>(source.map.size());
    report.bits_per_pixel = 8 * static_cast<double>(report.bytes) / pixels;
    report.ratio = pixels * sizeof(float) / static_cast<double>(report.bytes);
    report.full_scale = scale;
    report.max_error = errors.most;
    report.rms_error = errors.rms;
    // k / 255 and k' / 255 are floats, each off by half of its last bit.
    const double rounding = double(source.map.abs().maxCoeff()) * 0x1p-23;
    const bool kept = allowed > 0
                          ? errors.most <= allowed + rounding
                          : same_coefficients(decoded->fog.decomposition, fog.decomposition);
    if (!kept || (allowed > 0 && errors.negative))
        return data_error(
            "the encoded bytes do not keep the promise; this is a bug, please report it");
    return {};
}

Result<EncodedFog> encode(const Fog& fog, const WfogOptions& options, const Grid<float>* map) {
    using Promise = WfogOptions::Promise;
    if (auto ok = check_options(options); !ok) return tl::unexpected(ok.error());
    if (auto ok = fog.validate(); !ok) return tl::unexpected(ok.error());
    const Decomposition<float>& d = fog.decomposition;
    if (d.width > kMaxWfogSide || d.height > kMaxWfogSide)
        return data_error(fmt::format("{} x {} pixels; a side of at most {} fits into a .wfog file",
                                      d.width, d.height, kMaxWfogSide));
    const Source source = source_of(fog, map);
    const double scale = full_scale(source.map, source.ratio);
    PixelEncoder encoder(fog, source, options);

    Result<EncodedFog> encoded;
    double allowed = 0;
    switch (options.promise) {
        case Promise::lossless:
            encoded = source.exact ? encoder.encode(0) : encode_coefficients(fog, options);
            break;
        case Promise::max_error:
            allowed = options.error * scale;
            encoded = encoder.encode(allowed);
            break;
        case Promise::bytes:
            encoded = fit_bytes(encoder, std::max(scale, 1e-30), options.bytes);
            allowed = std::numeric_limits<double>::infinity();
            break;
        case Promise::max_transmittance_error:
            encoded = fit_rays(encoder, fog, source, options, std::max(scale, 1e-30));
            allowed = std::numeric_limits<double>::infinity();
            break;
    }
    if (!encoded) return encoded;
    if (auto ok = verify(fog, source, allowed, options, scale, *encoded); !ok)
        return tl::unexpected(ok.error());
    return encoded;
}

// --- Decoding

/// The tiles of a level's chunk.
bool split(View chunk, size_t tiles, std::vector<View>& parts) {
    if (tiles == 1) {
        parts.push_back(chunk);
        return true;
    }
    Reader r(chunk);
    if (tiles > chunk.size()) return false;
    std::vector<std::uint64_t> sizes(tiles);
    for (std::uint64_t& size : sizes) size = r.length();
    for (const std::uint64_t size : sizes) parts.push_back(r.take(size));
    return !r.failed() && r.left() == 0;
}

tl::unexpected<Error> damaged_stream() {
    return data_error("damaged: a stream is impossible; get the file again");
}

Result<void> decode_pixels(const Chunks& chunks, const WfogLimits& limits, DecodedFog& out) {
    const Head& head = chunks.head;
    Decomposition<float>& d = out.fog.decomposition;
    const PlaneCoding coding = coding_of(head, d.width, d.height, head.stream_levels);
    PlaneViews streams;
    for (int level = 0; level < out.levels; ++level) {
        streams.emplace_back();
        if (!split(chunks.streams[size_t(level)], coding.tiles(), streams.back()))
            return damaged_stream();
    }
    std::vector<int32_t> integers(size_t(d.width) * size_t(d.height));
    switch (decode_plane(streams, coding, limits.threads, limits.stop, integers)) {
        case PlaneResult::damaged:
            return damaged_stream();
        case PlaneResult::stopped:
            return cancelled();
        case PlaneResult::done:
            break;
    }
    out.map = densities_of(integers, head.scale, d.width, d.height);
    if (!out.map.allFinite()) return damaged_stream();
    auto decomposed = decompose_as(out.map, d, head.levels);
    if (!decomposed) return tl::unexpected(decomposed.error());
    d = std::move(*decomposed);
    return {};
}

Result<void> decode_coefficients(const Chunks& chunks, const WfogLimits& limits, DecodedFog& out) {
    const Head& head = chunks.head;
    Decomposition<float>& d = out.fog.decomposition;
    // The bands of an empty map lie where those of the file do.
    auto empty = decompose_as(Grid<float>(Grid<float>::Zero(d.height, d.width)), d, head.levels);
    if (!empty) return tl::unexpected(empty.error());
    d = std::move(*empty);
    if (d.levels() != head.levels) return damaged_stream();
    const auto bands = bands_of(d);
    for (size_t level = 0; level < size_t(out.levels); ++level) {
        Reader r(chunks.streams[level]);
        for (Band<float>* band : bands[level]) {
            if (band->values.size() == 0) continue;
            const PlaneCoding coding =
                coding_of(head, band->width(), band->height(), band_levels(*band, head.tile_bits));
            PlaneViews streams(size_t(coding.levels) + 1);
            for (std::vector<View>& stream : streams)
                for (size_t tile = 0; tile < coding.tiles(); ++tile)
                    stream.push_back(r.take(r.length()));
            if (r.failed()) return damaged_stream();
            std::vector<int32_t> integers(static_cast<size_t>(band->values.size()));
            const PlaneResult result =
                decode_plane(streams, coding, limits.threads, limits.stop, integers);
            if (result == PlaneResult::stopped) return cancelled();
            if (result == PlaneResult::damaged) return damaged_stream();
            band->values = densities_of(integers, head.scale, band->width(), band->height());
        }
        if (r.left() != 0) return damaged_stream();
    }
    out.map = reconstruct(d);
    if (!out.map.allFinite()) return damaged_stream();
    return {};
}

Result<DecodedFog> decode(View bytes, const WfogLimits& limits) {
    auto chunks = read_chunks(bytes, limits.partial);
    if (!chunks) return tl::unexpected(chunks.error());
    const Head& head = chunks->head;
    const Decomposition<float>& d = head.fog.decomposition;
    const double needed = double(d.width) * double(d.height) * double(sizeof(float));
    if (needed > static_cast<double>(limits.max_map_bytes))
        return data_error(fmt::format(
            "{} x {} pixels need {:.0f} MiB, above the limit of {:.0f} MiB; raise the limit if you "
            "trust the file",
            d.width, d.height, needed / (1 << 20),
            static_cast<double>(limits.max_map_bytes) / (1 << 20)));
    DecodedFog out;
    out.fog = head.fog;
    out.of_levels = chunks->expected();
    out.levels = std::min(
        {std::max(limits.levels, 1), chunks->expected(), static_cast<int>(chunks->streams.size())});
    out.max_error = double(head.max_error);
    const auto done = head.content == Content::pixels ? decode_pixels(*chunks, limits, out)
                                                      : decode_coefficients(*chunks, limits, out);
    if (!done) return tl::unexpected(done.error());
    if (auto ok = out.fog.validate(); !ok) return tl::unexpected(ok.error());
    return out;
}

template <class Function>
auto guarded(Function function) -> decltype(function()) {
    try {
        return function();
    } catch (const std::bad_alloc&) {
        return data_error("not enough memory; use a smaller map");
    } catch (const std::exception& error) {
        return data_error(fmt::format("cannot be used ({})", error.what()));
    }
}

}  // namespace

Result<EncodedFog> encode_wfog(const Fog& fog, const WfogOptions& options, const Grid<float>* map) {
    return guarded([&] { return encode(fog, options, map); });
}

Result<DecodedFog> decode_wfog(std::span<const std::uint8_t> bytes, const WfogLimits& limits) {
    return guarded([&] { return decode(bytes, limits); });
}

Result<DecodedFog> decode_wfog(std::istream& stream, const WfogLimits& limits) {
    return guarded([&]() -> Result<DecodedFog> {
        const std::vector<char> read{std::istreambuf_iterator<char>(stream), {}};
        if (stream.bad()) return data_error("cannot be read");
        return decode({reinterpret_cast<const std::uint8_t*>(read.data()), read.size()}, limits);
    });
}

Result<WfogReport> encode_wfog(std::ostream& stream, const Fog& fog, const WfogOptions& options,
                               const Grid<float>* map) {
    const auto encoded = encode_wfog(fog, options, map);
    if (!encoded) return tl::unexpected(encoded.error());
    stream.write(reinterpret_cast<const char*>(encoded->bytes.data()),
                 static_cast<std::streamsize>(encoded->bytes.size()));
    if (!stream) return data_error("cannot be written; is the disk full?");
    return encoded->report;
}

}  // namespace wavefog
