#include "bench/provenance.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sha2.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <fstream>
#include <iterator>
#include <thread>

#include "wavefog_commit.h"

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

/// What follows "key<separator>" on the first such line of a text file.
std::string line_value(const char* file, const std::string& key, char separator) {
    std::ifstream stream(file);
    for (std::string line; std::getline(stream, line);) {
        if (line.rfind(key, 0) != 0) continue;
        std::string value = line.substr(line.find(separator) + 1);
        value.erase(std::remove(value.begin(), value.end(), '"'), value.end());
        value.erase(0, value.find_first_not_of(" \t"));
        return value;
    }
    return "unknown";
}

std::string compiler() {
#if defined(__clang__)
    return "Clang " __clang_version__;
#else
    return "GCC " __VERSION__;
#endif
}

std::string command_line() {
    std::ifstream stream("/proc/self/cmdline", std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    while (!text.empty() && text.back() == '\0') text.pop_back();
    const auto program_end = std::min(text.find('\0'), text.size());
    text = fs::path(text.substr(0, program_end)).filename().string() + text.substr(program_end);
    std::replace(text.begin(), text.end(), '\0', ' ');
    return text;
}

/// Collects the values of file-naming keys anywhere in a scene.
void collect_files(const Facts& json, const fs::path& folder, std::vector<fs::path>& files) {
    if (!json.is_structured()) return;
    for (const auto& [key, value] : json.items()) {
        const bool names_file = json.is_object() && value.is_string() &&
                                (key == "image" || key == "file" || key == "heightmap");
        if (names_file)
            files.push_back((folder / value.get<std::string>()).lexically_normal());
        else
            collect_files(value, folder, files);
    }
}

}  // namespace

std::string sha256_of(const fs::path& file) {
    std::array<char, SHA256_DIGEST_STRING_LENGTH> digits{};
    return SHA256File(file.c_str(), digits.data()) == nullptr ? "" : digits.data();
}

std::vector<fs::path> files_of_scene(const fs::path& scene) {
    std::vector<fs::path> files = {scene};
    std::ifstream stream(scene);
    const Facts json = Facts::parse(stream, nullptr, false);
    if (!json.is_discarded()) collect_files(json, scene.parent_path(), files);
    std::sort(files.begin() + 1, files.end());
    files.erase(std::unique(files.begin(), files.end()), files.end());
    return files;
}

bool is_software(const std::string& renderer) {
    for (const char* name : {"llvmpipe", "softpipe", "swrast", "SWR", "SwiftShader"})
        if (renderer.find(name) != std::string::npos) return true;
    return false;
}

Facts provenance(const Context& context, const std::string& preset,
                 const std::vector<fs::path>& data_files) {
    Facts data = Facts::array();
    for (const fs::path& file : data_files)
        data.push_back({{"file", file.generic_string()}, {"sha256", sha256_of(file)}});
    const bool software = is_software(context.renderer());
    return {{"preset", preset},
            {"date", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)))},
            {"command", command_line()},
            {"commit", WAVEFOG_COMMIT},
            {"compiler", compiler()},
            {"system", line_value("/etc/os-release", "PRETTY_NAME", '=')},
            {"cpu", line_value("/proc/cpuinfo", "model name", ':')},
            {"cores", std::thread::hardware_concurrency()},
            {"context", context.name()},
            {"gl_renderer", context.renderer()},
            {"gl_version", context.version()},
            {"clock", software ? "wall time of a finished frame" : "GL_TIME_ELAPSED"},
            {"data", data}};
}

}  // namespace wavefog::cli
