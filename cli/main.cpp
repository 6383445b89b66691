// wavefog: dispatches to the subcommands. Exit status 0, 1 (data), 2 (usage).
#include <fmt/core.h>

#include <array>
#include <exception>
#include <new>

#include "command.h"

namespace wavefog::cli {
namespace {

constexpr int exit_data = 1;
constexpr int exit_usage = 2;

int report(const Error& error) {
    fmt::print(stderr, "wavefog: error: {}\n", error.message);
    return error.kind == ErrorKind::usage ? exit_usage : exit_data;
}

std::string help_command(const CLI::App& root) {
    const auto chosen = root.get_subcommands();
    return chosen.empty() ? "wavefog --help" : "wavefog " + chosen.front()->get_name() + " --help";
}

int run(int argc, char** argv) {
    CLI::App root("Models, compresses and renders heterogeneous fog with B-spline wavelets.",
                  "wavefog");
    root.set_version_flag("--version", "wavefog " WAVEFOG_VERSION);
    root.set_help_flag("-h,--help", "Print this help");
    root.require_subcommand(1);
    root.footer(
        R"(A fog is a greyscale picture laid over the ground: its pixels say how dense the fog is,
a height profile says how it thins upwards. `wavefog SUBCOMMAND --help` explains each step.

Example, from a picture to a fogged frame:
  wavefog convert data/weather_coverage_512.png -o banks.exr --extinction 0.05 \
                  --rect -4200,-4200,4200,4200 --profile exponential:111,17
  wavefog info banks.exr
  wavefog render data/scenes/valley.json --fog banks.exr -o valley.png

Exit status: 0 done, 1 a file or its content is at fault, 2 the command line is.)");
    const std::array commands = {
        add_convert(root), add_info(root),  add_decode(root), add_probe(root),    add_render(root),
        add_animate(root), add_bench(root), add_fit(root),    add_generate(root), add_apply(root)};
    try {
        root.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return root.exit(error);  // --help, --version
        const bool unknown = root.get_subcommands().empty() && argc > 1 && argv[1][0] != '-';
        const std::string what =
            unknown ? fmt::format("there is no subcommand '{}'", argv[1]) : error.what();
        fmt::print(stderr, "wavefog: error: {}; run '{}' to see what there is\n", what,
                   help_command(root));
        return exit_usage;
    }
    for (const Command& command : commands) {
        if (!command.app->parsed()) continue;
        const Result<void> result = command.run();
        return result ? 0 : report(result.error());
    }
    return exit_usage;
}

}  // namespace
}  // namespace wavefog::cli

int main(int argc, char** argv) {
    try {
        return wavefog::cli::run(argc, argv);
    } catch (const std::bad_alloc&) {
        fmt::print(stderr, "wavefog: error: out of memory; use a smaller map or picture\n");
    } catch (const std::exception& error) {
        fmt::print(stderr, "wavefog: error: {}; this is a bug, please report it\n", error.what());
    }
    return 1;
}
