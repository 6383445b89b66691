#include "wavefog/gpu/pixel_rays.h"

#include <Eigen/LU>
#include <cmath>

namespace wavefog {

double sky_limit(const Camera& camera) {
    return std::isfinite(camera.far_plane) ? camera.far_plane : 1e6;
}

Eigen::Matrix4d clip_from_eye(const CameraMatrices& matrices) {
    Eigen::Matrix4d rotation = matrices.view;
    rotation.topRightCorner<3, 1>().setZero();
    return matrices.projection * rotation;
}

Eigen::Matrix4d eye_from_clip(const CameraMatrices& matrices) {
    return clip_from_eye(matrices).inverse();
}

PixelRays::PixelRays(const Camera& camera, int width, int height)
    : eye_(camera.eye),
      sky_limit_(sky_limit(camera)),
      width_(width),
      height_(height),
      orthographic_(camera.projection == Camera::Projection::orthographic) {
    const CameraMatrices matrices = camera_matrices(camera, width, height);
    eye_from_clip_ = eye_from_clip(matrices);
    sky_depth_ = matrices.sky_depth;
    pixel_ = 2 / (std::abs(matrices.projection(1, 1)) * height);
}

double PixelRays::pixel_size(double distance) const {
    return orthographic_ ? pixel_ : pixel_ * distance;
}

PixelRay PixelRays::at(double x, double y_from_top, double depth) const {
    const Eigen::Vector2d ndc(2 * (x + 0.5) / width_ - 1, 1 - 2 * (y_from_top + 0.5) / height_);
    const auto point = [&](double d) -> Eigen::Vector4d {
        return eye_from_clip_ * Eigen::Vector4d(ndc.x(), ndc.y(), d, 1);
    };
    PixelRay ray;
    ray.sky = depth == sky_depth_;
    const Eigen::Vector4d surface = point(depth);
    Eigen::Vector3d start = Eigen::Vector3d::Zero(), path;
    if (orthographic_) {
        start = point(1 - sky_depth_).head<3>();
        path = surface.head<3>() - start;
    } else {
        path = ray.sky ? Eigen::Vector3d(surface.head<3>())
                       : Eigen::Vector3d(surface.head<3>() / surface.w());
    }
    if (ray.sky) path.normalize();
    ray.origin = eye_ + start;
    ray.end = ray.origin + path;
    return ray;
}

double PixelRays::through(const Reference& fog, const PixelRay& ray, double mu) const {
    Eigen::Vector3d end = ray.end;
    if (ray.sky) {
        const Eigen::Vector3d direction = ray.end - ray.origin;
        end = ray.origin + fog.far_end(ray.origin, direction, sky_limit_) * direction;
    }
    return fog.optical_depth(ray.origin, end, mu);
}

double PixelRays::optical_depth(const std::vector<Reference>& fogs, const PixelRay& ray, double mu,
                                const std::vector<FogModel>& models,
                                const std::vector<Particle>& particles) const {
    const Eigen::Vector3d path = (ray.end - ray.origin) * (ray.sky ? sky_limit_ : 1);
    double sum = wavefog::optical_depth(models, ray.origin, ray.origin + path) +
                 wavefog::optical_depth(particles, ray.origin, ray.origin + path);
    for (const Reference& fog : fogs) sum += through(fog, ray, mu);
    return sum;
}

Eigen::Array3d PixelRays::channel_depths(const std::vector<Reference>& fogs, const PixelRay& ray,
                                         double mu, const std::vector<FogModel>& models,
                                         const std::vector<Particle>& particles) const {
    const Eigen::Vector3d path = (ray.end - ray.origin) * (ray.sky ? sky_limit_ : 1);
    Eigen::Array3d sum = wavefog::channel_depths(particles, ray.origin, ray.origin + path);
    const auto add = [&](const Channels& channels, double tau) {
        sum += tau * Eigen::Array3d(channels.data());
    };
    for (const FogModel& model : models)
        add(model.channels, wavefog::optical_depth(model, ray.origin, ray.origin + path));
    for (const Reference& fog : fogs) add(fog.channels(), through(fog, ray, mu));
    return sum;
}

}  // namespace wavefog
