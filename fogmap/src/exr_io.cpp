#include "exr_io.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "container_check.h"
#include "file_io.h"

namespace wavefog::detail {

using nlohmann::json;

namespace {

constexpr const char* kChannels[4] = {"R", "G", "B", "A"};
constexpr const char* kPrefix = "wavefog.";
constexpr std::size_t kMaxBytes = std::size_t{4} << 30;  // as float, one channel: as read_fogmap

void set_attributes(Imf::Header& header, const json& attributes) {
    for (const auto& [key, value] : attributes.items()) {
        const std::string name = kPrefix + key;
        if (value.is_string())
            header.insert(name, Imf::StringAttribute(value.get<std::string>()));
        else if (value.is_number_integer())
            header.insert(name, Imf::IntAttribute(value.get<int>()));
        else if (value.is_number())
            header.insert(name, Imf::DoubleAttribute(value.get<double>()));
        else
            header.insert(name, Imf::StringAttribute(value.dump()));
    }
}

json get_attributes(const Imf::Header& header) {
    json attributes = json::object();
    const std::string prefix = kPrefix;
    for (auto it = header.begin(); it != header.end(); ++it) {
        const std::string name = it.name();
        if (!name.starts_with(prefix)) continue;
        json& value = attributes[name.substr(prefix.size())];
        if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute())) {
            const bool compound = text->value().starts_with('[') || text->value().starts_with('{');
            value = compound ? json::parse(text->value()) : json(text->value());
        } else if (const auto* integer = dynamic_cast<const Imf::IntAttribute*>(&it.attribute())) {
            value = integer->value();
        } else if (const auto* number =
                       dynamic_cast<const Imf::DoubleAttribute*>(&it.attribute())) {
            value = number->value();
        }
    }
    return attributes;
}

/// A frame buffer over interleaved RGBA values of type T.
template <class T>
Imf::FrameBuffer frame_buffer(T* rgba, int width, const Imath::V2i& origin, Imf::PixelType type) {
    const std::size_t texel = 4 * sizeof(T), row = texel * static_cast<std::size_t>(width);
    Imf::FrameBuffer buffer;
    for (int c = 0; c < 4; ++c)
        buffer.insert(kChannels[c],
                      Imf::Slice::Make(type, rgba + c, origin, width, 1 << 30, texel, row));
    return buffer;
}

Imf::Header make_header(const ExrImage& image, const Imath::Box2i& display, bool half,
                        const json& attributes) {
    Imf::Header header(display, Imath::Box2i({0, 0}, {image.width - 1, image.height - 1}));
    header.compression() = Imf::ZIP_COMPRESSION;
    for (const char* channel : kChannels)
        header.channels().insert(channel, Imf::Channel(half ? Imf::HALF : Imf::FLOAT));
    if (!image.name.empty()) header.setName(image.name);
    set_attributes(header, attributes);
    return header;
}

template <class Output>
void write_pixels(Output& output, const ExrImage& image, bool half) {
    // The library takes pixels of the file's own type only.
    if (half) {
        std::vector<Imath::half> halves(image.rgba.begin(), image.rgba.end());
        output.setFrameBuffer(frame_buffer(halves.data(), image.width, {0, 0}, Imf::HALF));
        output.writePixels(image.height);
    } else {
        output.setFrameBuffer(
            frame_buffer(const_cast<float*>(image.rgba.data()), image.width, {0, 0}, Imf::FLOAT));
        output.writePixels(image.height);
    }
}

void read_pixels(Imf::MultiPartInputFile& input, int part, ExrImage& image) {
    Imf::InputPart pixels(input, part);
    const Imath::Box2i window = pixels.header().dataWindow();
    image.rgba.resize(4 * static_cast<std::size_t>(image.width) *
                      static_cast<std::size_t>(image.height));
    pixels.setFrameBuffer(frame_buffer(image.rgba.data(), image.width, window.min, Imf::FLOAT));
    pixels.readPixels(window.min.y, window.max.y);
}

std::string refusal(const Imf::Header& header) {
    if (header.hasType() && header.type() != Imf::SCANLINEIMAGE)
        return "its parts are not scanline images";
    for (const char* channel : kChannels) {
        const Imf::Channel* const found = header.channels().findChannel(channel);
        if (!found) return fmt::format("it has no channel {}", channel);
        if (found->xSampling != 1 || found->ySampling != 1) return "its channels are subsampled";
    }
    return {};
}

}  // namespace

Result<void> write_exr(const std::filesystem::path& file, std::span<const ExrImage> images,
                       bool half, const json& attributes) {
    try {
        Imath::Box2i display({0, 0}, {0, 0});  // the parts of one file must agree on it
        for (const ExrImage& image : images) {
            display.max.x = std::max(display.max.x, image.width - 1);
            display.max.y = std::max(display.max.y, image.height - 1);
        }
        if (images.size() == 1) {
            Imf::OutputFile output(file.c_str(), make_header(images[0], display, half, attributes));
            write_pixels(output, images[0], half);
            return {};
        }
        std::vector<Imf::Header> headers;
        for (const ExrImage& image : images) {
            headers.push_back(make_header(image, display, half, attributes));
            headers.back().setType(Imf::SCANLINEIMAGE);
        }
        Imf::MultiPartOutputFile output(file.c_str(), headers.data(),
                                        static_cast<int>(headers.size()));
        for (std::size_t part = 0; part < images.size(); ++part) {
            Imf::OutputPart pixels(output, static_cast<int>(part));
            write_pixels(pixels, images[part], half);
        }
        return {};
    } catch (const std::exception& error) {
        return data_error(fmt::format("{}: cannot be written ({}); check space and permissions",
                                      file.string(), error.what()));
    }
}

Result<ExrFile> read_exr(const std::filesystem::path& file, bool pixels) {
    if (const auto ok = check_is_file(file); !ok) return tl::unexpected(ok.error());
    if (const auto ok = check_container(file, kMaxBytes); !ok) return tl::unexpected(ok.error());
    try {
        Imf::MultiPartInputFile input(file.c_str());
        ExrFile result;
        result.attributes = get_attributes(input.header(0));
        for (int part = 0; part < input.parts(); ++part) {
            const Imf::Header& header = input.header(part);
            const Imath::Box2i window = header.dataWindow();
            ExrImage image;
            image.name = header.hasName() ? header.name() : "";
            image.width = window.max.x - window.min.x + 1;
            image.height = window.max.y - window.min.y + 1;
            if (pixels) {
                if (const std::string why = refusal(header); !why.empty())
                    return data_error(fmt::format("{}: is no fog file: {}; convert the map again",
                                                  file.string(), why));
                read_pixels(input, part, image);
            }
            result.images.push_back(std::move(image));
        }
        return result;
    } catch (const std::bad_alloc&) {
        return data_error(fmt::format("{}: not enough memory to read it", file.string()));
    } catch (const std::exception& error) {
        return data_error(fmt::format("{}: damaged or truncated ({}); convert the map again",
                                      file.string(), error.what()));
    }
}

}  // namespace wavefog::detail
