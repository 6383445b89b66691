// Files written whole or not at all, and small files read whole.
#pragma once

#include <filesystem>
#include <string>

#include "wavefog/wavelet/result.h"

namespace wavefog::detail {

/// A file under a temporary name in the target's own directory, so that the rename is atomic. The
/// destructor removes it unless commit() has succeeded.
class PendingFile {
  public:
    explicit PendingFile(std::filesystem::path target);
    ~PendingFile();
    PendingFile(PendingFile&& other) noexcept;
    PendingFile(const PendingFile&) = delete;
    PendingFile& operator=(const PendingFile&) = delete;
    PendingFile& operator=(PendingFile&&) = delete;

    const std::filesystem::path& path() const { return path_; }
    /// Gives the file its final name, replacing an older file.
    Result<void> commit();

  private:
    std::filesystem::path target_;
    std::filesystem::path path_;
    bool pending_ = true;
};

/// Names the reason if `file` cannot be created: no such directory, a directory in its place.
Result<void> check_writable_place(const std::filesystem::path& file);

/// A data error for a missing or unreadable file, a directory, or one above `max_bytes`.
Result<std::string> read_text_file(const std::filesystem::path& file, std::uintmax_t max_bytes);

Result<void> write_text_file(const std::filesystem::path& file, const std::string& text);

/// A data error unless `file` is an existing regular file (or something that reads like one).
Result<void> check_is_file(const std::filesystem::path& file);

/// The extension in lower case, with its dot.
std::string lower_extension(const std::filesystem::path& file);

}  // namespace wavefog::detail
