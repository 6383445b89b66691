// Runs the built command in a directory of its own and looks at what it leaves there.
#pragma once

#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include "support/temp_dir.h"

namespace wavefog::test {

struct RunResult {
    int status = -1;  ///< exit status, 128 + signal if one ended it
    std::string out, err;
};

/// A fresh directory, removed with everything in it at the end.
class Workspace {
  public:
    std::filesystem::path path(const std::string& name) const { return directory_ / name; }
    /// Runs `wavefog arguments...` in the directory.
    RunResult run(const std::vector<std::string>& arguments, const std::string& input = "") const;
    /// Runs a shell line there, in which $WAVEFOG is the command.
    RunResult shell(const std::string& line) const;

    void write_text(const std::string& name, const std::string& text) const;
    std::string read_text(const std::string& name) const;
    /// A float image of one channel, row by row; the extension chooses the format.
    void write_floats(const std::string& name, int width, int height,
                      const std::vector<float>& pixels) const;
    /// An 8-bit greyscale PNG whose pixel (x, y) is (7 x + 13 y) mod 256.
    void write_ramp_png(const std::string& name, int width, int height) const;
    /// Names of all files, to see that a failed run left none.
    std::set<std::string> files() const;

  private:
    TempDir directory_;
};

struct Picture {
    int width = 0, height = 0, channels = 0;
    std::vector<float> pixels;  ///< interleaved
    float at(int x, int y, int c = 0) const {
        return pixels[static_cast<std::size_t>((y * width + x) * channels + c)];
    }
};

/// Read by OpenImageIO; fails the test if it cannot.
Picture read_picture(const std::filesystem::path& file);

/// Read by TinyEXR's LoadEXR, as engines do: always four channels.
Picture read_with_tinyexr(const std::filesystem::path& file);

/// Largest difference of two pictures of the same size.
double largest_difference(const Picture& a, const Picture& b);

}  // namespace wavefog::test
