#include "encoder.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "bands.h"
#include "decoder.h"
#include "format.h"
#include "map_encoder.h"
#include "pixel_encoder.h"
#include "plane.h"
#include "ray_search.h"
#include "source.h"

namespace wavefog::wfog {

namespace {

using std::size_t;

/// Maps of so many pixels are tried without loss too.
constexpr Eigen::Index kSmallMap = 128 * 128;

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

/// The best file that fits: looks for the smallest error by halving the range of its logarithm.
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
        const bool fit = trial->file.bytes.size() <= bytes;
        (fit ? fits : too_large) = middle;
        if (fit && trial->file.report.rms_error < best->file.report.rms_error)
            best = std::move(trial);
    }
    return best;
}

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
            trial = search_rays(encoder, fog, source, options, std::max(scale, 1e-30));
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
