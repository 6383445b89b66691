#include "run.h"

#include <OpenImageIO/imageio.h>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <tinyexr.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

namespace wavefog::test {
namespace fs = std::filesystem;
namespace {

std::string quoted(const std::string& text) {
    std::string inside;
    for (const char c : text) {
        if (c == '\'')
            inside += "'\\''";
        else
            inside += c;
    }
    return fmt::format("'{}'", inside);
}

std::string text_of(const fs::path& file) {
    std::ostringstream text;
    text << std::ifstream(file, std::ios::binary).rdbuf();
    return text.str();
}

}  // namespace

RunResult Workspace::shell(const std::string& line) const {
    const fs::path out = directory_.path().string() + ".out",
                   err = directory_.path().string() + ".err";
    const std::string command =
        fmt::format("cd {} && WAVEFOG={} && {{ {}\n}} >{} 2>{}", quoted(directory_.path().string()),
                    quoted(WAVEFOG_COMMAND), line, quoted(out.string()), quoted(err.string()));
    const int code = std::system(command.c_str());
    RunResult result;
    result.status = WIFEXITED(code) ? WEXITSTATUS(code) : 128 + WTERMSIG(code);
    result.out = text_of(out);
    result.err = text_of(err);
    fs::remove(out);
    fs::remove(err);
    return result;
}

RunResult Workspace::run(const std::vector<std::string>& arguments,
                         const std::string& input) const {
    std::string line = "\"$WAVEFOG\"";
    for (const std::string& argument : arguments) line += fmt::format(" {}", quoted(argument));
    return shell(fmt::format("printf %s {} | {}", quoted(input), line));
}

void Workspace::write_text(const std::string& name, const std::string& text) const {
    std::ofstream(path(name), std::ios::binary) << text;
}

std::string Workspace::read_text(const std::string& name) const {
    return text_of(path(name));
}

void Workspace::write_floats(const std::string& name, int width, int height,
                             const std::vector<float>& pixels) const {
    const std::string file = path(name).string();
    const auto output = OIIO::ImageOutput::create(file);
    REQUIRE(output);
    REQUIRE(output->open(file, OIIO::ImageSpec(width, height, 1, OIIO::TypeDesc::FLOAT)));
    REQUIRE(output->write_image(OIIO::TypeDesc::FLOAT, pixels.data()));
    REQUIRE(output->close());
}

void Workspace::write_ramp_png(const std::string& name, int width, int height) const {
    std::vector<unsigned char> pixels;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            pixels.push_back(static_cast<unsigned char>(7 * x + 13 * y));
    const std::string file = path(name).string();
    const auto output = OIIO::ImageOutput::create(file);
    REQUIRE(output);
    REQUIRE(output->open(file, OIIO::ImageSpec(width, height, 1, OIIO::TypeDesc::UINT8)));
    REQUIRE(output->write_image(OIIO::TypeDesc::UINT8, pixels.data()));
    REQUIRE(output->close());
}

std::set<std::string> Workspace::files() const {
    std::set<std::string> names;
    for (const auto& entry : fs::recursive_directory_iterator(directory_.path()))
        names.insert(fs::relative(entry.path(), directory_.path()).string());
    return names;
}

Picture read_picture(const fs::path& file) {
    const auto input = OIIO::ImageInput::open(file.string());
    REQUIRE_MESSAGE(input, file.string(), ": ", OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    Picture picture{spec.width, spec.height, spec.nchannels, {}};
    picture.pixels.resize(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
    REQUIRE(
        input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, picture.pixels.data()));
    return picture;
}

Picture read_with_tinyexr(const fs::path& file) {
    float* rgba = nullptr;
    const char* error = nullptr;
    Picture picture;
    picture.channels = 4;
    const int code = LoadEXR(&rgba, &picture.width, &picture.height, file.c_str(), &error);
    REQUIRE_MESSAGE(code == TINYEXR_SUCCESS, file.string(), ": ", error ? error : "no message");
    picture.pixels.assign(rgba, rgba + 4 * picture.width * picture.height);
    std::free(rgba);
    return picture;
}

double largest_difference(const Picture& a, const Picture& b) {
    REQUIRE(a.width == b.width);
    REQUIRE(a.height == b.height);
    REQUIRE(a.channels == b.channels);
    double largest = 0;
    for (std::size_t i = 0; i < a.pixels.size(); ++i)
        largest = std::max(largest, std::abs(double(a.pixels[i]) - double(b.pixels[i])));
    return largest;
}

}  // namespace wavefog::test
