// The segments of lines through a map, and what rays can make of their errors.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace wavefog::wfog {

/// By length and optical depth of a segment, how far the map's error can add up along it.
class RaySegments {
  public:
    /// Segments of up to `most` metres, told apart by lengths that are multiples of `least`.
    RaySegments(double most, double least, double extinction);

    /// Running integrals along a line, `step` metres apart: of the error, and of the density.
    void add_line(const std::vector<double>& sums, const std::vector<double>& density, double step);

    /// The lines that `other` of the same form has.
    void add(const RaySegments& other);

    /// After all lines: longer segments, up to so many metres, as several of those there are.
    void extend(double most);

    /// The largest |dT| <= exp(-tau) (exp(|dtau|) - 1) of a ray whose optical depth and its error
    /// are means of those of segments with common weights: of segments of up to `longest` metres
    /// that are `mean` metres long on average. Error and density are `stretch` times those of the
    /// lines; the error `reserve` times more.
    double worst_change(double longest, double mean, double stretch, double reserve) const;

  private:
    static constexpr std::size_t kDepths = 193;
    static constexpr double kDepthStep = 1.0 / 16;
    using ByDepth = std::array<double, kDepths>;

    /// Segments longer than `shortest`, up to `longest` metres.
    struct Class {
        double shortest, longest;
        ByDepth worst{};  ///< integrals of errors
    };

    static void make_concave(ByDepth& values);

    double extinction_;
    std::vector<Class> classes_;
    // Of a line: extremes of sums, depths in classes, and what its segments of a length make.
    std::vector<double> high_, low_, depths_, rise_;
    std::vector<int> depth_class_;
};

}  // namespace wavefog::wfog
