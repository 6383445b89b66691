// .wfog files from strangers: an error or a valid fog, never anything else. Run with the
// sanitizers.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "support/random.h"
#include "wavefog/fogmap/wfog.h"
#include "wfog/format.h"
#include "wfog_bytes.h"

namespace wavefog {
namespace {

using test::FileBytes;

/// One whose densities are companded: deep fog, promised by rays.
FileBytes companded_file() {
    Grid<float> map(20, 30);
    for (Eigen::Index i = 0; i < map.size(); ++i) map.data()[i] = 1 + std::sin(float(i * i % 1009));
    auto fog = make_fog(map, {.degree = 1, .levels = 2});
    REQUIRE(fog.has_value());
    WfogOptions options;
    options.promise = WfogOptions::Promise::max_transmittance_error;
    options.error = 0.05;
    options.path = 50;
    const auto file = encode_wfog(*fog, options, &map);
    if (!file) FAIL(file.error().message);
    const auto chunks = wfog::read_chunks(file->bytes, false);
    REQUIRE(chunks.has_value());
    REQUIRE(chunks->head.scale.kind == wfog::Scale::Kind::companded);
    return file->bytes;
}

/// Small files of every coder, scale and content.
std::vector<FileBytes> samples() {
    std::vector<FileBytes> files;
    const auto add = [&](const Grid<float>& map, const WfogOptions& options, bool exact = true) {
        const auto fog = make_fog(map, {.degree = 1, .levels = 2});
        REQUIRE(fog.has_value());
        Fog changed = *fog;
        if (!exact) changed.decomposition.details[0].psi_psi.values += 0.001f;
        const auto file = encode_wfog(changed, options, exact ? &map : nullptr);
        if (!file) FAIL(file.error().message);
        files.push_back(file->bytes);
    };
    Grid<float> ramp(24, 40), floats(13, 11), few(32, 32);
    for (Eigen::Index j = 0; j < ramp.rows(); ++j)
        for (Eigen::Index i = 0; i < ramp.cols(); ++i)
            ramp(j, i) = float((i * 5 + j * j) % 256) / 255;
    for (Eigen::Index i = 0; i < floats.size(); ++i) floats.data()[i] = std::sin(float(i)) + 1.5f;
    for (Eigen::Index i = 0; i < few.size(); ++i) few.data()[i] = std::sqrt(float((i / 7) % 5));
    Grid<float> large(129, 130);
    for (Eigen::Index j = 0; j < large.rows(); ++j)
        for (Eigen::Index i = 0; i < large.cols(); ++i)
            large(j, i) = float((i + j) / 4 % 256) / 255;
    WfogOptions lossy;
    lossy.promise = WfogOptions::Promise::max_error;
    lossy.error = 0.02;
    add(ramp, {});
    add(ramp, lossy);
    add(floats, {});
    add(floats, lossy);
    add(floats, {}, false);
    add(few, {});
    add(large, lossy);
    add(Grid<float>::Constant(3, 3, 0.5f), {});
    Grid<float> smooth(60, 50);  // coarse levels get bounds of their own
    for (Eigen::Index j = 0; j < smooth.rows(); ++j)
        for (Eigen::Index i = 0; i < smooth.cols(); ++i)
            smooth(j, i) = 1 + std::sin(float(i) * 0.1f) * std::cos(float(j) * 0.08f);
    add(smooth, lossy);
    Grid<float> apart(31, 26);  // ranks
    for (Eigen::Index i = 0; i < apart.size(); ++i) apart.data()[i] = float((i / 9) % 4 * 70) / 255;
    add(apart, {});
    for (Eigen::Index i = 0; i < large.size(); ++i)
        large.data()[i] = float((i / 5) % 3 * 100) / 255;
    add(large, {});
    files.push_back(companded_file());
    return files;
}

/// Decodes; what comes out is an error or passes validate().
bool opens(const FileBytes& file, bool partial = false) {
    WfogLimits limits;
    limits.max_map_bytes = 4 << 20;
    limits.partial = partial;
    limits.threads = 1;
    const auto decoded = decode_wfog(file, limits);
    if (!decoded) {
        CHECK_FALSE(decoded.error().message.empty());
        return false;
    }
    CHECK(decoded->fog.validate().has_value());
    CHECK(decoded->map.allFinite());
    return true;
}

std::string error_of(const FileBytes& file) {
    const auto decoded = decode_wfog(file);
    return decoded ? "" : decoded.error().message;
}

bool contains(const std::string& text, const std::string& part) {
    return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("wfog: every truncation, every flipped bit and every further byte is an error") {
    for (const FileBytes& file : samples()) {
        if (file.size() > 3000) continue;
        CHECK(opens(file));
        for (std::size_t size = 0; size < file.size(); ++size)
            CHECK_FALSE(opens(FileBytes(file.begin(), file.begin() + std::ptrdiff_t(size))));
        for (std::size_t bit = 0; bit < 8 * file.size(); ++bit) {
            FileBytes flipped = file;
            flipped[bit / 8] = std::uint8_t(flipped[bit / 8] ^ (1u << (bit % 8)));
            const bool opened = opens(flipped);
            // The checksum misses nothing; the first five bytes are checked themselves.
            CHECK_FALSE(opened);
        }
        for (const int more : {0, 1, int('S'), int('s'), 255}) {
            FileBytes longer = file;
            longer.push_back(std::uint8_t(more));
            CHECK_FALSE(opens(longer));
            // Nor is it one that ends early: all levels are there.
            WfogLimits partial;
            partial.partial = true;
            CHECK_FALSE(decode_wfog(longer, partial).has_value());
        }
    }
}

TEST_CASE("wfog: damage behind right checksums is an error or a valid fog") {
    test::Random random(4711);
    for (const FileBytes& file : samples()) {
        for (int trial = 0; trial < 400; ++trial) {
            FileBytes damaged = file;
            for (int n = random.integer(1, 4); n > 0; --n) {
                // Heads are short and matter most.
                const int last = int(damaged.size()) - 1;
                const int at = random.integer(5, random.integer(0, 1) ? std::min(70, last) : last);
                damaged[std::size_t(at)] = std::uint8_t(random.integer(0, 255));
            }
            test::repair_checksums(damaged);
            opens(damaged, trial % 2 == 0);
        }
        // Chunks left out, doubled and in another order.
        const auto starts = test::chunk_starts(file);
        for (std::size_t a = 0; a + 1 < starts.size(); ++a)
            for (std::size_t b = 0; b + 1 < starts.size(); ++b) {
                FileBytes shuffled(file.begin(), file.begin() + 5);
                for (std::size_t i = 0; i + 1 < starts.size(); ++i) {
                    const std::size_t from = i == a ? b : i == b ? a : i;
                    shuffled.insert(shuffled.end(), file.begin() + std::ptrdiff_t(starts[from]),
                                    file.begin() + std::ptrdiff_t(starts[from + 1]));
                }
                opens(shuffled);
            }
    }
}

TEST_CASE("wfog: wrong magic, wrong version and sizes that lie are told apart") {
    const FileBytes file = samples().front();
    FileBytes other = file;
    other[0] = 'X';
    CHECK(contains(error_of(other), "is no .wfog file"));
    CHECK(contains(error_of({}), "is no .wfog file"));
    other = file;
    other[4] = 2;
    CHECK(contains(error_of(other), "format version 2"));
    other[4] = 0;
    CHECK(contains(error_of(other), "version is 0, which does not exist"));

    // 65536 x 65536 pixels in a few bytes.
    const auto starts = test::chunk_starts(file);
    const FileBytes head(file.begin() + std::ptrdiff_t(starts[0]) + 2,
                         file.begin() + std::ptrdiff_t(starts[1]) - 4);
    const auto with_size = [&](const FileBytes& size) {
        FileBytes payload = size;
        payload.insert(payload.end(), head.begin() + 2, head.end());  // 40 and 24 are a byte each
        FileBytes lie(file.begin(), file.begin() + 5);
        const FileBytes chunk = test::make_chunk('F', payload);
        lie.insert(lie.end(), chunk.begin(), chunk.end());
        lie.insert(lie.end(), file.begin() + std::ptrdiff_t(starts[1]), file.end());
        return lie;
    };
    CHECK(opens(with_size({40, 24})));
    CHECK(contains(error_of(with_size({0x80, 0x80, 0x04, 0x80, 0x80, 0x04})), "above the limit"));
    CHECK(contains(error_of(with_size({0x81, 0x80, 0x04, 24})), "size is impossible"));
    CHECK(contains(error_of(with_size({0, 24})), "size is impossible"));
    CHECK_FALSE(opens(with_size({0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x7f, 24})));
    opens(with_size({0x80, 0x08, 24}));  // 1024 x 24: decodes to something, or an error
}

TEST_CASE("wfog: ranks that do not rise, or are too few or too many, are refused") {
    // One tile; its values are 0, 70, 140 and 210 steps of 1/255.
    Grid<float> map(31, 26);
    for (Eigen::Index i = 0; i < map.size(); ++i) map.data()[i] = float((i / 9) % 4 * 70) / 255;
    const auto fog = make_fog(map, {});
    REQUIRE(fog.has_value());
    const auto encoded = encode_wfog(*fog, {}, &map);
    REQUIRE(encoded.has_value());
    const FileBytes& file = encoded->bytes;
    const auto starts = test::chunk_starts(file);
    const auto at = [&](std::size_t chunk, int more) {
        return file.begin() + std::ptrdiff_t(starts[chunk]) + more;
    };
    // Type and length come before, a checksum behind: coder, low, how many, their differences.
    const FileBytes payload(at(1, 2), at(2, -4));
    REQUIRE((payload[0] & 8) != 0);
    REQUIRE(FileBytes(payload.begin() + 1, payload.begin() + 6) == FileBytes{0, 4, 70, 70, 70});
    const auto with_table = [&](const FileBytes& table) {
        FileBytes changed = {payload[0]};
        changed.insert(changed.end(), table.begin(), table.end());
        changed.insert(changed.end(), payload.begin() + 6, payload.end());
        FileBytes other(file.begin(), at(1, 0));
        const FileBytes chunk = test::make_chunk('S', changed);
        other.insert(other.end(), chunk.begin(), chunk.end());
        other.insert(other.end(), at(2, 0), file.end());
        return other;
    };
    CHECK(opens(with_table({0, 4, 70, 70, 70})));
    CHECK(opens(with_table({0, 4, 70, 1, 70})));
    CHECK_FALSE(opens(with_table({0, 4, 70, 0, 70})));
    CHECK_FALSE(opens(with_table({0, 0})));
    CHECK_FALSE(opens(with_table({0, 1})));
    CHECK_FALSE(opens(with_table({0, 0x81, 0x80, 0x04, 70, 70, 70})));      // 65537
    CHECK_FALSE(opens(with_table({0, 4, 70, 0x81, 0x80, 0x04, 70})));       // 65537 further
    CHECK_FALSE(opens(with_table({0xf4, 0xff, 0xff, 0xff, 0x0f, 2, 70})));  // past 2^31 - 1
    CHECK(opens(with_table({0xf4, 0xff, 0xff, 0xff, 0x0f, 2, 5})));         // just there
    CHECK_FALSE(opens(with_table({0, 0x7f})));                              // 127, and fewer bytes
}

TEST_CASE("wfog: steps of companded densities that do not rise or overflow are refused") {
    const FileBytes file = companded_file();
    const auto chunks = wfog::read_chunks(file, false);
    REQUIRE(chunks.has_value());
    std::vector<wfog::Bytes> streams;
    for (const wfog::View stream : chunks->streams)
        streams.emplace_back(stream.begin(), stream.end());
    const auto with_scale = [&](double step, double growth) {
        wfog::Head head = chunks->head;
        head.scale.step = step;
        head.scale.growth = growth;
        return wfog::write_chunks(head, streams);
    };
    const auto [step, growth] = std::pair{chunks->head.scale.step, chunks->head.scale.growth};
    CHECK(with_scale(step, growth) == file);
    CHECK(opens(with_scale(step, 1e-300)));
    CHECK(opens(with_scale(1e-300, growth)));
    const double infinity = std::numeric_limits<double>::infinity();
    const double nan = std::numeric_limits<double>::quiet_NaN();
    for (const double wrong : {0.0, -0.0, -growth, 1.0000001, infinity, -infinity, nan})
        CHECK(contains(error_of(with_scale(step, wrong)), "growth of the steps is impossible"));
    for (const double wrong : {0.0, -step, infinity, -infinity, nan})
        CHECK(contains(error_of(with_scale(wrong, growth)), "step is impossible"));
    for (const auto& [large, more] : {std::pair{1e38, growth}, {1e308, 1.0}})
        CHECK(contains(error_of(with_scale(large, more)), "a density is not finite"));

    // A kind that is not known yet.
    wfog::Head head = chunks->head;
    head.scale = {.kind = static_cast<wfog::Scale::Kind>(5)};
    CHECK(contains(error_of(wfog::write_chunks(head, streams)), "scale 5"));
}

TEST_CASE("wfog: unknown optional chunks are skipped, unknown required ones refused") {
    const FileBytes file = samples().front();
    const auto starts = test::chunk_starts(file);
    for (std::size_t i = 1; i < starts.size(); ++i) {
        for (const char type : {'x', 'a', 'z'}) {
            FileBytes more = file;
            const FileBytes chunk = test::make_chunk(type, {1, 2, 3});
            more.insert(more.begin() + std::ptrdiff_t(starts[i]), chunk.begin(), chunk.end());
            CHECK(opens(more));
        }
        FileBytes more = file;
        const FileBytes chunk = test::make_chunk('X', {1, 2, 3});
        more.insert(more.begin() + std::ptrdiff_t(starts[i]), chunk.begin(), chunk.end());
        CHECK(contains(error_of(more), "feature 'X'"));
    }
}

TEST_CASE("wfog: sides up to 65536") {
    for (const auto& [w, h] : {std::pair{65536, 2}, {1, 65536}}) {
        Grid<float> map(h, w);
        for (Eigen::Index i = 0; i < map.size(); ++i) map.data()[i] = float(i / 100 % 256) / 255;
        const auto fog = make_fog(map, {});
        REQUIRE(fog.has_value());
        const auto file = encode_wfog(*fog, {}, &map);
        REQUIRE(file.has_value());
        const auto back = decode_wfog(file->bytes);
        REQUIRE(back.has_value());
        CHECK((back->map == map).all());
    }
    const Grid<float> wide = Grid<float>::Zero(1, 65537);
    const auto fog = make_fog(wide, {});
    REQUIRE(fog.has_value());
    const auto file = encode_wfog(*fog, {}, &wide);
    REQUIRE_FALSE(file.has_value());
    CHECK(contains(file.error().message, "at most 65536"));
}

}  // namespace wavefog
