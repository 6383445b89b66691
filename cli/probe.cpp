// wavefog probe: optical depth and transmittance along rays given in a CSV file.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iostream>
#include <limits>
#include <memory>
#include <optional>

#include "command.h"
#include "files.h"
#include "fogs.h"
#include "interrupt.h"
#include "options.h"
#include "parallel.h"
#include "rays.h"
#include "report.h"
#include "wavefog/fogmap/reference.h"
#include "wavefog/fogmap/scene.h"
#include "wavefog/gpu/fog_pass.h"

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

struct ProbeOptions {
    fs::path input, rays, output;
    Method method = {.kind = MethodKind::reference};
    std::optional<double> mu;
    double time = 0;
};

/// parse_method() but for what is a matter of pixels.
Result<Method> parse_ray_method(const std::string& text) {
    Result<Method> method = parse_method(text);
    if (method && !method->sampling.every_pixel())
        return usage_error(fmt::format(
            "method \"{}\": rays have no pixels and no vertices; leave out what follows the @",
            text));
    return method;
}

/// A method's optical depth from O to P through one fog.
using OpticalDepth = std::function<double(const Eigen::Vector3d&, const Eigen::Vector3d&)>;

Result<OpticalDepth> evaluator(const Fog& fog, const Method& method, double seconds) {
    if (method.kind == MethodKind::reference) {
        auto reference = std::make_shared<Reference>(fog, seconds);
        return [reference, mu = method.mu](const auto& o, const auto& p) {
            return reference->optical_depth(o, p, mu);
        };
    }
    auto created = ShaderOnCpu::create(fog, method, seconds);
    if (!created) return tl::unexpected(created.error());
    auto shader = std::make_shared<ShaderOnCpu>(std::move(*created));
    return [shader](const auto& o, const auto& p) { return shader->optical_depth(o, p); };
}

/// The same through all fogs given by formulas.
Result<OpticalDepth> evaluator(const std::vector<FogModel>& models, const Method& method) {
    if (method.kind == MethodKind::reference)
        return [models](const auto& o, const auto& p) { return optical_depth(models, o, p); };
    auto created = ModelsOnCpu::create(models);
    if (!created) return tl::unexpected(created.error());
    return [shader = std::move(*created)](const auto& o, const auto& p) {
        return shader.optical_depth(o, p);
    };
}

/// The same through all particles.
Result<OpticalDepth> evaluator(const std::vector<Particle>& particles, const Method& method) {
    if (method.kind == MethodKind::reference)
        return [particles](const auto& o, const auto& p) { return optical_depth(particles, o, p); };
    return [shader = ParticlesOnCpu(particles)](const auto& o, const auto& p) {
        return shader.optical_depth(o, p);
    };
}

Result<RayTable> rays_of(const fs::path& file) {
    if (file == "-") return read_rays(std::cin, "standard input");
    if (auto ok = check_input(file); !ok) return tl::unexpected(ok.error());
    std::ifstream stream(file, std::ios::binary);
    return read_rays(stream, file.string());
}

/// Optical depth of every ray, as red, green and blue see it.
using Depths = std::vector<Eigen::Array3d>;

void write_rows(std::ostream& out, const RayTable& table, const Depths& depths, bool coloured) {
    const auto columns = [&](const char* name) {
        return coloured ? fmt::format(",{0}_red,{0}_green,{0}_blue", name)
                        : fmt::format(",{}", name);
    };
    if (!table.header.empty())
        out << table.header << columns("optical_depth") << columns("transmittance") << '\n';
    const int channels = coloured ? 3 : 1;
    for (std::size_t i = 0; i < depths.size(); ++i) {
        out << table.rays[i].text;
        for (int c = 0; c < channels; ++c) out << fmt::format(",{:.17g}", depths[i][c]);
        for (int c = 0; c < channels; ++c) out << fmt::format(",{:.17g}", std::exp(-depths[i][c]));
        out << '\n';
    }
}

/// The sum over all fogs.
Result<Depths> depths_of(const RayTable& table, const FogsAt& fogs, const Method& method) {
    Depths depths(table.rays.size(), Eigen::Array3d::Zero());
    const auto add = [&](const Result<OpticalDepth>& through,
                         const Channels& channels) -> Result<void> {
        if (!through) return tl::unexpected(through.error());
        const Eigen::Array3d shares(channels.data());
        parallel_chunks("probing", depths.size(), 64, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                depths[i] += (*through)(table.rays[i].origin, table.rays[i].end) * shares;
        });
        return {};
    };
    for (const Fog& fog : fogs.fogs)
        if (auto ok = add(evaluator(fog, method, fogs.seconds), fog.channels); !ok)
            return tl::unexpected(ok.error());
    // What all colours see alike goes through the shader together, as it does in a picture.
    for (const auto& group : by_channels(fogs.models))
        if (auto ok = add(evaluator(group, method), group.front().channels); !ok)
            return tl::unexpected(ok.error());
    for (const auto& group : by_channels(fogs.particles))
        if (auto ok = add(evaluator(group, method), group.front().channels); !ok)
            return tl::unexpected(ok.error());
    return depths;
}

Result<void> probe(const ProbeOptions& options) {
    const bool to_stdout = options.output == "-";
    if (auto ok = check_input(options.input); !ok) return ok;
    if (!to_stdout)
        if (auto ok = check_output(options.output, {options.input, options.rays}, {}); !ok)
            return ok;
    Method method = options.method;
    method.mu = options.mu.value_or(method.mu);
    const Result<FogsAt> fogs = load_fogs_at(options.input, options.time);
    if (!fogs) return tl::unexpected(fogs.error());
    const Result<RayTable> table = rays_of(options.rays);
    if (!table) return tl::unexpected(table.error());
    const Result<Depths> depths = depths_of(*table, *fogs, method);
    if (!depths) return tl::unexpected(depths.error());

    if (to_stdout) {
        write_rows(std::cout, *table, *depths, fogs->coloured());
        std::cout.flush();
        if (!std::cout) return data_error("standard output: cannot be written; is the disk full?");
        return {};
    }
    const HoldInterrupts hold;
    Result<TextOutput> output = TextOutput::create(options.output);
    if (!output) return tl::unexpected(output.error());
    write_rows(output->stream(), *table, *depths, fogs->coloured());
    if (auto ok = output->commit(); !ok) return ok;
    const std::size_t count = fogs->fogs.size() + fogs->models.size();
    const std::string particles =
        fogs->particles.empty() ? "" : fmt::format(" and {} particles", fogs->particles.size());
    fmt::print("wrote {}: {} rays through {} fog{}{}, method {}, mu {}\n", options.output.string(),
               depths->size(), count, count == 1 ? "" : "s", particles, method.name(), method.mu);
    return {};
}

}  // namespace

Command add_probe(CLI::App& root) {
    auto options = std::make_shared<ProbeOptions>();
    CLI::App* app = root.add_subcommand("probe", "Measure the fog along rays");
    app->add_option("FOG", options->input, "A fog file, a scene (.json) or a picture")->required();
    app->add_option("--rays", options->rays, "CSV of rays, - for standard input")
        ->required()
        ->type_name("R.csv");
    app->add_option("-o,--output", options->output, "CSV to write, - for standard output")
        ->required()
        ->type_name("OUT.csv");
    add_parsed(
        *app, "--method", options->method, parse_ray_method, "M",
        "reference | exact | radial | paper | paper-scaling | march:N | homogeneous (reference)");
    add_parsed(
        *app, "--mu", options->mu,
        [](const std::string& text) { return parse_number_in(text, 0, 1); }, "MU",
        "Detail level l counts up to |OP| * mu^l from O: 1 keeps all, 0 none (1)");
    add_parsed(*app, "--time", options->time, parse_number, "SECONDS",
               "When: winds have blown for so long (0)");
    app->footer(
        R"(Each row ox,oy,oz,px,py,pz is a segment from O to P in metres, y up; a header line is
optional. The same rows come out with two columns more: the optical depth, the integral
of extinction from O to P, and the transmittance exp(-optical depth), the share of light
that gets through. Several fogs add their optical depths; if some have "channels", both
columns come for red, green and blue. `reference` is exact in double;
the other methods run the shader's own code on the CPU in float, so that their error can
be seen without a GPU. `radial` builds a table around each O: keep the rays of one O together.

Example: how much light crosses 300 m of the fog?
  echo 0,2,0,300,2,0 | wavefog probe banks.exr --rays - -o -)");
    return {app, [options] { return probe(*options); }};
}

}  // namespace wavefog::cli
