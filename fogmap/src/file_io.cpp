#include "file_io.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <utility>

namespace wavefog::detail {

namespace fs = std::filesystem;

namespace {

// Process id and a counter: two writers of one file never share a temporary one.
fs::path temporary_name(const fs::path& target) {
    static std::atomic<unsigned> counter{0};
    fs::path name = target;
    name.replace_filename(
        fmt::format(".{}.{}-{}.tmp", target.filename().string(), getpid(), counter.fetch_add(1)));
    return name;
}

}  // namespace

PendingFile::PendingFile(fs::path target)
    : target_(std::move(target)), path_(temporary_name(target_)) {}

PendingFile::PendingFile(PendingFile&& other) noexcept
    : target_(std::move(other.target_)),
      path_(std::move(other.path_)),
      pending_(std::exchange(other.pending_, false)) {}

PendingFile::~PendingFile() {
    std::error_code ignored;
    if (pending_) fs::remove(path_, ignored);
}

Result<void> PendingFile::commit() {
    std::error_code error;
    fs::rename(path_, target_, error);
    if (error)
        return data_error(fmt::format("{}: cannot be written ({}); choose another name",
                                      target_.string(), error.message()));
    pending_ = false;
    return {};
}

Result<void> check_writable_place(const fs::path& file) {
    std::error_code error;
    const fs::path directory = file.has_parent_path() ? file.parent_path() : fs::path(".");
    if (!file.has_filename())
        return data_error(fmt::format("{}: is no file name; give a file to write", file.string()));
    if (!fs::is_directory(directory, error))
        return data_error(fmt::format("{}: there is no directory {}; create it first",
                                      file.string(), directory.string()));
    if (fs::is_directory(file, error))
        return data_error(fmt::format("{}: is a directory; give a file to write", file.string()));
    if (::access(directory.c_str(), W_OK) != 0)
        return data_error(fmt::format("{}: cannot write into directory {} ({}); choose another",
                                      file.string(), directory.string(), std::strerror(errno)));
    return {};
}

Result<void> check_is_file(const fs::path& file) {
    std::error_code error;
    const fs::file_status status = fs::status(file, error);
    if (!fs::exists(status))
        return data_error(fmt::format("{}: no such file; check the path", file.string()));
    if (fs::is_directory(status))
        return data_error(fmt::format("{}: is a directory; give a file", file.string()));
    return {};
}

Result<std::string> read_text_file(const fs::path& file, std::uintmax_t max_bytes) {
    if (auto ok = check_is_file(file); !ok) return tl::unexpected(ok.error());
    std::error_code error;
    const std::uintmax_t size = fs::file_size(file, error);
    if (!error && size > max_bytes)
        return data_error(fmt::format("{}: {} bytes, above the limit of {}; this is no such file",
                                      file.string(), size, max_bytes));
    std::ifstream stream(file, std::ios::binary);
    std::string text(std::istreambuf_iterator<char>(stream), {});
    if (!stream && !stream.eof())
        return data_error(fmt::format("{}: cannot be read; check its permissions", file.string()));
    return text;
}

Result<void> write_text_file(const fs::path& file, const std::string& text) {
    std::ofstream stream(file, std::ios::binary);
    stream.write(text.data(), static_cast<std::streamsize>(text.size()));
    stream.close();
    if (!stream)
        return data_error(fmt::format("{}: cannot be written ({}); check space and permissions",
                                      file.string(), std::strerror(errno)));
    return {};
}

std::string lower_extension(const fs::path& file) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

}  // namespace wavefog::detail
