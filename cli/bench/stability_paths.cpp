// Studies of integration along rays: tables, marching, world coordinates.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/stability.h"
#include "wavefog/fogmap/reference.h"
#include "wavefog/gpu/fog_pass.h"
#include "wavefog/wavelet/cell.h"
#include "wavefog/wavelet/path_table.h"

namespace wavefog::cli {
namespace {

/// A point on the edge of the unit square, edges as in PathTable.
std::array<double, 2> edge_point(int edge, double place) {
    switch (edge) {
        case 0:
            return {0, place};
        case 1:
            return {1, place};
        case 2:
            return {place, 0};
        default:
            return {place, 1};
    }
}

/// Largest error of a cell's integral of phi phi over random chords, in cell units.
Result<double> table_error(int degree, int samples, PathLayout layout) {
    const Result<PathTable> table =
        make_path_table(default_family(degree, Form::scaling), samples, layout, false);
    if (!table) return tl::unexpected(table.error());
    Random random(5);
    double largest = 0;
    for (int i = 0; i < 20000; ++i) {
        const int from = int(random.uniform(0, 4));
        const int to = (from + 1 + int(random.uniform(0, 3))) % 4;
        const auto a = edge_point(from, random.uniform(0, 1));
        const auto b = edge_point(to, random.uniform(0, 1));
        const int px = int(random.uniform(0, degree + 1)), pz = int(random.uniform(0, degree + 1));
        const double exact =
            bspline_segment_mean(degree, px + a[0], pz + a[1], px + b[0], pz + b[1]);
        const double found = look_up_whole(*table, 0, px, pz, a.data(), b.data());
        largest = std::max(largest, std::abs(found - exact) * std::hypot(b[0] - a[0], b[1] - a[1]));
    }
    return largest;
}

double largest_error(const ShaderOnCpu& shader, const Reference& truth,
                     const std::vector<Segment>& segments) {
    double largest = 0;
    for (const Segment& s : segments)
        largest = std::max(largest, std::abs(std::exp(-shader.optical_depth(s.o, s.p)) -
                                             std::exp(-truth.optical_depth(s.o, s.p))));
    return largest;
}

Method march(int samples) {
    Method method;
    method.kind = MethodKind::march;
    method.samples = samples;
    return method;
}

/// What a first attempt looks like: world coordinates in float32 from end to end, the ray split at
/// the grid's lines, two Gauss nodes a piece. Exact for linear fogs but for rounding.
double naive_optical_depth(const Fog& fog, const Grid<float>& map, const Segment& s) {
    const float ox = float(s.o.x()), oz = float(s.o.z());
    const float dx = float(s.p.x()) - ox, dz = float(s.p.z()) - oz;
    const float x0 = float(fog.rect.x0), z0 = float(fog.rect.z0);
    const float cell_x = float(fog.cell_x()), cell_z = float(fog.cell_z());
    const float metres = float((s.p - s.o).norm());
    std::vector<float> cuts = {0, 1};
    const auto add_cuts = [&](float origin, float direction, float start, float cell, int lines) {
        for (int i = 0; i <= lines && direction != 0; ++i) {
            const float t = (start + (float(i) - 0.5f) * cell - origin) / direction;
            if (t > 0 && t < 1) cuts.push_back(t);
        }
    };
    add_cuts(ox, dx, x0, cell_x, int(map.cols()) + 1);
    add_cuts(oz, dz, z0, cell_z, int(map.rows()) + 1);
    std::sort(cuts.begin(), cuts.end());
    const auto pixel = [&](int i, int j) {
        return i < 0 || j < 0 || i >= map.cols() || j >= map.rows() ? 0.0f : map(j, i);
    };
    const auto density = [&](float t) {
        const float u = (ox + t * dx - x0) / cell_x - 0.5f, v = (oz + t * dz - z0) / cell_z - 0.5f;
        const float i = std::floor(u), j = std::floor(v), a = u - i, b = v - j;
        return (1 - b) * ((1 - a) * pixel(int(i), int(j)) + a * pixel(int(i) + 1, int(j))) +
               b * ((1 - a) * pixel(int(i), int(j) + 1) + a * pixel(int(i) + 1, int(j) + 1));
    };
    float sum = 0;
    for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
        const float half = (cuts[k + 1] - cuts[k]) / 2, middle = (cuts[k + 1] + cuts[k]) / 2;
        const float node = half * 0.57735027f;
        sum += half * (density(middle - node) + density(middle + node));
    }
    return double(sum * float(fog.extinction) * metres);
}

}  // namespace

Result<Figure> study_tables() {
    Figure figure;
    figure.id = "stability-tables";
    figure.title = "Path-integral tables: mean density beats integrals";
    figure.subtitle =
        "Largest error over 20 000 chords of one cell; Haar with mean density is exact: 0";
    figure.x.label = "samples an edge";
    figure.y.label = "largest error of the integral, cells";
    const char* keys[] = {"1,1", "2,2", "3,3"};
    const char* names[] = {"Haar", "linear", "quadratic"};
    for (const PathLayout layout : {PathLayout::perimeter, PathLayout::mean})
        for (int degree = 0; degree <= 2; ++degree) {
            const bool mean = layout == PathLayout::mean;
            Curve curve{fmt::format("{}, {}", names[degree], mean ? "mean" : "perimeter"),
                        keys[degree],
                        mean ? Curve::Style::line : Curve::Style::dashed,
                        {}};
            for (int samples = 2; samples <= 128; samples *= 2) {
                const Result<double> error = table_error(degree, samples, layout);
                if (!error) return tl::unexpected(error.error());
                curve.points.emplace_back(samples, *error);
            }
            figure.curves.push_back(std::move(curve));
        }
    return figure;
}

Result<std::vector<Figure>> study_march() {
    constexpr double metres = 400, extinction = 0.02;
    Figure error, picture;
    error.id = "stability-march";
    error.title = "Marching: samples must grow with the map";
    error.subtitle =
        "Random maps of 0 and 1 over 400 m, linear; 2000 rays, the shader's own code on the CPU";
    error.x.label = "samples N of march:N";
    error.y.label = "largest |ΔT|";
    error.levels.push_back({kVisibleError, "least visible\nerror, 1/510"});
    picture.id = "stability-aliasing";
    picture.title = "Marching a fine map draws stripes that are not there";
    picture.subtitle =
        "Transmittance across a picture, 1024×1024 map of 0 and 1, eye in the fog, rays of 250 m";
    picture.x = {"azimuth, degrees", false, 0, 4};
    picture.y = {"transmittance T", false, 0, 0};
    const std::pair<int, const char*> maps[] = {
        {64, "march"}, {256, "march on a fine map"}, {1024, "march on a finer map"}};
    for (const auto& [size, key] : maps) {
        Random random(9);
        Grid<float> map(size, size);
        for (float& value : map.reshaped()) value = random.uniform(0, 1) < 0.5 ? 0.0f : 1.0f;
        const Result<Fog> fog = study_fog(map, {.degree = 1, .levels = 0}, metres, extinction);
        if (!fog) return tl::unexpected(fog.error());
        const Reference truth(*fog);
        Curve curve{fmt::format("{0}×{0} map", size), key, Curve::Style::line, {}};
        const auto segments = random_segments(2000, metres, 3);
        for (int samples = 8; samples <= 4096; samples *= 2) {
            const Result<ShaderOnCpu> shader = ShaderOnCpu::create(*fog, march(samples));
            if (!shader) return tl::unexpected(shader.error());
            curve.points.emplace_back(samples, largest_error(*shader, truth, segments));
        }
        error.curves.push_back(std::move(curve));
        if (size < 1024) continue;

        const Result<ShaderOnCpu> shader = ShaderOnCpu::create(*fog, march(64));
        if (!shader) return tl::unexpected(shader.error());
        Curve marched{"march:64", "march", Curve::Style::plain, {}};
        Curve exact{"truth", "reference", Curve::Style::plain, {}};
        const Eigen::Vector3d eye(-120.3, 2, 0.7);
        for (int i = 0; i <= 400; ++i) {
            const double degrees = i * 0.01, angle = degrees * 3.14159265358979 / 180;
            const Eigen::Vector3d end =
                eye + 250 * Eigen::Vector3d(std::cos(angle), 0, std::sin(angle));
            marched.points.emplace_back(degrees, std::exp(-shader->optical_depth(eye, end)));
            exact.points.emplace_back(degrees, std::exp(-truth.optical_depth(eye, end)));
        }
        picture.curves = {std::move(marched), std::move(exact)};
    }
    return std::vector{error, picture};
}

Result<Figure> study_world_offset() {
    constexpr double metres = 400, extinction = 0.02;
    const Grid<float> map = hard_edged_map(64);
    Figure figure;
    figure.id = "stability-offset";
    figure.title = "Far from the world's origin";
    figure.subtitle = "Linear 64×64 map over 400 m, 2000 rays, all arithmetic on rays in float32";
    figure.x.label = "distance of the fog from the origin, m";
    figure.y.label = "largest |ΔT|";
    figure.levels.push_back({kVisibleError, "least visible\nerror, 1/510"});
    Curve naive{"world coordinates in float32", "naive", Curve::Style::line, {}};
    Curve rebased{"exact: re-based at the eye", "exact", Curve::Style::line, {}};
    for (int step = 0; step <= 14; ++step) {
        const double offset = std::pow(10, step / 2.0);
        Result<Fog> fog = study_fog(map, {.degree = 1, .levels = 0}, metres, extinction);
        if (!fog) return tl::unexpected(fog.error());
        fog->rect = {fog->rect.x0 + offset, fog->rect.z0 - offset, fog->rect.x1 + offset,
                     fog->rect.z1 - offset};
        std::vector<Segment> segments = random_segments(2000, metres, 3);
        for (Segment& s : segments)
            for (Eigen::Vector3d* point : {&s.o, &s.p})
                *point += Eigen::Vector3d(offset, 0, -offset);
        const Reference truth(*fog);
        const Result<ShaderOnCpu> shader = ShaderOnCpu::create(*fog, Method{});
        if (!shader) return tl::unexpected(shader.error());
        double largest = 0;
        for (const Segment& s : segments)
            largest = std::max(largest, std::abs(std::exp(-naive_optical_depth(*fog, map, s)) -
                                                 std::exp(-truth.optical_depth(s.o, s.p))));
        naive.points.emplace_back(offset, largest);
        rebased.points.emplace_back(offset, largest_error(*shader, truth, segments));
    }
    figure.curves = {std::move(naive), std::move(rebased)};
    return figure;
}

}  // namespace wavefog::cli
