#include "wavefog/gpu/depth_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "wavefog/gpu/pixel_rays.h"

namespace wavefog {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUnmeasured = -1;  // among metres

/// The first channel; the others must not differ.
Result<Image> one_channel(const Image& values) {
    Image one{values.width, values.height, 1, {}};
    one.pixels.reserve(values.pixels.size() / static_cast<std::size_t>(values.channels));
    for (int y = 0; y < values.height; ++y)
        for (int x = 0; x < values.width; ++x) {
            const float value = values.at(x, y, 0);
            for (int c = 1; c < std::min(values.channels, 3); ++c)
                if (values.at(x, y, c) != value &&
                    !(std::isnan(value) && std::isnan(values.at(x, y, c))))
                    return data_error(fmt::format(
                        "{} channels differ at pixel ({}, {}); give depth as one channel",
                        values.channels, x, y));
            one.pixels.push_back(value);
        }
    return one;
}

/// Depth-buffer values: only checked and counted.
Result<DepthPicture> from_gl(Image values, const Camera& camera) {
    DepthPicture picture{camera, std::move(values), 0, 0};
    const float sky = camera.depth == Camera::Depth::reversed ? 0.0f : 1.0f;
    for (int y = 0; y < picture.depth.height; ++y)
        for (int x = 0; x < picture.depth.width; ++x) {
            float& value = picture.depth.at(x, y, 0);
            if (std::isnan(value)) {
                ++picture.unmeasured;
                value = sky;
            } else if (std::isinf(value) || value == sky) {
                ++picture.background;
                value = sky;
            } else if (value < 0 || value > 1) {
                return data_error(
                    fmt::format("pixel ({}, {}) is {}; \"depth_values\": \"gl\" takes 0 to 1, so "
                                "choose \"metres\" or \"inverse\"",
                                x, y, value));
            }
        }
    return picture;
}

/// The farther one of the nearest measured pixels to the left and right.
void fill_rows(std::vector<double>& metres, std::size_t width) {
    for (std::size_t row = 0; row < metres.size(); row += width) {
        double before = kUnmeasured;
        for (std::size_t x = 0; x < width;) {
            std::size_t end = x;
            while (end < width && metres[row + end] == kUnmeasured) ++end;
            const double after = end < width ? metres[row + end] : kUnmeasured;
            std::fill(metres.begin() + std::ptrdiff_t(row + x),
                      metres.begin() + std::ptrdiff_t(row + end), std::max(before, after));
            if (end < width) before = after;
            x = end + 1;
        }
    }
}

}  // namespace

Result<DepthPicture> depth_for_fog(const Image& values, const CameraFile& file) {
    auto one = one_channel(values);
    if (!one) return tl::unexpected(one.error());
    if (file.depth.kind == DepthValues::Kind::gl) return from_gl(*std::move(one), file.camera);

    // Metres along the axis first; NaN and background are infinite.
    DepthPicture picture{file.camera, *std::move(one), 0, 0};
    const DepthValues& depth_values = file.depth;
    const int width = picture.depth.width, height = picture.depth.height;
    const bool perspective = file.camera.projection == Camera::Projection::perspective;
    const bool inverse = file.depth.kind == DepthValues::Kind::inverse;
    const PixelRays rays(file.camera, width, height);
    const Eigen::Vector3d axis = (file.camera.target - file.camera.eye).normalized();
    std::vector<double> metres(picture.depth.pixels.size());
    double nearest = kInfinity;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
            const double value = double(picture.depth.at(x, y, 0));
            double& m = metres[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                               static_cast<std::size_t>(x)];
            m = kInfinity;
            if (std::isnan(value) || (inverse ? std::isinf(value) : value == 0)) {
                ++picture.unmeasured;
                m = kUnmeasured;
                continue;
            }
            if (!(value + depth_values.offset >= 0))
                return data_error(fmt::format(
                    "pixel ({}, {}) is {}{}; depth is 0 or more, and infinite or NaN where nothing "
                    "is",
                    x, y, value,
                    depth_values.offset == 0
                        ? ""
                        : fmt::format(" (and \"depth_offset\" {})", depth_values.offset)));
            m = inverse ? depth_values.scale / (value + depth_values.offset)
                        : depth_values.scale * (value + depth_values.offset);
            if (perspective && file.depth.measured == DepthValues::Measured::distance) {
                const PixelRay ray = rays.at(x, y, 0.5);
                m *= (ray.end - ray.origin).normalized().dot(axis);
            }
            if (!(m < file.camera.far_plane)) {
                ++picture.background;
                m = kInfinity;
                continue;
            }
            nearest = std::min(nearest, m);
        }

    if (depth_values.unmeasured == DepthValues::Unmeasured::neighbours)
        fill_rows(metres, static_cast<std::size_t>(width));
    for (double& m : metres)
        if (m == kUnmeasured) m = kInfinity;

    // Any near plane in front of everything will do. (near / z - near / far) / (1 - near / far)
    // keeps the digits of z, which a standard depth buffer loses far away.
    Camera& camera = picture.camera;
    camera.depth = Camera::Depth::reversed;
    const double far = camera.far_plane;
    if (perspective) {
        camera.near_plane = std::isinf(nearest) ? 1 : nearest;
        if (!std::isinf(far)) camera.near_plane = std::min(camera.near_plane, far / 2);
    }
    const double near = camera.near_plane, ratio = std::isinf(far) ? 0 : near / far;
    for (std::size_t i = 0; i < metres.size(); ++i) {
        const double depth = std::isinf(metres[i]) ? 0
                             : perspective         ? (near / metres[i] - ratio) / (1 - ratio)
                                                   : (far - metres[i]) / (far - near);
        picture.depth.pixels[i] = static_cast<float>(std::clamp(depth, 0.0, 1.0));
    }
    return picture;
}

}  // namespace wavefog
