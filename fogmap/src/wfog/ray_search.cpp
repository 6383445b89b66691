#include "ray_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "ray_errors.h"

namespace wavefog::wfog {

using std::size_t;

namespace {

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
        double next = std::lerp(all.low, all.high, 0.4);
        for (const double coarser : kCoarser) {
            const auto found = search(all, next, coarser, *best);
            if (!found) return tl::unexpected(found.error());
            next = *found;
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
    /// Bounds at coarse levels. Errors there are those that rays add up: with tight ones, calm maps
    /// (nebula, fogridge, fogphoto) take a tenth to a quarter fewer bits, others up to 5 % more.
    static constexpr double kCoarser[] = {1, 0.7};

    /// Of a cell, by which lines are told apart: what bounds long ones misses by more.
    static int parts_of(const Fog& fog, Eigen::Index pixels, double path) {
        const double cells = path / std::min(fog.cell_x(), fog.cell_z());
        if (pixels > 1 << 25) return 1;
        return pixels >= 1 << 20 || cells <= 128 ? 2 : 4;
    }

    /// Of an encoding, see PixelEncoder.
    struct Steps {
        double coarseness, coarser;
    };

    /// `best` gets the smallest file. Returns the largest error that is proved with the same steps
    /// for dense fog as for thin.
    Result<double> search(const Range& all, double next, double coarser, Trial& best) {
        const auto rough = widen(all, next, {1, coarser}, 1, kRough, best);
        if (!rough) return rough;
        const auto found = widen({.low = *rough, .high = all.high}, *rough + kRough, {1, coarser},
                                 parts_, kFine, best);
        if (!found) return found;
        // One may fail where the next succeeds: whether errors add up is chance, too.
        int failures = 0;
        for (double coarseness = kMoreCoarse; coarseness <= kMostCoarse && failures < 2;
             coarseness *= kMoreCoarse) {
            // Below the lowest error, coarser steps save less than they cost.
            const double saved = std::log(2.0) * encoder_.saving(std::exp(*found), coarseness);
            if (saved < kFine) break;
            const size_t bytes = best.file.bytes.size();
            const auto other =
                widen({.low = *found - saved, .high = *found + kRough}, *found - saved / 2,
                      {coarseness, coarser}, parts_, kFine, best);
            if (!other) return other;
            if (best.file.bytes.size() == bytes) ++failures;
        }
        return found;
    }

    /// The largest error in the range that is proved by so many parts of a cell, about; `best` gets
    /// the smallest file that keeps the promise.
    Result<double> widen(Range range, double next, const Steps& steps, int parts, double width,
                         Trial& best) {
        next = std::clamp(next, range.low, range.high);
        for (int i = 0; i < 8 && range.high - range.low > width; ++i) {
            auto trial = encoder_.encode(std::exp(next), steps.coarseness, steps.coarser);
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

}  // namespace

Result<Trial> search_rays(PixelEncoder& encoder, const Fog& fog, const Source& source,
                          const WfogOptions& options, double scale) {
    return RaySearch(encoder, fog, source, options).run(scale);
}

}  // namespace wavefog::wfog
