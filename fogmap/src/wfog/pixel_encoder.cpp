#include "pixel_encoder.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "decoder.h"
#include "map_encoder.h"
#include "smoothness.h"

namespace wavefog::wfog {

using std::int64_t;
using std::size_t;

namespace {

/// Lossy floats become integers of a 31st of the promised interval, so that the predictor works
/// below the bound.
constexpr int64_t kStepsOfBound = 15;

/// Whether pictures in whole steps get finer ones. Rays do not care whether pixels are off by whole
/// steps, and a file that shall have so many bytes needs sizes between those of two.
bool wants_finer_steps(double steps, WfogOptions::Promise promise) {
    constexpr double kMostSteps = 16;
    if (steps >= kMostSteps) return false;
    return promise == WfogOptions::Promise::bytes ||
           (promise == WfogOptions::Promise::max_transmittance_error &&
            steps - std::floor(steps) > 0.5);
}

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

Bytes join(const std::vector<Bytes>& tiles) {
    if (tiles.size() == 1) return tiles[0];
    Writer w;
    for (const Bytes& tile : tiles) w.length(tile.size());
    for (const Bytes& tile : tiles) w.append(tile);
    return std::move(w.bytes);
}

}  // namespace

Result<Trial> smaller_of(Result<Trial> a, Result<Trial> b) {
    const bool second = a && (!b || b->file.bytes.size() < a->file.bytes.size());
    return std::move(second ? b : a);
}

PixelEncoder::PixelEncoder(const Fog& fog, const Source& source, const WfogOptions& options)
    : source_(source), options_(options), head_(head_of(fog)) {
    const Decomposition<float>& d = fog.decomposition;
    head_.stream_levels = default_stream_levels(d.width, d.height, head_.tile_bits);
}

Result<Trial> PixelEncoder::encode(double error) {
    choose_scale(error);
    return encode_within(bounds_by(kTightness[0]));
}

Result<Trial> PixelEncoder::encode(double error, double coarseness, double coarser) {
    find_scale(error, coarseness);
    if (coarser == 1) return encode_within({.finest = allowed_});
    return encode_within(tightened(allowed_, head_.stream_levels, {1, coarser}));
}

double PixelEncoder::saving(double error, double coarseness) {
    find_scale(error, coarseness);
    return head_.scale.kind == Scale::Kind::companded ? mean_coarseness(head_.scale, source_.map())
                                                      : 0;
}

Result<Trial> PixelEncoder::encode_well(double error) {
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
    double enough = kThreeDecibels * prequantised_rms(source_.map(), head_.scale, allowed_, true);
    const auto unsure = [&](double rms) { return std::fabs(rms / enough - 1) < kUnsure; };
    const auto suffices = [&](double rms) {
        if (rough && unsure(rms)) {
            rough = false;
            enough = kThreeDecibels * prequantised_rms(source_.map(), head_.scale, allowed_, false);
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

/// Where most pixels follow from their neighbours, exact neighbours are worth their bits.
Bounds PixelEncoder::bounds_by(const Tightness& by) const {
    if (smooth_) return tightened(allowed_, head_.stream_levels, by);
    return {.finest = allowed_};
}

PlaneCoding PixelEncoder::coding() const {
    const Decomposition<float>& d = head_.fog.decomposition;
    return coding_of(head_, d.width, d.height, head_.stream_levels);
}

std::optional<double> PixelEncoder::rms_of(const Bounds& bounds, Strips strips) {
    head_.bounds = bounds;
    const auto square = squared_error_of(coding(), strips, options_.threads, options_.stop,
                                         tiles_of(source_.map(), head_.scale));
    if (!square) return {};
    return std::sqrt(*square) * double(head_.scale.density(1));
}

/// With the scale as it is.
Result<Trial> PixelEncoder::encode_within(const Bounds& bounds) {
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
bool PixelEncoder::holds(const Bytes& bytes, const PlaneStreams& streams) const {
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

void PixelEncoder::choose_scale(double error) {
    find_scale(error, 1);
    smooth_ = allowed_ > 1 && mostly_foretold(source_.map(), head_.scale, allowed_, 0.95);
}

void PixelEncoder::find_scale(double error, double coarseness) {
    allowed_ = 0;
    if (source_.ratio && coarseness == 1 && error >= source_.slack) {
        const double steps = (error - source_.slack) * source_.ratio->divisor;
        if (error == 0 || !wants_finer_steps(steps, options_.promise)) {
            head_.scale = *source_.ratio;
            // The last bits of a double must not cost a whole step.
            allowed_ = static_cast<int64_t>(std::min(steps * (1 + 1e-12), double(1 << 29)));
            return;
        }
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

}  // namespace wavefog::wfog
