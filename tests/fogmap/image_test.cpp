// Pictures in and out: every format and type, the rules for odd pixels, damage, and failed writes.
#include "wavefog/fogmap/image.h"

#include <OpenImageIO/imageio.h>
#include <sys/resource.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <limits>

#include "fogmap/fog_support.h"
#include "fogmap/make_png.h"
#include "support/temp_dir.h"

namespace wavefog::test {
namespace {

namespace fs = std::filesystem;
using OIIO::TypeDesc;

/// Writes `values` (interleaved) through OpenImageIO as `type`.
void write_with_oiio(const fs::path& file, int width, int height, int channels, TypeDesc type,
                     const std::vector<float>& values, const std::vector<std::string>& names = {},
                     int tile = 0) {
    const auto output = OIIO::ImageOutput::create(file.string());
    REQUIRE(output);
    OIIO::ImageSpec spec(width, height, channels, type);
    if (!names.empty()) spec.channelnames = names;
    spec.tile_width = spec.tile_height = tile;
    spec.attribute("CompressionQuality", 100);
    REQUIRE_MESSAGE(output->open(file.string(), spec), output->geterror());
    REQUIRE(output->write_image(TypeDesc::FLOAT, values.data()));
    REQUIRE(output->close());
}

std::vector<float> ramp(int count) {
    std::vector<float> values;
    for (int i = 0; i < count; ++i)
        values.push_back(static_cast<float>(i) / static_cast<float>(count - 1));
    return values;
}

std::string map_error(const fs::path& file, const ReadOptions& options = {}) {
    const auto map = read_fogmap(file, options);
    return map ? "read" : map.error().message;
}

Fogmap map_of(const fs::path& file, const ReadOptions& options = {}) {
    auto map = read_fogmap(file, options);
    REQUIRE_MESSAGE(map.has_value(), (map ? "" : map.error().message));
    return std::move(*map);
}

// The whole process: 330 MB at the time of writing, 960 MB with the address sanitizer's quarantine.
// A header that is believed costs 3300 MB (memory_DOS_2.2.exr).
#ifdef __SANITIZE_ADDRESS__
constexpr long kPeakLimit = 1800;
#else
constexpr long kPeakLimit = 700;
#endif

long peak_megabytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return usage.ru_maxrss / 1024;
}

}  // namespace

TEST_CASE("every format and type gives the stored values") {
    const TempDir dir;
    struct Case {
        const char* name;
        TypeDesc type;
        double step;  // of the stored numbers
    };
    // 1/255 and 1/65535: the integer types. Half has 11 bits. HDR shares one 8-bit exponent. JPEG
    // at quality 100 rounds its coefficients: 3 steps.
    const std::vector<Case> cases = {
        {"a.png", TypeDesc::UINT8, 1 / 255.0}, {"b.png", TypeDesc::UINT16, 1 / 65535.0},
        {"a.tif", TypeDesc::UINT8, 1 / 255.0}, {"b.tif", TypeDesc::UINT16, 1 / 65535.0},
        {"c.tif", TypeDesc::HALF, 0x1p-11},    {"d.tif", TypeDesc::FLOAT, 0},
        {"a.exr", TypeDesc::HALF, 0x1p-11},    {"b.exr", TypeDesc::FLOAT, 0},
        {"a.pgm", TypeDesc::UINT8, 1 / 255.0}, {"a.jpg", TypeDesc::UINT8, 3 / 255.0},
        {"a.tga", TypeDesc::UINT8, 1 / 255.0}, {"a.bmp", TypeDesc::UINT8, 1 / 255.0},
    };
    const int width = 21, height = 13;  // odd on purpose
    const auto values = ramp(width * height);
    for (const Case& c : cases) {
        CAPTURE(std::string(c.name));
        write_with_oiio(dir / c.name, width, height, 1, c.type, values);
        const Fogmap map = map_of(dir / c.name);
        REQUIRE(map.pixels.cols() == width);
        REQUIRE(map.pixels.rows() == height);
        double worst = 0;
        for (int k = 0; k < width * height; ++k)
            worst = std::max(worst, std::abs(double(map.pixels(k / width, k % width)) -
                                             double(values[std::size_t(k)])));
        CHECK(worst <=
              c.step / 2 * 1.0001 + 6e-8);  // half a step, and float32's rounding of v / 255
        CHECK(map.sanitized == 0);
    }
    // OpenImageIO writes PGM with 8 bits only: 16 bits, another maximum and plain text by hand.
    write_bytes(dir / "16.pgm", std::string("P5 2 1 65535\n\x12\x34\xff\xff", 17));
    CHECK(map_of(dir / "16.pgm").pixels(0, 0) == static_cast<float>(0x1234 / 65535.0));
    write_bytes(dir / "100.pgm", std::string("P5 2 1 100\n\x32\x64", 13));
    CHECK(double(map_of(dir / "100.pgm").pixels(0, 0)) == doctest::Approx(0.5).epsilon(0.01));
    write_bytes(dir / "text.pgm", "P2\n# a comment\n3 1\n255\n0 51 255\n");
    CHECK(map_of(dir / "text.pgm").pixels(0, 1) == 0.2f);
    // Radiance HDR is always RGB.
    std::vector<float> grey;
    for (const float v : values) grey.insert(grey.end(), {v, v, v});
    write_with_oiio(dir / "a.hdr", width, height, 3, TypeDesc::FLOAT, grey);
    const Fogmap hdr = map_of(dir / "a.hdr");
    CHECK(double(hdr.pixels(12, 20)) == doctest::Approx(1).epsilon(1.0 / 128));
}

TEST_CASE("integers are divided by their type's maximum, exactly") {
    const TempDir dir;
    std::string rows8, rows16(1, '\0');
    rows8.push_back('\0');
    for (int v = 0; v < 256; ++v) rows8.push_back(static_cast<char>(v));
    write_bytes(dir / "8.png", make_png(256, 1, 8, 0, rows8));
    const Fogmap bytes = map_of(dir / "8.png");
    for (int v = 0; v < 256; ++v) CHECK(bytes.pixels(0, v) == static_cast<float>(v / 255.0));
    for (int v = 0; v < 4096; ++v) {
        rows16.push_back(static_cast<char>(v * 16 >> 8));
        rows16.push_back(static_cast<char>(v * 16));
    }
    write_bytes(dir / "16.png", make_png(4096, 1, 16, 0, rows16));
    const Fogmap words = map_of(dir / "16.png");
    int wrong = 0;
    for (int v = 0; v < 4096; ++v)
        wrong += words.pixels(0, v) != static_cast<float>(v * 16 / 65535.0);
    CHECK(wrong == 0);
}

TEST_CASE("few bits, palettes, alpha and one pixel") {
    const TempDir dir;
    const auto read_row = [&](const std::string& png) {
        write_bytes(dir / "row.png", png);
        const Grid<float> pixels = map_of(dir / "row.png").pixels;
        return std::vector<float>(pixels.data(), pixels.data() + pixels.size());
    };
    using Row = std::vector<float>;
    const auto parts = [](std::initializer_list<int> values, double of) {
        Row row;
        for (const int v : values) row.push_back(static_cast<float>(v / of));
        return row;
    };
    CHECK(read_row(make_png(8, 1, 1, 0, std::string("\0\x8d", 2))) ==
          parts({1, 0, 0, 0, 1, 1, 0, 1}, 1));
    CHECK(read_row(make_png(4, 1, 2, 0, std::string("\0\x1b", 2))) == parts({0, 1, 2, 3}, 3));
    CHECK(read_row(make_png(3, 1, 4, 0, std::string("\0\x0f\x70", 3))) == parts({0, 15, 7}, 15));
    // Palette of black, grey 100 and white.
    const std::string palette("\0\0\0ddd\xff\xff\xff", 9);
    const Row coloured = read_row(make_png(3, 1, 8, 3, std::string("\0\2\1\0", 4), palette));
    CHECK(double(coloured[0]) == doctest::Approx(1));
    CHECK(double(coloured[1]) == doctest::Approx(100 / 255.0));
    CHECK(coloured[2] == 0);
    // Grey with alpha: the colour is not multiplied by it, not even where alpha is 0.
    CHECK(read_row(make_png(2, 1, 8, 4, std::string("\0\x33\x80\xff\0", 5))) ==
          parts({51, 255}, 255));
    CHECK(read_row(make_png(1, 1, 8, 0, std::string("\0\x33", 2))) == parts({51}, 255));
}

TEST_CASE("colour becomes Rec. 709 luminance unless a channel is chosen") {
    const TempDir dir;
    const std::vector<float> rgba = {0.25f, 0.5f, 1.0f, 0.125f};
    write_with_oiio(dir / "c.exr", 1, 1, 4, TypeDesc::FLOAT, rgba);
    const auto value = [&](std::optional<std::string> channel) {
        return double(map_of(dir / "c.exr", {.channel = std::move(channel)}).pixels(0, 0));
    };
    CHECK(value({}) == doctest::Approx(0.2126 * 0.25 + 0.7152 * 0.5 + 0.0722));
    CHECK(value("R") == 0.25);
    CHECK(value("g") == 0.5);
    CHECK(value("2") == 1);
    CHECK(value("A") == 0.125);
    CHECK(contains(map_error(dir / "c.exr", {.channel = "Z"}),
                   "has no channel \"Z\"; choose one of R, G, B, A"));
    CHECK(contains(map_error(dir / "c.exr", {.channel = "4"}), "has no channel \"4\""));
    CHECK(contains(map_error(dir / "c.exr", {.channel = "-1"}), "has no channel"));

    write_with_oiio(dir / "two.exr", 1, 1, 2, TypeDesc::FLOAT, {0.5f, 2.0f},
                    {"density", "temperature"});
    CHECK(contains(map_error(dir / "two.exr"), "choose one with --channel"));
    CHECK(map_of(dir / "two.exr", {.channel = "density"}).pixels(0, 0) == 0.5f);
    CHECK(map_of(dir / "two.exr", {.channel = "temperature"}).pixels(0, 0) == 2.0f);

    // sRGB pictures are taken as data: grey 128 is 128 / 255, not its linear light.
    write_with_oiio(dir / "s.png", 1, 1, 3, TypeDesc::UINT8, std::vector<float>(3, 128 / 255.0f));
    CHECK(double(map_of(dir / "s.png").pixels(0, 0)) == doctest::Approx(128 / 255.0));
}

TEST_CASE("tiles, offset windows and large floats are read as they are") {
    const TempDir dir;
    const auto values = ramp(70 * 45);
    write_with_oiio(dir / "tiled.exr", 70, 45, 1, TypeDesc::FLOAT, values, {"Y"}, 32);
    write_with_oiio(dir / "tiled.tif", 70, 45, 1, TypeDesc::FLOAT, values, {}, 16);
    for (const char* name : {"tiled.exr", "tiled.tif"}) {
        const Fogmap map = map_of(dir / name);
        for (int k = 0; k < 70 * 45; k += 7)
            CHECK(map.pixels(k / 70, k % 70) == values[std::size_t(k)]);
    }
    write_with_oiio(dir / "bright.exr", 2, 1, 1, TypeDesc::FLOAT, {34441.0f, 1e30f});
    CHECK(map_of(dir / "bright.exr").pixels(0, 1) == 1e30f);
}

TEST_CASE(
    "NaN, Inf and negative pixels are an error that names the first, or become 0 and are counted") {
    const TempDir dir;
    const float nan = std::numeric_limits<float>::quiet_NaN(),
                inf = std::numeric_limits<float>::infinity();
    struct Case {
        float bad;
        const char* text;
    };
    for (const auto& [bad, text] :
         {Case{nan, "nan"}, Case{inf, "inf"}, Case{-inf, "-inf"}, Case{-0.5f, "-0.5"}})
        for (const char* name : {"bad.exr", "bad.tif"}) {
            std::vector<float> values(5 * 4, 0.25f);
            values[2 * 5 + 3] = bad;
            values[3 * 5 + 1] = bad;
            write_with_oiio(dir / name, 5, 4, 1, TypeDesc::FLOAT, values);
            const std::string message = map_error(dir / name);
            CAPTURE(message);
            CHECK(contains(message, "pixel (3, 2) is " + std::string(text) + ", 2 such pixels"));
            CHECK(contains(message, "--sanitize"));
            const Fogmap map = map_of(dir / name, {.sanitize = true});
            CHECK(map.sanitized == 2);
            CHECK(map.pixels(2, 3) == 0);
            CHECK(map.pixels(3, 1) == 0);
            CHECK(map.pixels.sum() == doctest::Approx(18 * 0.25f));
        }
    write_with_oiio(dir / "zero.exr", 1, 1, 1, TypeDesc::FLOAT, {-0.0f});
    CHECK_FALSE(std::signbit(map_of(dir / "zero.exr").pixels(0, 0)));
}

TEST_CASE("a map above the limit is refused before it is read") {
    const TempDir dir;
    write_with_oiio(dir / "m.tif", 100, 50, 1, TypeDesc::UINT8, ramp(5000));
    CHECK(map_error(dir / "m.tif", {.max_bytes = 20000}) == "read");
    const std::string message = map_error(dir / "m.tif", {.max_bytes = 19999});
    CHECK(contains(message, "100 x 50 pixels"));
    CHECK(contains(message, "above the limit"));
    // A header that claims 10^10 pixels and holds 10 bytes: refused by its size, in no time.
    write_bytes(dir / "claim.png", make_png(100000, 100000, 8, 0, "0123456789"));
    CHECK(contains(map_error(dir / "claim.png"), "100000 x 100000 pixels need"));
    // Below the limit, but still more than ten bytes can hold.
    write_bytes(dir / "claim.png", make_png(20000, 20000, 8, 0, "0123456789"));
    CHECK(contains(map_error(dir / "claim.png"), "cannot hold 20000 x 20000 pixels"));
    // 4 GiB of claims in a PGM of 20 bytes.
    write_bytes(dir / "claim.pgm", "P5 30000 30000 255\n0123");
    CHECK(map_error(dir / "claim.pgm") != "read");
    CHECK(peak_megabytes() < kPeakLimit);
}

TEST_CASE("truncated and empty pictures are errors in every format") {
    const TempDir dir;
    Random random(41);
    std::vector<float> values;
    for (int i = 0; i < 40 * 30 * 3; ++i) values.push_back(static_cast<float>(random.uniform()));
    for (const char* name : {"t.png", "t.tif", "t.exr", "t.ppm", "t.hdr", "t.jpg", "t.bmp"}) {
        const bool wide = std::string(name) == "t.exr" || std::string(name) == "t.hdr";
        write_with_oiio(dir / name, 40, 30, 3, wide ? TypeDesc::FLOAT : TypeDesc::UINT8, values);
        REQUIRE(map_error(dir / name) == "read");
        const std::string good = read_bytes(dir / name);
        const fs::path cut = dir / (std::string("cut") + fs::path(name).extension().string());
        for (int k = 0; k < 40; ++k) {
            // The last byte of a TIFF or PNG matters; the last of some formats is padding, hence 95
            // %.
            const std::size_t length =
                k == 39 ? good.size() * 95 / 100 : good.size() * std::size_t(k) / 40;
            write_bytes(cut, good.substr(0, length));
            CAPTURE(std::string(name));
            CAPTURE(length);
            CHECK(map_error(cut) != "read");
        }
    }
    CHECK(contains(map_error(dir / "nothing.png"), "no such file"));
    CHECK(contains(map_error(dir.path()), "is a directory"));
    write_bytes(dir / "text.png", "this is not a picture");
    CHECK(contains(map_error(dir / "text.png"), "cannot be read as an image"));
}

TEST_CASE("files of several images, deep images and volumes are refused") {
    const TempDir dir;
    const auto output = OIIO::ImageOutput::create("two.tif");
    const OIIO::ImageSpec spec(4, 4, 1, TypeDesc::UINT8);
    const auto values = ramp(16);
    REQUIRE(output->open((dir / "two.tif").string(), spec));
    REQUIRE(output->write_image(TypeDesc::FLOAT, values.data()));
    REQUIRE(output->open((dir / "two.tif").string(), spec, OIIO::ImageOutput::AppendSubimage));
    REQUIRE(output->write_image(TypeDesc::FLOAT, values.data()));
    REQUIRE(output->close());
    CHECK(contains(map_error(dir / "two.tif"), "holds several images"));
}

TEST_CASE("odd and damaged files of other projects: no crash, no hang, no giant allocation") {
    const fs::path odd = fs::path(WAVEFOG_SHARED_DIR) / "data" / "odd";
    int read = 0, refused = 0, skipped = 0;
    for (const char* kind : {"png", "tiff", "exr"}) {
        if (!fs::is_directory(odd / kind)) {
            ++skipped;
            MESSAGE("skipped: " << (odd / kind).string()
                                << " is not here (test data that is not ours)");
            continue;
        }
        for (const auto& entry : fs::directory_iterator(odd / kind)) {
            const std::string name = entry.path().filename().string();
            CAPTURE(name);
            const auto start = std::chrono::steady_clock::now();
            const auto map = read_fogmap(entry.path());
            const auto bad = read_image(entry.path());
            const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
            CHECK(took.count() < 5);  // the slowest took 9 s and 3 GB before headers were checked
            ++(map ? read : refused);
            if (map) CHECK(map->pixels.allFinite());
            if (name.starts_with("invalid-") && name != "invalid-palette.png")
                CHECK_FALSE(map.has_value());
            if (std::string(kind) == "tiff" ||
                (std::string(kind) == "png" && !name.starts_with("invalid-")))
                CHECK(map.has_value());
        }
    }
    MESSAGE(read << " read, " << refused << " refused, " << skipped
                 << " of 3 folders skipped; peak " << peak_megabytes() << " MB");
    CHECK(peak_megabytes() < kPeakLimit);
}

TEST_CASE("float pictures come back bit for bit, PNG within half a step") {
    const TempDir dir;
    Random random(42);
    for (int channels = 1; channels <= 4; ++channels) {
        Image image{17, 9, channels, {}};
        for (int k = 0; k < 17 * 9 * channels; ++k)
            image.pixels.push_back(static_cast<float>(random.uniform(0, 1)));
        for (const char* name : {"f.exr", "f.tif"}) {
            REQUIRE(write_image(dir / name, image).has_value());
            const auto back = read_image(dir / name);
            REQUIRE(back.has_value());
            CHECK(back->channels == channels);
            CHECK(back->pixels == image.pixels);
        }
        const auto ok =
            write_image(dir / "p.png", image, {.linear_to_srgb = false, .dither = false});
        REQUIRE_MESSAGE(ok.has_value(), (ok ? "" : ok.error().message));
        const auto back = read_image(dir / "p.png");
        REQUIRE(back.has_value());
        REQUIRE(back->channels == channels);
        const float half_step = channels == 1 ? 0.5f / 65535 : 0.5f / 255;
        float worst = 0;
        for (std::size_t k = 0; k < image.pixels.size(); ++k)
            worst = std::max(worst, std::abs(image.pixels[k] - back->pixels[k]));
        CHECK(worst <= half_step * 1.001f);
    }
}

TEST_CASE("PNG is sRGB, and the dither keeps the mean between two steps") {
    const TempDir dir;
    Image image{64, 64, 3, std::vector<float>(64 * 64 * 3, 0.5f)};
    REQUIRE(write_image(dir / "s.png", image, {.dither = false}).has_value());
    auto back = read_image(dir / "s.png");
    REQUIRE(back.has_value());
    CHECK(double(back->at(5, 5, 1)) ==
          doctest::Approx(188 / 255.0));  // IEC 61966-2-1: 0.5 is 187.5
    std::fill(image.pixels.begin(), image.pixels.end(), 100.3f / 255);
    REQUIRE(write_image(dir / "d.png", image, {.linear_to_srgb = false}).has_value());
    back = read_image(dir / "d.png");
    double sum = 0, low = 1, high = 0;
    for (const float v : back->pixels) {
        sum += double(v);
        low = std::min(low, double(v));
        high = std::max(high, double(v));
    }
    // 64 thresholds per 8 x 8 block: the mean is right to 1/128 of a step.
    CHECK(std::abs(sum / double(back->pixels.size()) * 255 - 100.3) < 1.0 / 128 + 1e-4);
    CHECK(low == doctest::Approx(100 / 255.0));
    CHECK(high == doctest::Approx(101 / 255.0));
    // Out of range and NaN have a colour all the same.
    image.pixels[0] = -1;
    image.pixels[1] = 7;
    image.pixels[2] = std::numeric_limits<float>::quiet_NaN();
    REQUIRE(write_image(dir / "n.png", image).has_value());
    back = read_image(dir / "n.png");
    CHECK(back->pixels[0] == 0);
    CHECK(back->pixels[1] == 1);
    CHECK(back->pixels[2] == 0);
}

TEST_CASE("a failed write leaves nothing and keeps the old picture") {
    const TempDir dir;
    const Image image{2, 2, 1, {0, 1, 2, 3}};
    REQUIRE(write_image(dir / "kept.exr", image).has_value());
    const std::string before = read_bytes(dir / "kept.exr");
    CHECK(contains(write_image(dir / "none" / "a.exr", image).error().message,
                   "there is no directory"));
    CHECK(write_image(dir / "a.gif", image).error().kind == ErrorKind::usage);
    CHECK_FALSE(write_image(dir / "kept.exr", Image{2, 2, 1, {0}}).has_value());
    CHECK(write_image(dir / "five.png", Image{1, 1, 5, std::vector<float>(5)}).error().kind ==
          ErrorKind::usage);
    fs::create_directory(dir / "folder.png");
    CHECK(contains(write_image(dir / "folder.png", image).error().message, "is a directory"));
    fs::remove(dir / "folder.png");
    // A full disk: /dev/full takes no byte, but its directory cannot be written to by renaming
    // either.
    if (geteuid() != 0) {
        fs::permissions(dir.path(), fs::perms::owner_read | fs::perms::owner_exec);
        CHECK(contains(write_image(dir / "new.exr", image).error().message,
                       "cannot write into directory"));
        fs::permissions(dir.path(), fs::perms::owner_all);
    } else {
        MESSAGE("skipped: 1 check of an unwritable directory (root can write everywhere)");
    }
    CHECK(dir.names() == std::vector<std::string>{"kept.exr"});
    CHECK(read_bytes(dir / "kept.exr") == before);
}

TEST_CASE("a write that runs out of space leaves nothing and keeps the old picture") {
    // A file size limit of 64 KiB stands in for a full disk.
    const TempDir dir;
    Random random(43);
    const Image small{2, 2, 1, {0, 1, 2, 3}};
    Image large{256, 256, 3, {}};
    for (int k = 0; k < 256 * 256 * 3; ++k)
        large.pixels.push_back(static_cast<float>(random.uniform()));
    for (const char* name : {"full.exr", "full.tif", "full.png"}) {
        REQUIRE(write_image(dir / name, small).has_value());
        const std::string before = read_bytes(dir / name);
        rlimit old{};
        getrlimit(RLIMIT_FSIZE, &old);
        const auto ignored = std::signal(SIGXFSZ, SIG_IGN);
        const rlimit tight{65536, old.rlim_max};
        setrlimit(RLIMIT_FSIZE, &tight);
        const auto result = write_image(dir / name, large);
        setrlimit(RLIMIT_FSIZE, &old);
        std::signal(SIGXFSZ, ignored);
        CAPTURE(std::string(name));
        CHECK_FALSE(result.has_value());
        CHECK(read_bytes(dir / name) == before);
    }
    CHECK(dir.names() == std::vector<std::string>{"full.exr", "full.png", "full.tif"});
}

}  // namespace wavefog::test
