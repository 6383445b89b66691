// Checks of paths before work starts, and text files that appear whole or not at all.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "wavefog/wavelet/result.h"

namespace wavefog::cli {

/// The input exists, is no directory and can be opened.
Result<void> check_input(const std::filesystem::path& file);

/// The output's directory exists and can be written to, the output is no directory, and it is none
/// of the inputs. `extensions` (lower case, with dots) lists what can be written; empty: anything.
Result<void> check_output(const std::filesystem::path& file,
                          const std::vector<std::filesystem::path>& inputs,
                          const std::vector<std::string>& extensions);

/// The extension in lower case, with its dot.
std::string extension_of(const std::filesystem::path& file);

/// A text file written beside its final place and renamed on commit(); removed if that never comes.
/// A device or a pipe is written to in place, since a file renamed to its name would replace it.
class TextOutput {
  public:
    /// Opens FILE.tmp-PID, or FILE itself if it is a device or a pipe.
    static Result<TextOutput> create(const std::filesystem::path& file);
    TextOutput(TextOutput&& other) noexcept;
    TextOutput& operator=(TextOutput&&) = delete;
    ~TextOutput();

    std::ostream& stream() { return stream_; }
    Result<void> commit();

  private:
    TextOutput() = default;

    std::filesystem::path file_;
    std::filesystem::path temporary_;  ///< empty once renamed, and if written in place
    std::ofstream stream_;
};

/// NAME.json, the description beside the fog file NAME.exr.
std::filesystem::path description_of(const std::filesystem::path& fog_file);

/// All files of a saved fog: the images that its description names, and the description.
std::vector<std::filesystem::path> fog_files(const std::filesystem::path& fog_file);

/// Bytes on disk, 0 if the file is not there.
std::uintmax_t file_bytes(const std::filesystem::path& file);

}  // namespace wavefog::cli
