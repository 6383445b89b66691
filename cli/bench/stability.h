// Where methods fail: figures from the wavelet library, the reference and the fog pass. All maps
// are made up here, from fixed seeds.
#pragma once

#include <random>
#include <vector>

#include "bench/results.h"
#include "wavefog/fogmap/fog.h"
#include "wavefog/gpu/context.h"

namespace wavefog::cli {

/// All of the figures below. A study that fails is told in Results::skipped, the others go on.
Result<void> study_stability(Context& context, Results& results);

/// Condition number of the transform, and error of coefficients stored in 8 bits, against levels.
std::vector<Figure> study_transforms();

/// Lowest density and largest error of T when the finest levels are dropped, with and without the
/// clamp of steps, and with the positive family.
Result<std::vector<Figure>> study_dropped_levels();

/// Error of path-integral tables against their size, for both layouts.
Result<Figure> study_tables();

/// march:N against N for coarse and fine maps, and what its error looks like across a picture.
Result<std::vector<Figure>> study_march();

/// Error against the distance of the world's origin: naive float32 and re-based coordinates.
Result<Figure> study_world_offset();

/// Error of froxels, march and exact for a bank of fog against its thickness.
Result<Figure> study_thin_bank(Context& context);

/// Error of separable fog as published, against the length of rays.
Figure study_separable();

// What the studies share.

/// Equal on every platform, unlike std::uniform_real_distribution.
class Random {
  public:
    explicit Random(unsigned seed) : engine_(seed) {}
    double uniform(double low, double high) {
        return low + (high - low) * double(engine_()) / 4294967296.0;
    }

  private:
    std::mt19937 engine_;
};

/// Discs with sharp edges: about a third of the map is 1, the rest 0.
Grid<float> hard_edged_map(int size);

/// A fog of this map over `metres` x `metres` around the origin, uniform in height.
Result<Fog> study_fog(const Grid<float>& map, const FogOptions& options, double metres,
                      double extinction);

struct Segment {
    Eigen::Vector3d o, p;
};
/// Random segments in a square of `metres` x `metres` around the origin, 1 to 3 m above y = 0; the
/// first quarter runs nearly along x, where dropped details do most harm.
std::vector<Segment> random_segments(int count, double metres, unsigned seed);

}  // namespace wavefog::cli
