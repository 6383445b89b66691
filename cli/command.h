// A subcommand: its flags and help, and what it does once they are parsed.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "wavefog/wavelet/result.h"

namespace wavefog::cli {

struct Command {
    CLI::App* app = nullptr;
    std::function<Result<void>()> run;
};

Command add_convert(CLI::App& root);
Command add_info(CLI::App& root);
Command add_decode(CLI::App& root);
Command add_probe(CLI::App& root);
Command add_render(CLI::App& root);
Command add_animate(CLI::App& root);
Command add_bench(CLI::App& root);
Command add_fit(CLI::App& root);
Command add_apply(CLI::App& root);
Command add_generate(CLI::App& root);

}  // namespace wavefog::cli
