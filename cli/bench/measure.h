// Measures groups of methods that take turns frame by frame.
#pragma once

#include <chrono>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/accuracy.h"
#include "bench/results.h"
#include "bench/variant.h"
#include "options.h"
#include "wavefog/gpu/context.h"
#include "wavefog/gpu/fog_pass.h"

namespace wavefog::cli {

/// One method on one variant of the group's scene.
struct Case {
    std::size_t variant = 0;
    Method method;
    bool reuse = false;  ///< the method keeps its tables from frame to frame
};

/// Cases that share a scene, a camera and a picture size: their times compare. `homogeneous` is
/// always among them: in a scene without maps as constant fog in place of the scene's own.
struct Group {
    std::string name;
    std::size_t scene = 0;
    Size size;
    std::vector<std::shared_ptr<const Variant>> variants;
    std::vector<Case> cases;
    int stride = 1;  ///< errors are measured in every stride-th pixel of every stride-th row
    bool pixel_means = false;  ///< errors against the means over pixels too
};

struct MeasureOptions {
    std::optional<int> frames;      ///< of each case; empty: kFrames, fewer where a frame is slow
    std::optional<double> seconds;  ///< the whole run's time
    bool reuse = false;             ///< all cases keep their tables from frame to frame
};

inline constexpr int kFrames = 40;

/// Runs groups one after the other. Rows come in the order of the cases, with `homogeneous` first.
/// A case that FogPass refuses is told in Results::skipped, one that the time does not allow in
/// Results::cut, and its row has no figures.
class Measurement {
  public:
    Measurement(Context& context, const std::vector<BenchScene>& scenes,
                const MeasureOptions& options);

    /// Appends rows, cuts and skips to `results`.
    Result<void> run(const std::vector<Group>& groups, Results& results);

  private:
    struct Stage;
    struct Contender;

    /// What cases of a variant share, kept for the next group if that has the variant too.
    struct Prepared {
        std::shared_ptr<const Variant> variant;
        std::vector<FogTextures> textures;
        std::deque<FogBounds> bounds;
    };

    Result<void> run_group(const Group& group, double seconds, Results& results);
    Result<const Truth*> truth(const Group& group, const Variant& variant, const Stage& stage);
    Row empty_row(const Group& group, const Case& one) const;
    /// Lets go of what `group` does not have.
    void prepare(const Group& group);
    Result<FogPass> make_pass(const Group& group, const Case& one, const SceneRenderer& renderer);
    void estimate(std::vector<Contender>& contenders, const Stage& stage,
                  const Camera& camera) const;
    void plan_frames(std::vector<Contender>& contenders, double seconds, Results& results) const;
    void take_turns(const Group& group, std::vector<Contender>& contenders, const Stage& stage,
                    double seconds);
    void fill_times(Contender& contender, std::optional<double>& homogeneous_ms) const;
    void fill_accuracy(Contender& contender, const Truth& truth, const Stage& stage,
                       const Scene& scene) const;
    double remaining_seconds() const;
    void show_progress(const std::string& doing) const;

    Context& context_;
    const std::vector<BenchScene>& scenes_;
    MeasureOptions options_;
    std::chrono::steady_clock::time_point start_;
    std::map<std::string, Truth> truths_;
    std::vector<std::unique_ptr<Prepared>> prepared_;  ///< as the group's variants
    std::optional<FogTextures> constant_fog_;          ///< `homogeneous` in scenes without maps
    double done_ = 0, group_share_ = 0;                ///< of the groups, for the progress line
};

/// "homogeneous" among the methods, needed by every group.
Method homogeneous_method();

}  // namespace wavefog::cli
