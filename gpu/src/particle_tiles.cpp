#include "particle_tiles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace wavefog {
namespace {

using Eigen::Vector3d;

constexpr int kLeastTile = 16;                 // pixels
constexpr std::size_t kMostEntries = 1 << 22;  // 128 MiB of list
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Rays and tiles are rounded to float: tiles this much of a pixel away count too.
constexpr double kMargin = 0.01;

struct Span {
    double low, high;
};

/// NDC of everything within `radius` of a point, along one axis of the screen, by its view
/// coordinates `side` and `ahead`: the tangents of a circle from the eye. `scale` and `shift` give
/// NDC from side / ahead. Rays lead forwards.
Span perspective_span(double side, double ahead, double radius, double scale, double shift) {
    const double distance = std::hypot(side, ahead);
    if (distance <= radius) return {-kInfinity, kInfinity};
    const double middle = std::atan2(side, ahead), half = std::asin(radius / distance);
    constexpr double kQuarter = std::numbers::pi / 2;
    if (std::abs(middle) - half >= kQuarter) return {kInfinity, -kInfinity};  // all of it behind
    const auto ndc = [&](double angle, double beyond) {
        return std::abs(angle) >= kQuarter ? beyond : scale * std::tan(angle) + shift;
    };
    return {ndc(middle - half, -kInfinity), ndc(middle + half, kInfinity)};
}

/// First and last tile that a span of NDC reaches.
std::pair<int, int> tiles_of(const Span& span, int pixels, int side) {
    const int tiles = (pixels + side - 1) / side;
    const auto tile = [&](double ndc, double margin) {
        const double pixel = (ndc + 1) / 2 * pixels + margin;
        return static_cast<int>(std::clamp(std::floor(pixel / side), -1.0, double(tiles)));
    };
    return {std::max(tile(span.low, -kMargin), 0), std::min(tile(span.high, kMargin), tiles - 1)};
}

}  // namespace

ParticleTiles make_particle_tiles(const std::vector<Particle>& particles, const Camera& camera,
                                  const CameraMatrices& matrices, int width, int height) {
    struct Place {
        int x0, x1, y0, y1;
        std::size_t tiles() const {
            return std::size_t(std::max(x1 - x0 + 1, 0)) * std::size_t(std::max(y1 - y0 + 1, 0));
        }
    };
    std::vector<std::pair<Span, Span>> spans;
    spans.reserve(particles.size());
    const Eigen::Matrix3d turn = matrices.view.topLeftCorner<3, 3>();
    const Eigen::Matrix4d& p = matrices.projection;
    for (const Particle& particle : particles) {
        const Vector3d at = turn * (particle.position - camera.eye);
        const double r = particle.radius;
        if (camera.projection == Camera::Projection::orthographic)
            spans.push_back({{p(0, 0) * (at.x() - r) + p(0, 3), p(0, 0) * (at.x() + r) + p(0, 3)},
                             {p(1, 1) * (at.y() - r) + p(1, 3), p(1, 1) * (at.y() + r) + p(1, 3)}});
        else
            spans.push_back({perspective_span(at.x(), -at.z(), r, p(0, 0), -p(0, 2)),
                             perspective_span(at.y(), -at.z(), r, p(1, 1), -p(1, 2))});
    }
    ParticleTiles made;
    std::vector<Place> places(particles.size());
    for (made.side = kLeastTile;; made.side *= 2) {
        std::size_t entries = 0;
        for (std::size_t k = 0; k < places.size(); ++k) {
            const auto [x0, x1] = tiles_of(spans[k].first, width, made.side);
            const auto [y0, y1] = tiles_of(spans[k].second, height, made.side);
            places[k] = {x0, x1, y0, y1};
            entries += places[k].tiles();
        }
        if (entries <= kMostEntries) break;
    }
    made.across = (width + made.side - 1) / made.side;
    made.up = (height + made.side - 1) / made.side;
    made.first.assign(std::size_t(made.across) * std::size_t(made.up) + 1, 0);
    const auto for_tiles = [&](const Place& place, const auto& use) {
        for (int j = place.y0; j <= place.y1; ++j)
            for (int i = place.x0; i <= place.x1; ++i) use(std::size_t(j * made.across + i));
    };
    for (const Place& place : places)
        for_tiles(place, [&](std::size_t tile) { ++made.first[tile + 1]; });
    for (std::size_t i = 1; i < made.first.size(); ++i) made.first[i] += made.first[i - 1];
    made.entries.resize(static_cast<std::size_t>(made.first.back()));
    std::vector<int> next(made.first.begin(), made.first.end() - 1);
    for (std::size_t k = 0; k < places.size(); ++k)
        for_tiles(places[k], [&](std::size_t tile) {
            made.entries[std::size_t(next[tile]++)] = static_cast<int>(k);
        });
    return made;
}

std::vector<float> particle_list(const std::vector<Particle>& particles,
                                 const std::vector<int>& entries, const Vector3d& eye) {
    const std::size_t a_row = kParticleListWidth / 2;
    const std::size_t rows = (entries.size() + a_row - 1) / a_row;
    std::vector<float> list(rows * kParticleListWidth * 4, 0.0f);
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const Particle& particle = particles[static_cast<std::size_t>(entries[i])];
        const Vector3d from_eye = particle.position - eye;
        // Eleven binary digits: with thirteen of a direction they make a float's 24.
        const double step = std::exp2(std::ceil(std::log2(from_eye.cwiseAbs().maxCoeff())) - 11);
        const Vector3d coarse =
            step > 0 ? Vector3d((from_eye / step).array().round() * step) : Vector3d(0, 0, 0);
        const Eigen::Vector3f high = coarse.cast<float>();
        const Eigen::Vector3f low = (from_eye - coarse).cast<float>();
        float* texels = list.data() + 8 * i;
        std::copy_n(high.data(), 3, texels);
        texels[3] = static_cast<float>(1 / particle.radius);
        std::copy_n(low.data(), 3, texels + 4);
        texels[7] = static_cast<float>(particle.opacity);
    }
    return list;
}

int ParticleTextures::upload(const Camera& camera, const CameraMatrices& matrices, int width,
                             int height) {
    const Gl& gl = *gl_;
    const ParticleTiles made = make_particle_tiles(particles_, camera, matrices, width, height);
    std::vector<float> table;
    table.reserve(2 * made.first.size());
    for (std::size_t i = 0; i + 1 < made.first.size(); ++i) {
        table.push_back(static_cast<float>(made.first[i]));
        table.push_back(static_cast<float>(made.first[i + 1] - made.first[i]));
    }
    const std::vector<float> list = particle_list(particles_, made.entries, camera.eye);
    const int rows = static_cast<int>(list.size() / (4 * kParticleListWidth));
    if (made.across != across_ || made.up != up_) {
        across_ = made.across;
        up_ = made.up;
        tiles_ = make_texture_2d(gl, GL_RG32F, across_, up_, GL_RG, GL_FLOAT, nullptr);
    }
    if (rows > rows_ || rows_ == 0) {
        // Room to grow, so that few frames allocate.
        rows_ = std::max(rows + rows / 2, 1);
        list_ =
            make_texture_2d(gl, GL_RGBA32F, kParticleListWidth, rows_, GL_RGBA, GL_FLOAT, nullptr);
    }
    gl.PixelStorei(GL_UNPACK_ALIGNMENT, 1);
    gl.BindTexture(GL_TEXTURE_2D, tiles_.name());
    gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, across_, up_, GL_RG, GL_FLOAT, table.data());
    if (rows > 0) {
        gl.BindTexture(GL_TEXTURE_2D, list_.name());
        gl.TexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, kParticleListWidth, rows, GL_RGBA, GL_FLOAT,
                         list.data());
    }
    gl.BindTexture(GL_TEXTURE_2D, 0);
    return made.side;
}

}  // namespace wavefog
