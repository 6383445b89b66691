#include <OpenImageIO/imageio.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Imath/half.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <new>

#include "container_check.h"
#include "file_io.h"
#include "wavefog/fogmap/image.h"

namespace wavefog {

namespace fs = std::filesystem;

namespace {

using OIIO::TypeDesc;

std::string lower(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

/// An open picture whose header has been checked.
struct Source {
    std::unique_ptr<OIIO::ImageInput> input;
    OIIO::ImageSpec spec;
};

std::string reason(const std::string& oiio_error) {
    std::string text = oiio_error.empty() ? "no reason given" : oiio_error;
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

/// `channels` held in memory for each pixel as float counts against the limit.
Result<Source> open_source(const fs::path& file, std::size_t max_bytes, bool all_channels) {
    if (const auto ok = detail::check_is_file(file); !ok) return tl::unexpected(ok.error());
    if (const auto ok = detail::check_container(file, max_bytes); !ok)
        return tl::unexpected(ok.error());

    // Alpha is ignored, so colours must not come multiplied by it.
    OIIO::ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", 1);
    Source source;
    source.input = OIIO::ImageInput::open(file.string(), &config);
    if (!source.input)
        return data_error(
            fmt::format("{}: cannot be read as an image ({}); convert it to PNG, TIFF or EXR",
                        file.string(), reason(OIIO::geterror())));
    const OIIO::ImageSpec& spec = source.spec = source.input->spec();
    if (spec.deep)
        return data_error(fmt::format("{}: is a deep image; flatten it first", file.string()));
    if (spec.depth > 1)
        return data_error(fmt::format("{}: is a volume of {} slices; a fogmap is one picture",
                                      file.string(), spec.depth));
    if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1)
        return data_error(fmt::format("{}: has no pixels ({} x {}, {} channels); use another file",
                                      file.string(), spec.width, spec.height, spec.nchannels));
    const double bytes = double(spec.width) * spec.height * (all_channels ? spec.nchannels : 1) *
                         double(sizeof(float));
    if (bytes > static_cast<double>(max_bytes))
        return data_error(
            fmt::format("{}: {} x {} pixels need {:.0f} MiB, above the limit of {:.0f} MiB; "
                        "scale the picture down",
                        file.string(), spec.width, spec.height, bytes / (1 << 20),
                        static_cast<double>(max_bytes) / (1 << 20)));
    if (source.input->seek_subimage(1, 0))
        return data_error(
            fmt::format("{}: holds several images; extract one (oiiotool {} --subimage 0 "
                        "-o one.exr)",
                        file.string(), file.string()));
    source.input->geterror();  // forget that there is no second image
    source.input->seek_subimage(0, 0);
    return source;
}

/// The stored numbers as double: integers divided by their type's maximum, floats as they are.
template <class T>
void widen(const std::byte* bytes, std::size_t count, double* out) {
    const T* const values = reinterpret_cast<const T*>(bytes);
    if constexpr (std::numeric_limits<T>::is_integer) {
        constexpr double largest = static_cast<double>(std::numeric_limits<T>::max());
        for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<double>(values[i]) / largest;
    } else {
        for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<double>(values[i]);
    }
}

bool widen(TypeDesc type, const std::byte* bytes, std::size_t count, double* out) {
    switch (type.basetype) {
        case TypeDesc::UINT8:
            widen<std::uint8_t>(bytes, count, out);
            return true;
        case TypeDesc::INT8:
            widen<std::int8_t>(bytes, count, out);
            return true;
        case TypeDesc::UINT16:
            widen<std::uint16_t>(bytes, count, out);
            return true;
        case TypeDesc::INT16:
            widen<std::int16_t>(bytes, count, out);
            return true;
        case TypeDesc::UINT32:
            widen<std::uint32_t>(bytes, count, out);
            return true;
        case TypeDesc::INT32:
            widen<std::int32_t>(bytes, count, out);
            return true;
        case TypeDesc::HALF: {
            const auto* values = reinterpret_cast<const Imath::half*>(bytes);
            for (std::size_t i = 0; i < count; ++i) out[i] = static_cast<double>(float(values[i]));
            return true;
        }
        case TypeDesc::FLOAT:
            widen<float>(bytes, count, out);
            return true;
        case TypeDesc::DOUBLE:
            widen<double>(bytes, count, out);
            return true;
        default:
            return false;
    }
}

/// Calls row(j, values) with the interleaved channels of every row, a block of rows in memory at a
/// time: a colour picture never takes more than the map it becomes.
template <class RowFunction>
Result<void> for_each_row(const fs::path& file, Source& source, RowFunction row) {
    const OIIO::ImageSpec& spec = source.spec;
    const TypeDesc type(static_cast<TypeDesc::BASETYPE>(spec.format.basetype));
    const std::size_t row_values = std::size_t(spec.width) * std::size_t(spec.nchannels);
    const int block = spec.tile_width > 0 ? spec.tile_height : std::min(spec.height, 64);
    std::vector<std::byte> bytes(row_values * type.size() *
                                 std::size_t(std::min(block, spec.height)));
    std::vector<double> values(row_values);
    for (int first = 0; first < spec.height; first += block) {
        const int last = std::min(first + block, spec.height);
        const bool ok =
            spec.tile_width > 0
                ? source.input->read_tiles(0, 0, spec.x, spec.x + spec.width, spec.y + first,
                                           spec.y + last, spec.z, spec.z + 1, 0, spec.nchannels,
                                           type, bytes.data())
                : source.input->read_scanlines(0, 0, spec.y + first, spec.y + last, spec.z, 0,
                                               spec.nchannels, type, bytes.data());
        if (!ok)
            return data_error(
                fmt::format("{}: damaged or truncated in rows {} to {} ({}); get the file "
                            "again",
                            file.string(), first, last - 1, reason(source.input->geterror())));
        for (int j = first; j < last; ++j) {
            const std::byte* from =
                bytes.data() + std::size_t(j - first) * row_values * type.size();
            if (!widen(type, from, row_values, values.data()))
                return data_error(
                    fmt::format("{}: pixels of type {} are not supported; convert the "
                                "picture to float",
                                file.string(), type.c_str()));
            row(j, values.data());
        }
    }
    return {};
}

/// Which channels make a fogmap's value, with their weights.
struct Mix {
    int channel[3] = {0, 0, 0};
    double weight[3] = {1, 0, 0};
    int count = 1;
};

Result<Mix> choose_channel(const fs::path& file, const OIIO::ImageSpec& spec,
                           const std::string& name) {
    const auto& names = spec.channelnames;
    int index = -1;
    const auto [stop, error] = std::from_chars(name.data(), name.data() + name.size(), index);
    if (error == std::errc() && stop == name.data() + name.size()) {
        if (index < 0 || index >= spec.nchannels) index = -1;
    } else {
        index = -1;
        for (int c = spec.nchannels - 1; c >= 0; --c)
            if (lower(names[std::size_t(c)]) == lower(name) &&
                (index < 0 || names[std::size_t(c)] == name))
                index = c;
    }
    if (index < 0)
        return data_error(
            fmt::format("{}: has no channel \"{}\"; choose one of {} or a number 0 to {}",
                        file.string(), name, fmt::join(names, ", "), spec.nchannels - 1));
    Mix mix;
    mix.channel[0] = index;
    return mix;
}

Result<Mix> choose_mix(const fs::path& file, const OIIO::ImageSpec& spec,
                       const std::optional<std::string>& name) {
    if (name) return choose_channel(file, spec, *name);
    Mix mix;
    int rgb[3] = {-1, -1, -1}, grey = -1, others = 0, last = 0;
    for (int c = 0; c < spec.nchannels; ++c) {
        const std::string channel = lower(spec.channelnames[std::size_t(c)]);
        if (c == spec.alpha_channel || c == spec.z_channel || channel == "a") continue;
        if (channel == "r") rgb[0] = c;
        if (channel == "g") rgb[1] = c;
        if (channel == "b") rgb[2] = c;
        if (channel == "y") grey = c;
        ++others;
        last = c;
    }
    if (rgb[0] >= 0 && rgb[1] >= 0 && rgb[2] >= 0) {
        // Rec. 709 luminance of the stored numbers: a fogmap is data, no sRGB curve is undone.
        constexpr double weights[3] = {0.2126, 0.7152, 0.0722};
        for (int c = 0; c < 3; ++c) {
            mix.channel[c] = rgb[c];
            mix.weight[c] = weights[c];
        }
        mix.count = 3;
        return mix;
    }
    if (grey >= 0 || others == 1) {
        mix.channel[0] = grey >= 0 ? grey : last;
        return mix;
    }
    if (others == 0 && spec.nchannels == 1) return mix;
    return data_error(
        fmt::format("{}: channels {} are neither grey nor RGB; choose one with --channel",
                    file.string(), fmt::join(spec.channelnames, ", ")));
}

struct BadPixel {
    int x = 0, y = 0;
    double value = 0;
    std::size_t count = 0;
};

Result<Fogmap> read_map(const fs::path& file, const ReadOptions& options) {
    auto source = open_source(file, options.max_bytes, false);
    if (!source) return tl::unexpected(source.error());
    const OIIO::ImageSpec& spec = source->spec;
    const auto mix = choose_mix(file, spec, options.channel);
    if (!mix) return tl::unexpected(mix.error());

    Fogmap map;
    map.pixels.resize(spec.height, spec.width);
    map.source_format =
        fmt::format("{} {}, {} channel{}", source->input->format_name(), spec.format.c_str(),
                    spec.nchannels, spec.nchannels == 1 ? "" : "s");
    BadPixel bad;
    const auto ok = for_each_row(file, *source, [&](int j, const double* row) {
        for (int i = 0; i < spec.width; ++i) {
            const double* const pixel = row + std::size_t(i) * std::size_t(spec.nchannels);
            double value = pixel[mix->channel[0]] * mix->weight[0];
            for (int c = 1; c < mix->count; ++c) value += pixel[mix->channel[c]] * mix->weight[c];
            // A double that float32 cannot hold becomes Inf here and is caught below.
            float stored = static_cast<float>(value);
            if (!(stored >= 0) || !std::isfinite(stored)) {
                if (bad.count++ == 0) bad = {i, j, value, 1};
                stored = 0;
            }
            map.pixels(j, i) = stored == 0 ? 0.0f : stored;  // no negative zero
        }
    });
    if (!ok) return tl::unexpected(ok.error());
    if (bad.count > 0 && !options.sanitize)
        return data_error(fmt::format(
            "{}: pixel ({}, {}) is {}, {} such pixel{} in all; a fogmap is finite "
            "and not negative: --sanitize (in a scene \"sanitize\": true) turns them into 0",
            file.string(), bad.x, bad.y, bad.value, bad.count, bad.count == 1 ? "" : "s"));
    map.sanitized = bad.count;
    return map;
}

Result<Image> read_all(const fs::path& file) {
    auto source = open_source(file, ReadOptions{}.max_bytes, true);
    if (!source) return tl::unexpected(source.error());
    const OIIO::ImageSpec& spec = source->spec;
    Image image{spec.width, spec.height, spec.nchannels, {}};
    const std::size_t row_values = std::size_t(spec.width) * std::size_t(spec.nchannels);
    image.pixels.resize(row_values * std::size_t(spec.height));
    const auto ok = for_each_row(file, *source, [&](int j, const double* row) {
        std::transform(row, row + row_values, image.pixels.begin() + std::ptrdiff_t(row_values) * j,
                       [](double value) { return static_cast<float>(value); });
    });
    if (!ok) return tl::unexpected(ok.error());
    return image;
}

/// Nothing that OpenImageIO or the allocator throws leaves the library.
template <class Function>
auto guarded(const fs::path& file, Function function) -> decltype(function()) {
    try {
        return function();
    } catch (const std::bad_alloc&) {
        return data_error(
            fmt::format("{}: not enough memory; scale the picture down", file.string()));
    } catch (const std::exception& error) {
        return data_error(fmt::format("{}: cannot be read as an image ({}); get the file again",
                                      file.string(), reason(error.what())));
    }
}

}  // namespace

Result<Fogmap> read_fogmap(const fs::path& file, const ReadOptions& options) {
    return guarded(file, [&] { return read_map(file, options); });
}

Result<Image> read_image(const fs::path& file) {
    return guarded(file, [&] { return read_all(file); });
}

}  // namespace wavefog
