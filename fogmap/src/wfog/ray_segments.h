// The segments of lines through a map, and what rays can make of their errors.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace wavefog::wfog {

/// By length and optical depth of a segment, how far the map's error can add up along it.
class RaySegments {
  public:
    /// Segments of up to `most` samples of a line. `depth_of_sum`: the optical depth of a sample
    /// whose density is 1.
    RaySegments(std::size_t most, double depth_of_sum);

    /// Running sums along a line: of the error, and of the density.
    void add_line(const std::vector<double>& sums, const std::vector<double>& density);

    /// The lines that `other` of the same form has.
    void add(const RaySegments& other);

    /// After all lines: longer segments, up to so many samples, as several of those there are.
    void extend(double most);

    /// The largest |dT| <= exp(-tau) (exp(|dtau|) - 1) of a ray whose optical depth and its error
    /// are means of those of segments with common weights: of segments of up to `longest` samples
    /// that are `mean` samples long on average. Error and density are `stretch` times those of the
    /// lines; the error `reserve` times more.
    double worst_change(double longest, double mean, double stretch, double reserve) const;

  private:
    static constexpr std::size_t kDepths = 193;
    static constexpr double kDepthStep = 1.0 / 16;
    using ByDepth = std::array<double, kDepths>;

    /// Segments longer than `shortest`, up to `longest` samples.
    struct Class {
        double shortest, longest;
        ByDepth worst{};  ///< sums of errors
    };

    static void make_concave(ByDepth& values);

    double depth_of_sum_;
    std::vector<Class> classes_;
    // Of a line: extremes of sums, depths in classes, and what its segments of a length make.
    std::vector<double> high_, low_, depths_, rise_;
    std::vector<int> depth_class_;
};

}  // namespace wavefog::wfog
