#include "container_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <string>

#include "crc32.h"

namespace wavefog::detail {

namespace fs = std::filesystem;

namespace {

// No more than this many bytes come out of one stored byte: deflate's limit is 1032, Huffman-coded
// runs (PIZ) stay near 500; DWA, on blocks of zeros, reaches beyond.
constexpr double kMaxRatio = 2048, kMaxRatioDwa = 65536;
constexpr double kMaxTileBytes = 64 << 20;  // a tile that is larger than its picture

/// A file read forward, with its size known. Reads past the end return false.
class Bytes {
  public:
    explicit Bytes(const fs::path& file) : stream_(file, std::ios::binary) {
        stream_.seekg(0, std::ios::end);
        size_ = stream_ ? static_cast<std::uint64_t>(stream_.tellg()) : 0;
        stream_.seekg(0);
    }
    std::uint64_t size() const { return size_; }
    bool read(void* to, std::size_t count) {
        return bool(stream_.read(static_cast<char*>(to), static_cast<std::streamsize>(count)));
    }
    int byte() { return stream_.get(); }  // -1 at the end
    bool skip(std::uint64_t count) {
        return count <= size_ && stream_.seekg(static_cast<std::streamoff>(count), std::ios::cur) &&
               static_cast<std::uint64_t>(stream_.tellg()) <= size_;
    }

  private:
    std::ifstream stream_;
    std::uint64_t size_ = 0;
};

struct Check {
    std::string file;
    std::size_t max_bytes;

    tl::unexpected<Error> damaged(const std::string& why) const {
        return data_error(
            fmt::format("{}: damaged or truncated ({}); get the file again", file, why));
    }
    Result<void> size(double width, double height) const {
        const double bytes = width * height * double(sizeof(float));
        if (bytes > static_cast<double>(max_bytes))
            return data_error(
                fmt::format("{}: {:.0f} x {:.0f} pixels need {:.0f} MiB, above the limit of {:.0f} "
                            "MiB; scale the picture down",
                            file, width, height, bytes / (1 << 20),
                            static_cast<double>(max_bytes) / (1 << 20)));
        return {};
    }
};

// --- PNG: chunks of length, type, data, CRC-32 (PNG specification 5.3 and annex D).

std::uint32_t big_endian(const unsigned char* b) {
    return (std::uint32_t(b[0]) << 24) | (std::uint32_t(b[1]) << 16) | (std::uint32_t(b[2]) << 8) |
           b[3];
}

Result<void> check_png(Bytes& bytes, const Check& check) {
    std::uint64_t stored = 0;
    double width = 0, height = 0, bits = 0;
    std::array<unsigned char, 65536> buffer;
    for (bool first = true;; first = false) {
        unsigned char head[8], tail[4];
        if (!bytes.read(head, 8)) return check.damaged("the file ends before its IEND chunk");
        const std::uint32_t length = big_endian(head);
        const std::string type(reinterpret_cast<const char*>(head) + 4, 4);
        if (length > bytes.size()) return check.damaged("a chunk is longer than the file");
        std::uint32_t crc = update_crc(0xffffffffu, head + 4, 4);
        for (std::uint32_t left = length; left > 0;) {
            const auto part = std::min<std::size_t>(left, buffer.size());
            if (!bytes.read(buffer.data(), part)) return check.damaged("a chunk is cut off");
            crc = update_crc(crc, buffer.data(), part);
            left -= static_cast<std::uint32_t>(part);
        }
        if (!bytes.read(tail, 4)) return check.damaged("a chunk is cut off");
        if (big_endian(tail) != (crc ^ 0xffffffffu))
            return check.damaged("chunk " + type + " has a wrong CRC");
        if (first) {
            if (type != "IHDR" || length != 13) return check.damaged("no IHDR chunk");
            constexpr int samples[7] = {1, 0, 3, 1, 2, 0, 4};
            width = big_endian(buffer.data());
            height = big_endian(buffer.data() + 4);
            bits = double(buffer[8]) * (buffer[9] < 7 ? samples[buffer[9]] : 0);
            if (const auto ok = check.size(width, height); !ok) return ok;
        }
        if (type == "IDAT") stored += length;
        if (type == "IEND") break;
    }
    if (width * height * bits / 8 > kMaxRatio * static_cast<double>(stored))
        return check.damaged(
            fmt::format("{} bytes cannot hold {} x {} pixels", stored, width, height));
    return {};
}

// --- JPEG: libjpeg fills what is missing with grey, so look for the end-of-image marker.

Result<void> check_jpeg(Bytes& bytes, const Check& check) {
    bool in_scan = false;
    for (;;) {
        int byte = bytes.byte();
        if (byte < 0) return check.damaged("the file ends before its end-of-image marker");
        if (byte != 0xff) {
            if (!in_scan) return check.damaged("no marker where one is due");
            continue;
        }
        while (byte == 0xff) byte = bytes.byte();  // fill bytes
        if (byte < 0) return check.damaged("the file ends before its end-of-image marker");
        if (byte == 0xd9) return {};
        if (byte == 0x00 || byte == 0x01 || (byte >= 0xd0 && byte <= 0xd8)) continue;  // no length
        const int high = bytes.byte(), low = bytes.byte();
        if (high < 0 || low < 0 ||
            !bytes.skip(static_cast<std::uint64_t>(std::max(0, high * 256 + low - 2))))
            return check.damaged("a segment is cut off");
        in_scan = in_scan || byte == 0xda;
    }
}

// --- EXR: the headers (openexr.com, "OpenEXR File Layout"), little-endian.

template <class T>
T little_endian(const std::string& data, std::size_t offset) {
    T value;
    std::memcpy(&value, data.data() + offset, sizeof value);
    return value;
}

bool read_name(Bytes& bytes, std::string& name) {
    name.clear();
    for (int c; (c = bytes.byte()) != 0;) {
        if (c < 0 || name.size() > 255) return false;
        name.push_back(static_cast<char>(c));
    }
    return true;
}

struct ExrHeader {
    std::string window, tiles, channels, compression;

    double bytes_per_pixel() const {
        // A name, then type, pLinear and padding, sampling in x and y: 16 bytes. Type 1 is half.
        double sum = 0;
        for (std::size_t at = 0; at < channels.size() && channels[at] != 0;) {
            at = channels.find('\0', at);
            if (at == std::string::npos || at + 17 > channels.size()) break;
            sum += little_endian<std::int32_t>(channels, at + 1) == 1 ? 2 : 4;
            at += 17;
        }
        return sum;
    }
};

/// False at the end of the file; `header` is left empty by the zero that ends a list of headers.
bool read_header(Bytes& bytes, ExrHeader& header) {
    std::string name, type;
    for (;;) {
        if (!read_name(bytes, name)) return false;
        if (name.empty()) return true;
        std::int32_t size = 0;
        if (!read_name(bytes, type) || !bytes.read(&size, 4) || size < 0) return false;
        std::string* const keep = name == "dataWindow"    ? &header.window
                                  : name == "tiles"       ? &header.tiles
                                  : name == "channels"    ? &header.channels
                                  : name == "compression" ? &header.compression
                                                          : nullptr;
        if (static_cast<std::uint64_t>(size) > bytes.size()) return false;
        if (!keep) {
            if (!bytes.skip(static_cast<std::uint64_t>(size))) return false;
            continue;
        }
        keep->resize(static_cast<std::size_t>(size));
        if (!bytes.read(keep->data(), keep->size())) return false;
    }
}

Result<void> check_exr_header(const ExrHeader& header, std::uint64_t file_size,
                              const Check& check) {
    if (header.window.size() != 16) return check.damaged("the header has no data window");
    double corner[4];
    for (std::size_t i = 0; i < 4; ++i)
        corner[i] = little_endian<std::int32_t>(header.window, 4 * i);
    const double width = corner[2] - corner[0] + 1, height = corner[3] - corner[1] + 1;
    if (width < 1 || height < 1) return check.damaged("the data window is empty");
    if (const auto ok = check.size(width, height); !ok) return ok;

    const double pixel = header.bytes_per_pixel();
    const int compression = header.compression.empty() ? 0 : header.compression[0];
    const double ratio = compression >= 8 ? kMaxRatioDwa : kMaxRatio;
    if (width * height * pixel > ratio * static_cast<double>(file_size))
        return check.damaged(
            fmt::format("{} bytes cannot hold {} x {} pixels", file_size, width, height));
    if (header.tiles.size() >= 8) {
        const double x = little_endian<std::uint32_t>(header.tiles, 0);
        const double y = little_endian<std::uint32_t>(header.tiles, 4);
        if (x * y * pixel > std::max(kMaxTileBytes, width * height * pixel))
            return check.damaged(fmt::format("tiles of {} x {} pixels in a picture of {} x {}", x,
                                             y, width, height));
    }
    return {};
}

Result<void> check_exr(Bytes& bytes, const Check& check) {
    std::uint32_t version = 0;
    if (!bytes.read(&version, 4)) return check.damaged("no header");
    const bool multi_part = (version & 0x1000) != 0;
    for (bool first = true;; first = false) {
        ExrHeader header;
        if (!read_header(bytes, header)) return check.damaged("the header is cut off");
        if (multi_part && !first && header.window.empty()) return {};
        if (const auto ok = check_exr_header(header, bytes.size(), check); !ok) return ok;
        if (!multi_part) return {};
    }
}

}  // namespace

Result<void> check_container(const fs::path& file, std::size_t max_bytes) {
    constexpr unsigned char png[] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
    constexpr unsigned char exr[] = {0x76, 0x2f, 0x31, 0x01};
    constexpr unsigned char jpeg[] = {0xff, 0xd8, 0xff};
    const Check check{file.string(), max_bytes};
    unsigned char magic[8] = {};
    {
        Bytes bytes(file);
        if (bytes.size() == 0)
            return data_error(
                fmt::format("{}: is empty or cannot be opened; check the file", check.file));
        bytes.read(magic, std::min<std::size_t>(8, bytes.size()));
    }
    Bytes bytes(file);
    if (std::equal(std::begin(png), std::end(png), magic)) {
        bytes.skip(8);
        return check_png(bytes, check);
    }
    if (std::equal(std::begin(exr), std::end(exr), magic)) {
        bytes.skip(4);
        return check_exr(bytes, check);
    }
    if (std::equal(std::begin(jpeg), std::end(jpeg), magic)) {
        bytes.skip(2);
        return check_jpeg(bytes, check);
    }
    return {};
}

}  // namespace wavefog::detail
