#include "bench/variant.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "fogs.h"
#include "options.h"
#include "report.h"
#include "wavefog/fogmap/coarsen.h"

namespace wavefog::cli {
namespace {

/// Joins different words with "+"; equal words once.
void join(std::string& text, const std::string& word) {
    if (text.empty())
        text = word;
    else if (text != word)
        text += "+" + word;
}

const char* form_name(Form form) {
    return form == Form::wavelet ? "wavelet" : "scaling";
}

}  // namespace

Result<BenchScene> load_bench_scene(const std::filesystem::path& file) {
    Result<Scene> scene = load_grey_scene(file);
    if (!scene) return tl::unexpected(scene.error());
    auto particles = particles_at(scene->particles, scene->terrain, scene->meshes, 0);
    if (!particles) return tl::unexpected(particles.error());
    BenchScene result{file.stem().string(), {}, *std::move(scene), *std::move(particles)};
    std::ifstream stream(file);
    const Facts json = Facts::parse(stream, nullptr, false);
    for (const Facts& fog : json.value("fog", Facts::array())) {
        if (fog.value("model", "wavelet") != "wavelet") continue;
        const std::string picture = fog.contains("images")
                                        ? fog["images"][0].value("image", std::string())
                                        : fog.value("image", fog.value("file", std::string()));
        result.map_names.push_back(std::filesystem::path(picture).filename().string());
    }
    return result;
}

Grid<float> area_average(const Grid<float>& map, int width, int height) {
    // Weights of a column of the source in a column of the result: the share of their overlap.
    const auto weights = [](Eigen::Index from, int to) {
        Eigen::MatrixXf matrix = Eigen::MatrixXf::Zero(to, from);
        const double step = double(from) / to;
        for (int i = 0; i < to; ++i)
            for (auto k = Eigen::Index(i * step); k < from && double(k) < (i + 1) * step; ++k)
                matrix(i, k) = float(
                    (std::min((i + 1) * step, double(k + 1)) - std::max(i * step, double(k))) /
                    step);
        return matrix;
    };
    return (weights(map.rows(), height) * map.matrix() * weights(map.cols(), width).transpose())
        .array();
}

Grid<float> sized_map(const Grid<float>& map, int n) {
    const auto mirrored = [](int i, Eigen::Index count) {
        const Eigen::Index k = i % (2 * count);
        return k < count ? k : 2 * count - 1 - k;
    };
    const int rows = std::max(int(map.rows()), n), columns = std::max(int(map.cols()), n);
    Grid<float> large(rows, columns);
    for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i)
            large(j, i) = map(mirrored(j, map.rows()), mirrored(i, map.cols()));
    return rows == n && columns == n ? large : area_average(large, n, n);
}

Result<std::vector<Fog>> undecomposed(const std::vector<Fog>& fogs) {
    std::vector<Fog> result;
    for (const Fog& fog : fogs) {
        Result<Fog> made = decomposed_as(fog, fog.degree(), 0);
        if (!made) return tl::unexpected(made.error());
        result.push_back(*std::move(made));
    }
    return result;
}

Result<std::shared_ptr<const Variant>> make_variant(const BenchScene& scene,
                                                    const VariantOptions& options) {
    auto result = std::make_shared<Variant>();
    Variant& variant = *result;
    const std::size_t count = options.map_size ? 1 : scene.scene.fogs.size();
    for (std::size_t i = 0; i < count; ++i) {
        const Fog& source = scene.scene.fogs[i];
        const Decomposition<float>& d = source.decomposition;
        Fog fog = source;
        if (options.degree || options.levels || options.form || options.family ||
            options.map_size) {
            Grid<float> map = map_of(source);
            if (options.map_size) map = sized_map(map, *options.map_size);
            const int degree = options.degree.value_or(d.degree());
            const Form form = options.form.value_or(d.form);
            const bool keeps_family = degree == d.degree() && form == d.form;
            const std::string family =
                options.family.value_or(keeps_family ? d.family.name() : std::string());
            Result<Fog> made =
                fog_like(source, map,
                         {degree, family, form, options.levels.value_or(d.levels()), d.boundary});
            if (!made) return tl::unexpected(made.error());
            fog = *std::move(made);
        }
        if (options.profile) fog.profile = *options.profile;

        const Decomposition<float>& made = fog.decomposition;
        join(variant.map, scene.map_names[i]);
        join(variant.basis, basis_name(made.degree()));
        join(variant.family, made.family.name());
        join(variant.form, form_name(made.form));
        if (i == 0) {
            variant.map_width = made.width;
            variant.map_height = made.height;
            variant.levels = made.levels();
        }
        variant.truth_key += fmt::format("{}:{}x{}:{}:{};", scene.map_names[i], made.width,
                                         made.height, made.degree(), profile_text(fog.profile));
        variant.fogs.push_back(std::move(fog));
    }
    return result;
}

}  // namespace wavefog::cli
