#include "bench/ray_promise.h"

#include <fmt/format.h>

#include <cmath>
#include <map>

#include "bench/table_text.h"
#include "wavefog/fogmap/wfog.h"

namespace wavefog::cli {
namespace {

constexpr int paths[] = {64, 128, 512};  // cells
constexpr double error = 0.01, depth = 4;
/// Larger maps are left out: a proof takes minutes.
constexpr Eigen::Index most_pixels = 1 << 22;

}  // namespace

Result<void> measure_ray_promise(const CodecMap& map, Facts& rows) {
    if (map.densities.size() > most_pixels) return {};
    Result<Fog> fog = make_fog(map.densities, {});
    if (!fog) return tl::unexpected(fog.error());
    fog->profile = {.kind = Profile::Kind::exponential, .base = 0, .scale = 20};
    for (const int path : paths) {
        fog->extinction = depth / (path * map.full_scale);
        WfogOptions by_pixels, by_rays;
        by_pixels.promise = WfogOptions::Promise::max_error;
        by_pixels.error = error / depth;  // |dtau| <= extinction * path * this
        by_rays.promise = WfogOptions::Promise::max_transmittance_error;
        by_rays.error = error;
        by_rays.path = path;
        by_rays.ground = fog->profile.base;
        Facts row = {{"map", map.name}, {"path_cells", path}};
        for (const auto& [name, options] :
             {std::pair{"by_pixels", by_pixels}, {"by_rays", by_rays}}) {
            const auto file = encode_wfog(*fog, options, &map.densities);
            if (!file) return tl::unexpected(file.error());
            row[name] = file->report.bits_per_pixel;
        }
        rows.push_back(std::move(row));
    }
    return {};
}

std::string ray_promise_text(const Facts& rows, bool markdown) {
    if (rows.empty()) return "";
    struct Mean {
        double pixels = 0, rays = 0;
        int count = 0;
    };
    std::map<int, Mean> means;
    std::map<std::string, std::map<int, std::string>> cells;
    std::vector<std::string> names;
    const auto text_of = [](double pixels, double rays) {
        return fmt::format("{:.2f} → {:.2f} ({:.2f})", pixels, rays, rays / pixels);
    };
    for (const Facts& row : rows) {
        const std::string name = row.at("map");
        const int path = row.at("path_cells");
        const double pixels = row.at("by_pixels"), rays = row.at("by_rays");
        if (!cells.contains(name)) names.push_back(name);
        cells[name][path] = text_of(pixels, rays);
        Mean& mean = means[path];
        mean.pixels += std::log(pixels);
        mean.rays += std::log(rays);
        ++mean.count;
    }
    std::vector<std::string> header = {"map"}, last = {"geometric mean"};
    for (const auto& [path, mean] : means) {
        header.push_back(fmt::format("rays of {} cells", path));
        last.push_back(
            text_of(std::exp(mean.pixels / mean.count), std::exp(mean.rays / mean.count)));
    }
    Table table(header);
    for (const std::string& name : names) {
        std::vector<std::string> line = {name};
        for (const auto& [path, mean] : means) line.push_back(cells[name][path]);
        table.add(line);
    }
    table.add(last);
    return "Bits a pixel that keep |ΔT| ≤ 0.01 along every ray, by a bound on pixels → by rays "
           "(ratio); optical depth 4 along the path at full scale; maps of up to 4 Mpixel\n\n" +
           table.text(markdown);
}

}  // namespace wavefog::cli
