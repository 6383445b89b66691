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

// Rays a pixel across and down for its mean.
constexpr int kSubpixels = 4;

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
                    const Camera& camera, const Image& depth, int stride, bool means,
                    const std::vector<Particle>& particles) {
    Truth truth;
    truth.width = (depth.width + stride - 1) / stride;
    truth.height = (depth.height + stride - 1) / stride;
    truth.tau.resize(std::size_t(truth.width) * std::size_t(truth.height));
    if (means) truth.mean_T.resize(truth.tau.size());
    truth.stride = stride;
    const std::vector<Reference> references(fogs.begin(), fogs.end());
    const PixelRays rays(camera, depth.width, depth.height);
    const auto finer_than_pixel = [&](const PixelRay& ray) {
        const Eigen::Vector3d path = ray.end - ray.origin;
        for (std::size_t i = 0; i < fogs.size(); ++i) {
            const double length =
                ray.sky ? references[i].far_end(ray.origin, path, sky_limit(camera)) : path.norm();
            if (std::min(fogs[i].cell_x(), fogs[i].cell_z()) < rays.pixel_size(length)) return true;
        }
        return false;
    };
    const auto mean = [&](int x, int y, double z) {
        double sum = 0;
        for (int j = 0; j < kSubpixels; ++j)
            for (int i = 0; i < kSubpixels; ++i) {
                const double right = (i + 0.5) / kSubpixels - 0.5;
                const double down = (j + 0.5) / kSubpixels - 0.5;
                sum += std::exp(-rays.optical_depth(references, rays.at(x + right, y + down, z), 1,
                                                    models, particles));
            }
        return sum / (kSubpixels * kSubpixels);
    };
    const auto integrate_rows = [&](std::size_t begin, std::size_t end) {
        for (int row = int(begin); row < int(end); ++row)
            for (int column = 0; column < truth.width; ++column) {
                const std::size_t at = std::size_t(row * truth.width + column);
                const int x = stride * column, y = stride * row;
                const double z = double(depth.at(x, y, 0));
                const PixelRay ray = rays.at(x, y, z);
                truth.tau[at] = rays.optical_depth(references, ray, 1, models, particles);
                if (means)
                    truth.mean_T[at] =
                        finer_than_pixel(ray) ? mean(x, y, z) : std::exp(-truth.tau[at]);
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

const DetailBound& FogBounds::dropped() {
    if (!dropped_) dropped_.emplace(fog_);
    return *dropped_;
}

const MarchBound& FogBounds::march() {
    if (!march_) march_.emplace(fog_);
    return *march_;
}

const RadialBound& FogBounds::radial() {
    if (!radial_) radial_.emplace(fog_, dropped());
    return *radial_;
}

double FogBounds::densest() {
    if (!densest_) densest_ = fog_.extinction * double(reconstruct(fog_.decomposition).maxCoeff());
    return *densest_;
}

double certified_bound(std::deque<FogBounds>& fogs, const Method& method, const Camera& camera,
                       int width, int height, const RayLimits& limits) {
    if (!method.sampling.every_pixel()) return 1;
    if (method.kind == MethodKind::radial && camera.projection == Camera::Projection::perspective) {
        // |dT| of a product of factors that are at most 1 is at most the sum of theirs.
        double sum = 0;
        for (FogBounds& fog : fogs)
            sum += fog.radial().transmittance(method, camera, width, height, limits);
        return std::min(sum, 1.0);
    }
    const bool paper = method.kind == MethodKind::paper || method.kind == MethodKind::paper_scaling;
    const bool march = method.kind == MethodKind::march;
    // Radial draws an orthographic picture as exact does.
    if (method.kind != MethodKind::exact && method.kind != MethodKind::radial && !paper && !march)
        return 1;
    double tau = 0, densest = 0;
    for (FogBounds& fog : fogs) {
        densest += fog.densest();
        // Their tables are exact for degree 0 and 1 with mean densities alone.
        if (paper && (fog.fog().degree() > 1 || method.layout != PathLayout::mean)) return 1;
        if (march)
            tau += fog.march().optical_depth(method.samples, limits.length, limits.rise);
        else if (method.mu < 1)
            tau += fog.dropped().optical_depth(method.mu, limits.length, limits.rise);
    }
    const double rounding = 0x1p-21 + 4 * 0x1p-24 * densest * limits.length;
    return std::min(-std::expm1(-tau) + rounding, 1.0);
}

Accuracy measure_accuracy(const Truth& truth, const Image& tau, const Image& scene,
                          const Eigen::Vector3d& fog_colour) {
    const std::size_t count = truth.tau.size();
    std::vector<double> dT(count), mean_dT(truth.mean_T.size()), luma_true(count),
        luma_drawn(count);
    double square_tau = 0, square_colour = 0;
    std::size_t translucent = 0;
    for (int y = 0; y < truth.height; ++y)
        for (int x = 0; x < truth.width; ++x) {
            const std::size_t i = std::size_t(y * truth.width + x);
            const double true_tau = truth.tau[i], drawn_tau = double(tau.at(x, y, 0));
            dT[i] = std::abs(std::exp(-true_tau) - std::exp(-drawn_tau));
            if (!mean_dT.empty()) mean_dT[i] = std::abs(truth.mean_T[i] - std::exp(-drawn_tau));
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
    const auto p99_of = [](std::vector<double>& errors) {
        const auto p99 = errors.begin() + std::ptrdiff_t(double(errors.size() - 1) * 0.99);
        std::nth_element(errors.begin(), p99, errors.end());
        return *p99;
    };
    accuracy.max_dT = *std::max_element(dT.begin(), dT.end());
    accuracy.p99_dT = p99_of(dT);
    if (!mean_dT.empty()) {
        accuracy.max_mean_dT = *std::max_element(mean_dT.begin(), mean_dT.end());
        accuracy.p99_mean_dT = p99_of(mean_dT);
    }
    return accuracy;
}

}  // namespace wavefog::cli
