#include "bench/scale.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <map>
#include <numbers>
#include <tuple>

#include "bench/table_text.h"
#include "report.h"
#include "wavefog/fogmap/coarsen.h"
#include "wavefog/fogmap/image.h"
#include "wavefog/gpu/timer.h"

namespace wavefog::cli {
namespace {

constexpr int kMapSizes[] = {64, 256, 1024, 4096};
constexpr Size kFullHd = {1920, 1080};
// The truth of a pixel walks through every cell, 17 times for its mean: of every stride-th column
// and row alone it takes as long as the timing.
int stride_of(int map_size, const Size& picture) {
    return (map_size > 256 ? 8 : 4) * (picture.width == kFullHd.width ? 2 : 1);
}

constexpr const char* kHaar = ", Haar";
constexpr const char* kCameras[] = {"", ", above", ", down", ", pitched", ", rolled"};

Camera camera_case(Camera camera, int index) {
    const Eigen::Vector3d view = camera.target - camera.eye;
    const double distance = view.norm();
    const double degree = std::numbers::pi / 180;
    switch (index) {
        case 1:
            camera.eye.y() += distance;
            break;
        case 2:
            camera.eye.y() += distance;
            camera.target = camera.eye - Eigen::Vector3d(0, distance, 0);
            camera.up = Eigen::Vector3d(view.x(), 0, view.z());
            break;
        case 3: {
            const Eigen::Vector3d side = view.cross(camera.up).normalized();
            camera.target = camera.eye + Eigen::AngleAxisd(25 * degree, side) * view;
            break;
        }
        case 4:
            camera.up = Eigen::AngleAxisd(30 * degree, view.normalized()) * camera.up;
            break;
        default:
            break;
    }
    return camera;
}

}  // namespace

Result<void> put_map(BenchScene& scene, const std::filesystem::path& picture) {
    const Result<Fogmap> map = read_fogmap(picture);
    if (!map) return tl::unexpected(map.error());
    Fog& fog = scene.scene.fogs.front();
    const Decomposition<float>& d = fog.decomposition;
    Result<Fog> made =
        fog_like(fog, map->pixels, {d.degree(), d.family.name(), d.form, d.levels(), d.boundary});
    if (!made) return tl::unexpected(made.error());
    fog = *std::move(made);
    scene.map_names.front() = picture.filename().string();
    return {};
}

std::vector<BenchScene> scale_scenes(const std::vector<BenchScene>& scenes) {
    std::vector<BenchScene> all;
    for (const BenchScene& scene : scenes)
        for (int i = 0; i < int(std::size(kCameras)); ++i) {
            all.push_back(scene);
            all.back().name += kCameras[i];
            all.back().scene.camera = camera_case(scene.scene.camera, i);
        }
    return all;
}

Result<std::vector<Group>> plan_scale(const std::vector<BenchScene>& scenes, const Size& size,
                                      const std::vector<Method>& methods,
                                      const std::vector<double>& mus) {
    constexpr std::size_t kCases = std::size(kCameras);
    assert(scenes.size() % kCases == 0);
    std::vector<Group> groups;
    const auto add = [&](std::size_t scene, const std::shared_ptr<const Variant>& variant,
                         const Size& picture) {
        Group group;
        group.name =
            fmt::format("{}, {}, {}x{}, {}x{}", scenes[scene].name, variant->basis,
                        variant->map_width, variant->map_height, picture.width, picture.height);
        group.scene = scene;
        group.size = picture;
        group.stride = stride_of(variant->map_width, picture);
        group.pixel_means = true;
        group.variants.push_back(variant);
        for (Method method : methods)
            for (const double mu : mus) {
                method.mu = mu;
                const bool exact = method.kind == MethodKind::exact;
                if (mu == 1 || (exact && picture.width != kFullHd.width))
                    group.cases.push_back({0, method});
                if (mu == 1 && method.kind == MethodKind::radial && !method.radial_step)
                    group.cases.push_back({0, method, true});
            }
        groups.push_back(std::move(group));
    };
    // All pictures of a map one after the other: what is found of it serves them all.
    for (const int map_size : kMapSizes)
        for (std::size_t first = 0; first < scenes.size(); first += kCases) {
            VariantOptions wanted;
            wanted.map_size = map_size;
            auto variant = make_variant(scenes[first], wanted);
            if (!variant) return tl::unexpected(variant.error());
            for (std::size_t i = first; i < first + kCases; ++i)
                for (const Size& picture : {size, kFullHd}) add(i, *variant, picture);
            if (scenes[first].scene.fogs.front().degree() == 0) continue;
            wanted.degree = 0;
            variant = make_variant(scenes[first], wanted);
            if (!variant) return tl::unexpected(variant.error());
            add(first, *variant, size);
        }
    return groups;
}

std::string scale_table_text(const std::vector<Row>& rows, bool markdown) {
    struct Cell {
        Samples ratio, ms;
        double max_dT = 0, p99_dT = 0, max_mean_dT = 0;
        std::size_t bytes = 0;
        int cases = 0;
    };
    // In the order of first appearance within a picture size and a map size.
    std::vector<std::string> methods;
    std::map<std::tuple<int, int, std::size_t>, Cell> cells;
    for (const Row& row : rows) {
        if (!row.ratio_homogeneous || !row.max_dT) continue;
        const std::string name = setting_name(row);
        auto found = std::find(methods.begin(), methods.end(), name);
        if (found == methods.end()) found = methods.insert(methods.end(), name);
        Cell& cell = cells[{row.width, row.map_width, std::size_t(found - methods.begin())}];
        cell.ratio.add(*row.ratio_homogeneous);
        cell.ms.add(*row.ms_median);
        cell.max_dT = std::max(cell.max_dT, *row.max_dT);
        cell.p99_dT = std::max(cell.p99_dT, row.p99_dT.value_or(0));
        cell.max_mean_dT = std::max(cell.max_mean_dT, row.max_mean_dT.value_or(*row.max_dT));
        cell.bytes = std::max(cell.bytes, row.bytes.value_or(0));
        ++cell.cases;
    }
    Table table({"picture, map, method", "cases", "× homogeneous", "worst ×", "ms", "max |ΔT|",
                 "99 % |ΔT|", "max, pixel means", "KiB"});
    for (const auto& [key, cell] : cells) {
        const auto& [width, map, method] = key;
        table.add({fmt::format("{} wide, {}², {}", width, map, methods[method]),
                   std::to_string(cell.cases), short_number(cell.ratio.median()),
                   short_number(cell.ratio.percentile(100)), short_number(cell.ms.median()),
                   error_number(cell.max_dT), error_number(cell.p99_dT),
                   error_number(cell.max_mean_dT),
                   fmt::format("{:.0f}", double(cell.bytes) / 1024)});
    }
    return table.text(markdown);
}

std::string scale_summary_text(const std::vector<Row>& rows, bool markdown) {
    struct Cell {
        Samples ratio;
        double max_dT = 0, p99_dT = 0;
    };
    // By the picture's width, the scene without its camera, and the map's size.
    std::vector<std::string> scenes;
    std::map<std::tuple<int, std::size_t, int>, std::map<std::string, Cell>> lines;
    for (const Row& row : rows) {
        if (!row.ratio_homogeneous || !row.max_dT || row.mu < 1) continue;
        std::string scene = row.scene.substr(0, row.scene.find(','));
        if (row.basis == basis_name(0)) scene += kHaar;
        auto found = std::find(scenes.begin(), scenes.end(), scene);
        if (found == scenes.end()) found = scenes.insert(scenes.end(), scene);
        Cell& cell = lines[{row.width, std::size_t(found - scenes.begin()), row.map_width}]
                          [setting_name(row)];
        cell.ratio.add(*row.ratio_homogeneous);
        cell.max_dT = std::max(cell.max_dT, *row.max_dT);
        cell.p99_dT = std::max(cell.p99_dT, row.p99_dT.value_or(0));
    }
    Table table({"picture, scene, map", "radial", "max |ΔT|", "reused", "radial:step", "max |ΔT|",
                 "exact", "max |ΔT|", "march:32", "max |ΔT|"});
    for (const auto& [key, line] : lines) {
        const auto& [width, scene, map] = key;
        const auto cost = [&line = line](const char* method) -> std::string {
            const auto found = line.find(method);
            if (found == line.end()) return "-";
            const Samples& ratio = found->second.ratio;
            const std::string median = short_number(ratio.median());
            return ratio.size() == 1
                       ? median
                       : fmt::format("{} ({})", median, short_number(ratio.percentile(100)));
        };
        // A ray along an edge of Haar's cells meets a true jump: the 99 % beside the maximum.
        const bool jumps = scenes[scene].ends_with(kHaar);
        const auto error = [&line = line, jumps](const char* method) -> std::string {
            const auto found = line.find(method);
            if (found == line.end()) return "-";
            const std::string worst = error_number(found->second.max_dT);
            return jumps ? fmt::format("{} ({})", worst, error_number(found->second.p99_dT))
                         : worst;
        };
        table.add({fmt::format("{} wide, {}, {}²", width, scenes[scene], map), cost("radial"),
                   error("radial"), cost("radial, reused"), cost("radial:step"),
                   error("radial:step"), cost("exact"), error("exact"), cost("march:32"),
                   error("march:32")});
    }
    return table.text(markdown);
}

}  // namespace wavefog::cli
