#include "files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <utility>

namespace wavefog::cli {
namespace fs = std::filesystem;

Result<void> check_input(const fs::path& file) {
    std::error_code code;
    const fs::file_status status = fs::status(file, code);
    if (status.type() == fs::file_type::not_found)
        return data_error(fmt::format("{}: there is no such file; check the path", file.string()));
    if (status.type() == fs::file_type::directory)
        return data_error(fmt::format("{}: this is a directory; name a file in it", file.string()));
    if (access(file.c_str(), R_OK) != 0)
        return data_error(fmt::format("{}: cannot be read ({}); check its permissions",
                                      file.string(), std::strerror(errno)));
    return {};
}

Result<void> check_output(const fs::path& file, const std::vector<fs::path>& inputs,
                          const std::vector<std::string>& extensions) {
    if (!extensions.empty() &&
        std::find(extensions.begin(), extensions.end(), extension_of(file)) == extensions.end())
        return usage_error(fmt::format("{}: cannot write '{}' files here; use {}", file.string(),
                                       extension_of(file), fmt::join(extensions, ", ")));
    const fs::path directory = file.has_parent_path() ? file.parent_path() : fs::path(".");
    std::error_code code;
    if (!fs::is_directory(directory, code))
        return data_error(fmt::format("{}: the directory {} does not exist; create it first",
                                      file.string(), directory.string()));
    if (fs::is_directory(file, code))
        return data_error(fmt::format("{}: this is a directory; name a file in it", file.string()));
    for (const fs::path& input : inputs)
        if (fs::exists(file, code) && fs::equivalent(file, input, code))
            return usage_error(fmt::format(
                "{}: output and input are the same file; write to another name", file.string()));
    if (access(directory.c_str(), W_OK) != 0)
        return data_error(
            fmt::format("{}: the directory {} cannot be written to ({}); choose "
                        "another or change its permissions",
                        file.string(), directory.string(), std::strerror(errno)));
    return {};
}

std::string extension_of(const fs::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

Result<TextOutput> TextOutput::create(const fs::path& file) {
    TextOutput output;
    output.file_ = file;
    std::error_code code;
    const bool in_place = fs::is_other(file, code);
    if (!in_place) {
        output.temporary_ = file;
        output.temporary_ += fmt::format(".tmp-{}", getpid());
    }
    const fs::path& opened = in_place ? output.file_ : output.temporary_;
    output.stream_.open(opened, std::ios::binary | std::ios::trunc);
    if (!output.stream_)
        return data_error(fmt::format("{}: cannot be created ({}); choose another place",
                                      opened.string(), std::strerror(errno)));
    return output;
}

TextOutput::TextOutput(TextOutput&& other) noexcept
    : file_(std::move(other.file_)),
      temporary_(std::exchange(other.temporary_, {})),
      stream_(std::move(other.stream_)) {}

TextOutput::~TextOutput() {
    if (temporary_.empty()) return;
    stream_.close();
    std::error_code code;
    fs::remove(temporary_, code);
}

Result<void> TextOutput::commit() {
    stream_.close();
    std::error_code code;
    if (!stream_.fail() && !temporary_.empty()) fs::rename(temporary_, file_, code);
    if (stream_.fail() || code)
        return data_error(fmt::format("{}: cannot be written ({}); is the disk full?",
                                      file_.string(),
                                      code ? code.message() : std::strerror(errno)));
    temporary_.clear();
    return {};
}

fs::path description_of(const fs::path& fog_file) {
    return fs::path(fog_file).replace_extension("json");
}

std::vector<fs::path> fog_files(const fs::path& fog_file) {
    if (extension_of(fog_file) == ".wfog") return {fog_file};
    if (extension_of(fog_file) == ".wfog") return {fog_file};
    const fs::path description = description_of(fog_file);
    std::ifstream stream(description);
    const auto facts = nlohmann::json::parse(stream, nullptr, false);
    if (!facts.contains("textures")) return {fog_file};  // an engine may have only the image
    std::vector<fs::path> files;
    for (const auto& texture : facts.at("textures")) {
        const fs::path image = fog_file.parent_path() / texture.at("image").get<std::string>();
        if (files.empty() || files.back() != image) files.push_back(image);  // parts share a file
    }
    files.push_back(description);
    return files;
}

std::uintmax_t file_bytes(const fs::path& file) {
    std::error_code code;
    const std::uintmax_t bytes = fs::file_size(file, code);
    return code ? 0 : bytes;
}

}  // namespace wavefog::cli
