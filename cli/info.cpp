// wavefog info: what is in a fog file or a picture.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "command.h"
#include "energy.h"
#include "files.h"
#include "options.h"
#include "report.h"
#include "wavefog/fogmap/fog_file.h"
#include "wavefog/fogmap/image.h"

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

struct InfoOptions {
    fs::path input;
    bool json = false;
};

struct Range {
    double low = 0, high = 0;
    bool empty = true;

    void include(const Grid<float>& values) {
        if (values.size() == 0) return;
        const double low_new = values.minCoeff(), high_new = values.maxCoeff();
        low = empty ? low_new : std::min(low, low_new);
        high = empty ? high_new : std::max(high, high_new);
        empty = false;
    }
};

/// One row a level: 0 is the coarsest approximation, above it the details that each level adds.
Facts level_rows(const Decomposition<float>& d) {
    const std::vector<double> shares = energy_shares(d);
    const Pyramid<float> pyramid = approximations(d);
    Facts rows = Facts::array();
    for (int level = 0; level <= d.levels(); ++level) {
        std::vector<const Band<float>*> bands = {&d.approximation};
        if (level > 0) {
            const Detail<float>& detail = d.details[std::size_t(level) - 1];
            if (d.form == Form::wavelet)
                bands = {&detail.phi_psi, &detail.psi_phi, &detail.psi_psi};
            else
                bands = {&detail.residual};
        }
        Range range;
        std::int64_t count = 0;
        for (const Band<float>* band : bands) {
            range.include(band->values);
            count += band->values.size();
        }
        const Band<float>& approximation = pyramid.levels[std::size_t(level)];
        Range density;
        density.include(approximation.values);
        rows.push_back({{"level", level},
                        {"coefficients", count},
                        {"min", range.low},
                        {"max", range.high},
                        {"energy_share", shares[std::size_t(level)]},
                        {"map_width", approximation.width()},
                        {"map_height", approximation.height()},
                        {"map_start_x", approximation.start_x},
                        {"map_start_z", approximation.start_z},
                        {"map_min", density.low},
                        {"map_max", density.high}});
    }
    return rows;
}

Result<Facts> describe_fog(const fs::path& file) {
    LoadNotes notes;
    const Result<Fog> fog = load_fog(file, &notes);
    if (!fog) return tl::unexpected(fog.error());
    if (!notes.warning.empty()) warn(notes.warning);
    notes.map = {};  // large, and of no use here
    std::uintmax_t bytes = 0;
    for (const fs::path& part : fog_files(file)) bytes += file_bytes(part);
    Facts facts = {{"file", file.string()}, {"kind", "fog"}, {"bytes", bytes}};
    facts.update(fog_facts(*fog));
    facts.update(stream_facts(notes));
    const Facts rows = level_rows(fog->decomposition);
    std::int64_t count = 0;
    for (const Facts& row : rows) count += row.at("coefficients").get<std::int64_t>();
    facts["coefficients"] = count;
    if (fog->wind.constant()) {
        const Eigen::Vector2d velocity = fog->wind.velocity(0);
        facts["wind"] = {velocity.x(), velocity.y()};
    } else {
        facts["wind"] = Facts::array();
        for (const Wind::Key& key : fog->wind.keys)
            facts["wind"].push_back({key.seconds, key.x, key.z});
    }
    facts["stable_family"] = fog->decomposition.family.stable();
    facts["energy_per_level"] = rows;
    return facts;
}

Result<Facts> describe_image(const fs::path& file) {
    ReadOptions read;
    read.sanitize = true;
    const Result<Fogmap> map = read_fogmap(file, read);
    if (!map) return tl::unexpected(map.error());
    return Facts{{"file", file.string()},
                 {"kind", "picture"},
                 {"bytes", file_bytes(file)},
                 {"format", map->source_format},
                 {"size", {map->pixels.cols(), map->pixels.rows()}},
                 {"min", map->pixels.minCoeff()},
                 {"max", map->pixels.maxCoeff()},
                 {"mean", map->pixels.cast<double>().mean()},
                 {"invalid_pixels", map->sanitized},
                 {"largest_useful_levels",
                  max_levels(int(map->pixels.cols()), int(map->pixels.rows()), Boundary::zero)}};
}

Result<void> info(const InfoOptions& options) {
    // A fog of --layout levels is found by the name it was saved under, which is no file's.
    if (auto ok = check_input(options.input); !ok && !is_fog_file(options.input)) return ok;
    const Result<Facts> facts =
        is_fog_file(options.input) ? describe_fog(options.input) : describe_image(options.input);
    if (!facts) return tl::unexpected(facts.error());
    print_facts(*facts, options.json);
    return {};
}

}  // namespace

Command add_info(CLI::App& root) {
    auto options = std::make_shared<InfoOptions>();
    CLI::App* app = root.add_subcommand("info", "Say what is in a fog file or a picture");
    app->add_option("FILE", options->input, "A fog file or a picture")->required();
    app->add_flag("--json", options->json, "Print JSON");
    app->footer(
        R"(Of a fog: its size, basis, family, place in the world, and a row for each level: how many
coefficients it has and their least and greatest value, the share of the energy (squared
L2 norm) that it adds, and the size and bounds of the approximation that it completes.
Levels with little energy can be left out far away at little cost; an approximation whose
least value is below 0 shows negative fog unless clamped (--family positive has none).
Of a .wfog also how many of its stream levels are there (a download may end early) and, of a
whole one, the largest error of a pixel that its encoder measured.
Of a picture: its format, size, bounds, and how many pixels could not be fog.

Example:
  wavefog info banks.exr --json)");
    return {app, [options] { return info(*options); }};
}

}  // namespace wavefog::cli
