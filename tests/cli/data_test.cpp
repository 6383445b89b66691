// Every file of data/ through the command.
#include <doctest/doctest.h>

#include <algorithm>

#include "run.h"

using namespace wavefog::test;
namespace fs = std::filesystem;

namespace {

std::vector<fs::path> files_of(const std::string& folder, const std::set<std::string>& extensions) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(fs::path(WAVEFOG_DATA_DIR) / folder))
        if (extensions.contains(entry.path().extension().string())) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

}  // namespace

TEST_CASE("every fogmap of data/ converts and comes back") {
    const Workspace work;
    const auto files = files_of(".", {".png", ".tif", ".exr"});
    REQUIRE(files.size() >= 3);
    for (const fs::path& file : files) {
        INFO(file.string());
        const RunResult converted = work.run({"convert", file.string(), "-o", "fog.exr"});
        REQUIRE_MESSAGE(converted.status == 0, converted.err);
        const RunResult decoded = work.run({"decode", "fog.exr", "-o", "back.tif"});
        REQUIRE_MESSAGE(decoded.status == 0, decoded.err);
        const Picture map = read_picture(file), back = read_picture(work.path("back.tif"));
        CHECK(back.width == map.width);
        CHECK(back.height == map.height);
        const float highest = *std::max_element(map.pixels.begin(), map.pixels.end());
        // Colour would go through luminance; data/ is grey.
        if (map.channels == 1)
            CHECK(largest_difference(map, back) <= 16 * 0x1p-24 * double(highest));
        CHECK(work.run({"info", "fog.exr"}).status == 0);
    }
}

TEST_CASE("every scene of data/ renders, and fog hides some of it but not all") {
    const Workspace work;
    int scenes = 0;
    for (const fs::path& file : files_of("scenes", {".json"})) {
        ++scenes;
        INFO(file.string());
        const RunResult result = work.run({"render", file.string(), "-o", "out.png", "--size",
                                           "160x120", "--transmittance", "T.exr"});
        REQUIRE_MESSAGE(result.status == 0, result.err);
        const Picture t = read_picture(work.path("T.exr"));
        const auto [least, most] = std::minmax_element(t.pixels.begin(), t.pixels.end());
        CHECK(*least >= 0.0f);
        CHECK(*most <= 1.0f);
        CHECK(*least < 0.9f);
        CHECK(*most - *least > 0.1f);
    }
    CHECK(scenes >= 2);
}
