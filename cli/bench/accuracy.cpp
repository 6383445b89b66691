#include "bench/accuracy.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "parallel.h"
#include "wavefog/fogmap/reference.h"
#include "wavefog/gpu/pixel_rays.h"

namespace wavefog::cli {
namespace {

constexpr double kLeastSquareError = 1e-20;  // 200 dB

double luma(const std::array<double, 3>& rgb) {
    return 0.2126 * rgb[0] + 0.7152 * rgb[1] + 0.0722 * rgb[2];
}

constexpr int kWindow = 11;

std::array<double, kWindow> gaussian_window() {
    std::array<double, kWindow> weights{};
    double sum = 0;
    for (int i = 0; i < kWindow; ++i) {
        const double x = (i - kWindow / 2) / 1.5;
        sum += weights[std::size_t(i)] = std::exp(-x * x / 2);
    }
    for (double& weight : weights) weight /= sum;
    return weights;
}

/// Windowed means at every place where the window fits.
std::vector<double> windowed(int width, int height, const std::vector<double>& image) {
    static const auto weights = gaussian_window();
    const int columns = width - kWindow + 1, rows = height - kWindow + 1;
    std::vector<double> across(std::size_t(columns) * std::size_t(height));
    std::vector<double> result(std::size_t(columns) * std::size_t(rows), 0.0);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < columns; ++x) {
            double sum = 0;
            for (int k = 0; k < kWindow; ++k)
                sum += weights[std::size_t(k)] * image[std::size_t(y * width + x + k)];
            across[std::size_t(y * columns + x)] = sum;
        }
    for (int y = 0; y < rows; ++y)
        for (int k = 0; k < kWindow; ++k)
            for (int x = 0; x < columns; ++x)
                result[std::size_t(y * columns + x)] +=
                    weights[std::size_t(k)] * across[std::size_t((y + k) * columns + x)];
    return result;
}

std::vector<double> product(const std::vector<double>& a, const std::vector<double>& b) {
    std::vector<double> result(a.size());
    std::transform(a.begin(), a.end(), b.begin(), result.begin(), std::multiplies<>());
    return result;
}

}  // namespace

double srgb_from_linear(double value) {
    const double v = std::clamp(value, 0.0, 1.0);
    return v <= 0.0031308 ? 12.92 * v : 1.055 * std::pow(v, 1 / 2.4) - 0.055;
}

double ssim(int width, int height, const std::vector<double>& a, const std::vector<double>& b) {
    if (width < kWindow || height < kWindow) return 1;
    constexpr double c1 = 0.01 * 0.01, c2 = 0.03 * 0.03;
    const auto mean_a = windowed(width, height, a), mean_b = windowed(width, height, b);
    const auto aa = windowed(width, height, product(a, a));
    const auto bb = windowed(width, height, product(b, b));
    const auto ab = windowed(width, height, product(a, b));
    double sum = 0;
    for (std::size_t i = 0; i < aa.size(); ++i) {
        const double variances = aa[i] - mean_a[i] * mean_a[i] + bb[i] - mean_b[i] * mean_b[i];
        const double covariance = ab[i] - mean_a[i] * mean_b[i];
        sum += (2 * mean_a[i] * mean_b[i] + c1) * (2 * covariance + c2) /
               ((mean_a[i] * mean_a[i] + mean_b[i] * mean_b[i] + c1) * (variances + c2));
    }
    return sum / double(aa.size());
}

Truth compute_truth(const std::vector<Fog>& fogs, const std::vector<FogModel>& models,
                    const Camera& camera, const Image& depth, int stride) {
    Truth truth;
    truth.width = (depth.width + stride - 1) / stride;
    truth.height = (depth.height + stride - 1) / stride;
    truth.tau.resize(std::size_t(truth.width) * std::size_t(truth.height));
    truth.stride = stride;
    const std::vector<Reference> references(fogs.begin(), fogs.end());
    const PixelRays rays(camera, depth.width, depth.height);
    const auto integrate_rows = [&](std::size_t begin, std::size_t end) {
        for (int y = int(begin); y < int(end); ++y)
            for (int x = 0; x < truth.width; ++x) {
                const PixelRay ray =
                    rays.at(stride * x, stride * y, double(depth.at(stride * x, stride * y, 0)));
                truth.tau[std::size_t(y * truth.width + x)] =
                    rays.optical_depth(references, ray, 1, models);
            }
    };
    parallel_chunks("integrating the truth", std::size_t(truth.height), 4, integrate_rows);
    return truth;
}

Image every_nth(const Image& image, int stride) {
    if (stride == 1) return image;
    Image sparse{(image.width + stride - 1) / stride,
                 (image.height + stride - 1) / stride,
                 image.channels,
                 {}};
    for (int y = 0; y < sparse.height; ++y)
        for (int x = 0; x < sparse.width; ++x)
            for (int c = 0; c < sparse.channels; ++c)
                sparse.pixels.push_back(image.at(stride * x, stride * y, c));
    return sparse;
}

RayLimits ray_limits(const std::vector<Fog>& fogs, const Camera& camera, const Image& depth) {
    const std::vector<Reference> references(fogs.begin(), fogs.end());
    const PixelRays rays(camera, depth.width, depth.height);
    RayLimits limits;
    const auto include = [&](const Eigen::Vector3d& path) {
        limits.length = std::max(limits.length, path.norm());
        limits.rise = std::max(limits.rise, std::abs(path.y()));
    };
    for (int y = 0; y < depth.height; ++y)
        for (int x = 0; x < depth.width; ++x) {
            const PixelRay ray = rays.at(x, y, double(depth.at(x, y, 0)));
            const Eigen::Vector3d path = ray.end - ray.origin;
            if (!ray.sky) include(path);
            for (const Reference& fog : references)
                if (ray.sky) include(path * fog.far_end(ray.origin, path, sky_limit(camera)));
        }
    return limits;
}

FogBounds::FogBounds(const Fog& fog)
    : dropped(fog), densest(fog.extinction * double(reconstruct(fog.decomposition).maxCoeff())) {}

std::optional<double> certified_bound(const std::vector<Fog>& fogs,
                                      const std::vector<FogBounds>& bounds, const Method& method,
                                      const Camera& camera, int width, int height,
                                      const RayLimits& limits) {
    if (method.kind == MethodKind::radial && camera.projection == Camera::Projection::perspective) {
        // |dT| of a product of factors that are at most 1 is at most the sum of theirs.
        double sum = 0;
        for (std::size_t i = 0; i < fogs.size(); ++i) {
            const auto bound =
                radial_bound(fogs[i], bounds[i].dropped, method, camera, width, height, limits);
            if (!bound) return std::nullopt;
            sum += *bound;
        }
        return std::min(sum, 1.0);
    }
    const bool paper = method.kind == MethodKind::paper || method.kind == MethodKind::paper_scaling;
    // Radial draws an orthographic picture as exact does.
    if (method.kind != MethodKind::exact && method.kind != MethodKind::radial && !paper)
        return std::nullopt;
    double tau = 0, densest = 0;
    for (std::size_t i = 0; i < fogs.size(); ++i) {
        densest += bounds[i].densest;
        // Their tables are exact for degree 0 and 1 with mean densities alone.
        if (paper && (fogs[i].degree() > 1 || method.layout != PathLayout::mean))
            return std::nullopt;
        if (method.mu < 1)
            tau += bounds[i].dropped.optical_depth(method.mu, limits.length, limits.rise);
    }
    const double rounding = 0x1p-21 + 4 * 0x1p-24 * densest * limits.length;
    return std::min(-std::expm1(-tau) + rounding, 1.0);
}

Accuracy measure_accuracy(const Truth& truth, const Image& tau, const Image& scene,
                          const Eigen::Vector3d& fog_colour) {
    const std::size_t count = truth.tau.size();
    std::vector<double> dT(count), luma_true(count), luma_drawn(count);
    double square_tau = 0, square_colour = 0;
    std::size_t translucent = 0;
    for (int y = 0; y < truth.height; ++y)
        for (int x = 0; x < truth.width; ++x) {
            const std::size_t i = std::size_t(y * truth.width + x);
            const double true_tau = truth.tau[i], drawn_tau = double(tau.at(x, y, 0));
            dT[i] = std::abs(std::exp(-true_tau) - std::exp(-drawn_tau));
            if (true_tau <= kOpaque) {
                square_tau += (drawn_tau - true_tau) * (drawn_tau - true_tau);
                ++translucent;
            }
            const double true_opacity = -std::expm1(-true_tau), opacity = -std::expm1(-drawn_tau);
            std::array<double, 3> truly{}, drawn{};
            for (int c = 0; c < 3; ++c) {
                const double linear = double(scene.at(x, y, c)), towards = fog_colour[c] - linear;
                truly[std::size_t(c)] = srgb_from_linear(linear + true_opacity * towards);
                drawn[std::size_t(c)] = srgb_from_linear(linear + opacity * towards);
                const double difference = truly[std::size_t(c)] - drawn[std::size_t(c)];
                square_colour += difference * difference;
            }
            luma_true[i] = luma(truly);
            luma_drawn[i] = luma(drawn);
        }
    Accuracy accuracy;
    accuracy.ssim = ssim(truth.width, truth.height, luma_true, luma_drawn);
    accuracy.rmse_tau = translucent == 0 ? 0 : std::sqrt(square_tau / double(translucent));
    const double mean_square = square_colour / double(3 * count);
    accuracy.psnr = -10 * std::log10(std::max(mean_square, kLeastSquareError));
    accuracy.max_dT = *std::max_element(dT.begin(), dT.end());
    const auto p99 = dT.begin() + std::ptrdiff_t(double(count - 1) * 0.99);
    std::nth_element(dT.begin(), p99, dT.end());
    accuracy.p99_dT = *p99;
    return accuracy;
}

}  // namespace wavefog::cli
