// What a benchmark run found: rows of measurements, figures made of curves, and where, when and
// with what they were taken.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "bench/figure.h"
#include "report.h"

namespace wavefog::cli {

/// One method on one fog. A figure that was not measured is empty (null in JSON, nothing in CSV).
/// Scenes with several fogs join the words with "+" and give the first fog's numbers.
struct Row {
    std::string scene, map;
    int map_width = 0, map_height = 0;
    std::string basis, family;
    int levels = 0;
    double mu = 1;
    std::string method;
    int width = 0, height = 0;
    std::optional<double> ms_median, ms_p05, ms_p95, fps, ratio_homogeneous;
    std::optional<double> max_dT, p99_dT, rmse_tau, psnr, ssim;
    std::optional<std::size_t> bytes;
    std::optional<double> bound_dT;  ///< certified for every ray of the picture's reach; else empty
    std::string group;               ///< rows of a group took turns frame by frame
    std::string form;
    int frames = 0;
    std::optional<double> gpu_ms_median, wall_ms_median;
    /// Against the mean of T over each pixel, where cells are smaller than it.
    std::optional<double> max_mean_dT, p99_mean_dT;
    std::optional<bool> reused;  ///< tables were kept from frame to frame
};

/// Calls f(name, field) for every column of a Row or const Row, in the order of the files.
template <class RowType, class F>
void for_each_column(RowType& row, F&& f) {
    f("scene", row.scene);
    f("map", row.map);
    f("map_width", row.map_width);
    f("map_height", row.map_height);
    f("basis", row.basis);
    f("family", row.family);
    f("levels", row.levels);
    f("mu", row.mu);
    f("method", row.method);
    f("width", row.width);
    f("height", row.height);
    f("ms_median", row.ms_median);
    f("ms_p05", row.ms_p05);
    f("ms_p95", row.ms_p95);
    f("fps", row.fps);
    f("ratio_homogeneous", row.ratio_homogeneous);
    f("max_dT", row.max_dT);
    f("p99_dT", row.p99_dT);
    f("rmse_tau", row.rmse_tau);
    f("psnr", row.psnr);
    f("ssim", row.ssim);
    f("bytes", row.bytes);
    f("bound_dT", row.bound_dT);
    f("group", row.group);
    f("form", row.form);
    f("frames", row.frames);
    f("gpu_ms_median", row.gpu_ms_median);
    f("wall_ms_median", row.wall_ms_median);
    f("max_mean_dT", row.max_mean_dT);
    f("p99_mean_dT", row.p99_mean_dT);
    f("reused", row.reused);
}

struct Results {
    Facts provenance = Facts::object();
    std::vector<Row> rows;
    std::vector<Figure> figures;         ///< of --preset stability
    Facts compression = Facts::array();  ///< runs of codecs, of --preset compression
    Facts ray_promise = Facts::array();  ///< bits by pixels and by rays, of --preset compression
    Facts motion = Facts::array();       ///< maps and particles, of --preset motion
    std::vector<std::string> cut;        ///< what the time budget left out
    std::vector<std::string> skipped;    ///< what could not be measured, and why

    std::string preset() const { return provenance.value("preset", std::string()); }
};

Facts to_json(const Results& results);

/// Reads results.json; a data error names the file and the key that is missing or of a wrong type.
Result<Results> read_results(const std::filesystem::path& file);

/// The rows as CSV with a header line.
std::string rows_csv(const std::vector<Row>& rows);

/// All points as CSV: figure,curve,x,y.
std::string figures_csv(const std::vector<Figure>& figures);

/// Rows that took turns, in order.
std::vector<std::vector<Row>> groups_of(const std::vector<Row>& rows);

/// The method with what else sets a row apart: "exact, μ 0.8", "radial, reused".
std::string setting_name(const Row& row);

/// "march" of "march:32" and of "march:32@256x256".
std::string method_base(const std::string& method);

}  // namespace wavefog::cli
