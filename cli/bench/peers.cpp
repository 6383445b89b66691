// Codecs of other projects, as programs, and JPEG-LS and zfp as libraries.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "bench/compression.h"
#ifdef WAVEFOG_HAS_CHARLS
#include <charls/charls.h>
#endif
#ifdef WAVEFOG_HAS_ZFP
#include <zfp.h>

#include <memory>
#endif

namespace wavefog::cli {
namespace {

namespace fs = std::filesystem;

/// Programs turn in.pgm into `packed`, and that into out.pgm, in the folder where they run.
struct Program {
    const char *name, *binary, *packed, *encode, *decode;
};
constexpr Program programs[] = {
    {"JPEG XL e9", "cjxl", "p.jxl", "cjxl in.pgm p.jxl -d 0 -e 9 --num_threads=0",
     "djxl p.jxl out.pgm --num_threads=0"},
    {"JPEG XL e7", "cjxl", "p.jxl", "cjxl in.pgm p.jxl -d 0 -e 7 --num_threads=0",
     "djxl p.jxl out.pgm --num_threads=0"},
    {"JPEG 2000 5/3", "opj_compress", "p.j2k", "opj_compress -i in.pgm -o p.j2k -threads 1",
     "opj_decompress -i p.j2k -o out.pgm -threads 1"},
    {"PNG", "pnmtopng", "p.png", "pnmtopng -force -compression 9 in.pgm > p.png",
     "pngtopnm p.png > out.pgm"},
    {"zstd -19", "zstd", "p.zst", "zstd -19 -f -q --single-thread in.pgm -o p.zst",
     "zstd -d -f -q p.zst -o out.pgm"},
};
constexpr const char* jpeg_ls = "JPEG-LS";

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

bool installed(const char* binary) {
    return std::system(fmt::format("command -v {} >/dev/null 2>&1", binary).c_str()) == 0;
}

/// 8 bits a pixel if that is enough, else 16 with the high byte first.
std::string pgm_of(const Prequantised& input) {
    const Grid<std::uint16_t>& g = input.indices;
    const int most = input.largest < 256 ? 255 : 65535;
    std::string pgm = fmt::format("P5\n{} {}\n{}\n", g.cols(), g.rows(), most);
    for (Eigen::Index i = 0; i < g.size(); ++i) {
        if (most > 255) pgm += static_cast<char>(g.data()[i] >> 8);
        pgm += static_cast<char>(g.data()[i] & 0xff);
    }
    return pgm;
}

std::string read_all(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

Result<CodecRun> run_program(const Program& program, const Prequantised& input,
                             const fs::path& folder) {
    const std::string pgm = pgm_of(input);
    std::ofstream(folder / "in.pgm", std::ios::binary) << pgm;
    CodecRun run;
    for (const auto& [line, seconds] :
         {std::pair{program.encode, &run.encode_s}, std::pair{program.decode, &run.decode_s}}) {
        const auto start = std::chrono::steady_clock::now();
        const std::string quiet =
            std::string(line).find('>') == std::string::npos ? " >/dev/null 2>&1" : " 2>/dev/null";
        if (std::system(fmt::format("cd '{}' && {}{}", folder.string(), line, quiet).c_str()) != 0)
            return data_error(fmt::format("{}: `{}` failed", program.name, line));
        *seconds = seconds_since(start);
    }
    run.bytes = static_cast<std::size_t>(fs::file_size(folder / program.packed));
    // Headers differ; the pixels stand at the end.
    const std::string out = read_all(folder / "out.pgm");
    const std::size_t pixels =
        static_cast<std::size_t>(input.indices.size()) * (input.largest < 256 ? 1 : 2);
    if (out.size() < pixels ||
        out.compare(out.size() - pixels, pixels, pgm, pgm.size() - pixels, pixels) != 0)
        return data_error(fmt::format("{}: does not give its input back", program.name));
    return run;
}

#ifdef WAVEFOG_HAS_CHARLS
Result<CodecRun> run_jpeg_ls(const Prequantised& input) {
    const Grid<std::uint16_t>& g = input.indices;
    const bool wide = input.largest > 255;
    std::vector<std::uint8_t> narrow(static_cast<std::size_t>(g.size()) * (wide ? 2 : 1));
    for (Eigen::Index i = 0; i < g.size(); ++i) {
        if (wide) {
            narrow[std::size_t(2 * i)] = std::uint8_t(g.data()[i] & 0xff);
            narrow[std::size_t(2 * i + 1)] = std::uint8_t(g.data()[i] >> 8);
        } else {
            narrow[std::size_t(i)] = std::uint8_t(g.data()[i]);
        }
    }
    int bits = 2;
    while ((1 << bits) <= input.largest) ++bits;
    CodecRun run;
    try {
        auto start = std::chrono::steady_clock::now();
        charls::jpegls_encoder encoder;
        encoder.frame_info(
            {static_cast<std::uint32_t>(g.cols()), static_cast<std::uint32_t>(g.rows()), bits, 1});
        std::vector<std::uint8_t> packed(encoder.estimated_destination_size() + 1024);
        encoder.destination(packed);
        run.bytes = encoder.encode(narrow);
        run.encode_s = seconds_since(start);
        packed.resize(run.bytes);
        start = std::chrono::steady_clock::now();
        charls::jpegls_decoder decoder(packed, true);
        std::vector<std::uint8_t> back(decoder.destination_size());
        decoder.decode(back);
        run.decode_s = seconds_since(start);
        if (back != narrow) return data_error("JPEG-LS: does not give its input back");
    } catch (const charls::jpegls_error& error) {
        return data_error(fmt::format("JPEG-LS: {}", error.what()));
    }
    return run;
}
#endif

/// Steps of the picture that a pixel may be off by.
double allowed_steps(const CodecMap& map, double error) {
    return std::floor(error / 255 * map.full_scale * map.steps + 1e-9);
}

#ifdef WAVEFOG_HAS_ZFP
Result<CodecRun> run_zfp(const CodecMap& map, double error) {
    const float steps = map.steps > 0 ? float(map.steps) : 1.0f;
    Grid<float> values = map.densities * steps;
    if (map.steps > 0) values = values.round();
    // Half a step is free where the decoder rounds.
    const double tolerance =
        map.steps > 0 ? allowed_steps(map, error) + 0.4999 : error / 255 * map.full_scale;
    const std::unique_ptr<zfp_stream, void (*)(zfp_stream*)> stream(zfp_stream_open(nullptr),
                                                                    zfp_stream_close);
    if (error > 0)
        zfp_stream_set_accuracy(stream.get(), tolerance);
    else
        zfp_stream_set_reversible(stream.get());
    const auto width = std::size_t(values.cols()), height = std::size_t(values.rows());
    const auto field_of = [&](Grid<float>& grid) {
        return std::unique_ptr<zfp_field, void (*)(zfp_field*)>(
            zfp_field_2d(grid.data(), zfp_type_float, width, height), zfp_field_free);
    };
    CodecRun run;
    auto start = std::chrono::steady_clock::now();
    const auto field = field_of(values);
    std::vector<std::uint8_t> packed(zfp_stream_maximum_size(stream.get(), field.get()));
    const std::unique_ptr<bitstream, void (*)(bitstream*)> bits(
        stream_open(packed.data(), packed.size()), stream_close);
    zfp_stream_set_bit_stream(stream.get(), bits.get());
    zfp_stream_rewind(stream.get());
    run.bytes = zfp_compress(stream.get(), field.get());
    run.encode_s = seconds_since(start);
    start = std::chrono::steady_clock::now();
    run.densities.resize(values.rows(), values.cols());
    const auto back = field_of(run.densities);
    zfp_stream_rewind(stream.get());
    if (run.bytes == 0 || zfp_decompress(stream.get(), back.get()) == 0)
        return data_error("zfp: does not give its input back");
    run.decode_s = seconds_since(start);
    if (map.steps > 0) run.densities = run.densities.round() / steps;
    return run;
}
#endif

}  // namespace

std::optional<Prequantised> prequantise(const CodecMap& map, double error) {
    if (map.steps == 0 && error == 0) return {};
    const double least = double(map.densities.minCoeff());
    // Integers: units of one step of the picture.
    const double unit = map.steps > 0 ? 1.0 / map.steps : 1;
    const double width =
        map.steps > 0 ? 2 * allowed_steps(map, error) + 1 : 2 * error / 255 * map.full_scale;
    const double origin = map.steps > 0 ? 0 : least;
    Prequantised result;
    result.indices.resize(map.densities.rows(), map.densities.cols());
    result.densities.resize(map.densities.rows(), map.densities.cols());
    for (Eigen::Index i = 0; i < map.densities.size(); ++i) {
        const double value = (double(map.densities.data()[i]) - origin) / unit;
        const double index = std::floor((map.steps > 0 ? std::round(value) : value) / width + 0.5);
        if (index > 65535) return {};
        result.indices.data()[i] = static_cast<std::uint16_t>(index);
        result.largest = std::max(result.largest, static_cast<int>(index));
        result.densities.data()[i] = static_cast<float>(origin + index * width * unit);
    }
    return result;
}

std::vector<std::string> installed_peers() {
    std::vector<std::string> names;
    for (const Program& program : programs)
        if (installed(program.binary)) names.emplace_back(program.name);
#ifdef WAVEFOG_HAS_CHARLS
    names.emplace_back(jpeg_ls);
#endif
#ifdef WAVEFOG_HAS_ZFP
    names.emplace_back(zfp_name);
#endif
    return names;
}

Result<CodecRun> run_peer(const std::string& peer, [[maybe_unused]] const CodecMap& map,
                          [[maybe_unused]] double error, const Prequantised& input,
                          const fs::path& folder) {
#ifdef WAVEFOG_HAS_ZFP
    if (peer == zfp_name) return run_zfp(map, error);
#endif
    Result<CodecRun> run = usage_error(fmt::format("there is no codec '{}'", peer));
#ifdef WAVEFOG_HAS_CHARLS
    if (peer == jpeg_ls) run = run_jpeg_ls(input);
#endif
    for (const Program& program : programs)
        if (peer == program.name) run = run_program(program, input, folder);
    if (run) run->densities = input.densities;
    return run;
}

}  // namespace wavefog::cli
