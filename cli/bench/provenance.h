// Where and with what a measurement was taken: without it a number cannot be compared.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report.h"
#include "wavefog/gpu/context.h"

namespace wavefog::cli {

/// Commit, compiler, machine, OpenGL, date, command line, and the data files with their SHA-256.
Facts provenance(const Context& context, const std::string& preset,
                 const std::vector<std::filesystem::path>& data_files);

/// SHA-256 in hexadecimal digits; empty if the file cannot be read.
std::string sha256_of(const std::filesystem::path& file);

/// The scene file and the pictures, fog files and meshes that it names.
std::vector<std::filesystem::path> files_of_scene(const std::filesystem::path& scene);

/// True for rasterisers that run on the CPU: their timer queries say no more than wall time.
bool is_software(const std::string& renderer);

}  // namespace wavefog::cli
