#include "model_block.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace wavefog {
namespace {

using Eigen::Vector3d;

glm::vec4 to_vec4(const Vector3d& v, double w) {
    return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z()),
            static_cast<float>(w)};
}
glm::vec4 to_vec4(double x, double y, double z = 0, double w = 0) {
    return to_vec4(Vector3d(x, y, z), w);
}

/// Parts of each kind: what `count` and `count_more` hold.
struct Counts {
    int halfspaces = 0, ramps = 0, exponentials = 0, waves = 0, polynomials = 0, objects = 0;

    void add(const Halfspace&) { ++halfspaces; }
    void add(const Ramp& fog) { ramps += static_cast<int>(fog.points.size()) + 1; }
    void add(const ExponentialLayer&) { ++exponentials; }
    void add(const Cosines& fog) { waves += static_cast<int>(fog.waves.size()); }
    void add(const Polynomials& fog) { polynomials += static_cast<int>(fog.terms.size()); }
    void add(const Potentials& fog) { objects += static_cast<int>(fog.objects.size()); }
};

class Writer {
  public:
    Writer(const Vector3d& eye, double sky_limit) : eye_(eye) {
        block_.limit.x = static_cast<float>(sky_limit);
    }

    void add(const Halfspace& fog) {
        const int i = block_.count.x++;
        block_.plane[i] = to_vec4(fog.normal, fog.normal.dot(eye_ - fog.point));
        block_.plane_density[i] = to_vec4(fog.extinction, fog.gradient);
    }

    void add(const Ramp& fog) {
        const auto& points = fog.points;
        const auto piece = [&](double low, double high, double extinction, double slope) {
            block_.ramp[block_.count.y++] = to_vec4(low, high, extinction, slope);
        };
        piece(-kFar, points.front().y - eye_.y(), points.front().extinction, 0);
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            const auto &p = points[i], &q = points[i + 1];
            piece(p.y - eye_.y(), q.y - eye_.y(), p.extinction,
                  (q.extinction - p.extinction) / (q.y - p.y));
        }
        piece(points.back().y - eye_.y(), kFar, points.back().extinction, 0);
    }

    void add(const ExponentialLayer& fog) {
        block_.exponential[block_.count.z++] =
            to_vec4((eye_.y() - fog.base) / fog.scale, 1 / fog.scale, fog.extinction);
    }

    void add(const Cosines& fog) {
        everywhere_ += fog.extinction;
        for (const auto& wave : fog.waves) {
            const int i = block_.count.w++;
            const Vector3d radians = wave.frequency * wave.direction;
            const double turns = (radians.dot(eye_) + wave.phase) / (2 * std::numbers::pi);
            block_.wave[i] = to_vec4(radians / (2 * std::numbers::pi), turns - std::floor(turns));
            block_.wave_amplitude[i] = to_vec4(wave.extinction, 0);
        }
    }

    void add(const Polynomials& fog) {
        for (const auto& term : fog.terms) {
            const int i = block_.count_more.x++;
            const bool repeat = term.outside == Polynomials::Outside::repeat;
            double u = term.direction.dot(eye_ - term.centre) / term.half_width;
            if (repeat) u -= 2 * std::floor((u + 1) / 2);
            block_.polynomial[i] = to_vec4(term.direction / term.half_width, u);
            double mean = 0;
            for (std::size_t k = 0; k < term.coefficients.size(); ++k) {
                const double c = term.extinction * term.coefficients[k];
                block_.coefficients[3 * i + static_cast<int>(k / 4)][static_cast<int>(k % 4)] =
                    static_cast<float>(c);
                if (k % 2 == 0) mean += c / static_cast<double>(k + 1);
            }
            block_.coefficients[3 * i + 2].z = static_cast<float>(mean);
            block_.coefficients[3 * i + 2].w = repeat ? 1.0f : 0.0f;
        }
    }

    void add(const Potentials& fog) {
        everywhere_ += fog.extinction;
        for (const auto& object : fog.objects) {
            const int i = block_.count_more.y++;
            block_.object[i] = to_vec4(object.from - eye_, object.radius);
            if (object.kind == Potentials::Object::Kind::line) {
                const Vector3d line = object.to - object.from;
                block_.object_axis[i] = to_vec4(line.normalized(), line.norm());
            }
            block_.object_shape[i] = to_vec4(object.extinction, 1 / object.reach);
        }
    }

    shader::ModelBlock block() {
        block_.limit.y = static_cast<float>(everywhere_);
        return block_;
    }

  private:
    static constexpr double kFar = 1e30;  // FOG_FAR of fog_ray.glsl
    Vector3d eye_;
    double everywhere_ = 0;
    shader::ModelBlock block_{};
};

}  // namespace

Result<void> check_models(const std::vector<FogModel>& models) {
    Counts counts;
    for (const FogModel& model : models) {
        if (auto ok = validate(model); !ok) return ok;
        std::visit([&](const auto& fog) { counts.add(fog); }, model);
    }
    for (const auto& [what, count, most] :
         {std::tuple{"halfspaces and depth layers", counts.halfspaces, MODEL_MAX_HALFSPACES},
          {"pieces of ramps", counts.ramps, MODEL_MAX_RAMPS},
          {"exponential layers", counts.exponentials, MODEL_MAX_EXPONENTIALS},
          {"waves", counts.waves, MODEL_MAX_WAVES},
          {"polynomials", counts.polynomials, MODEL_MAX_POLYNOMIALS},
          {"objects of potentials", counts.objects, MODEL_MAX_OBJECTS}})
        if (count > most)
            return data_error(
                fmt::format("fog: {} {}, the shader holds {}; use fewer, or method "
                            "reference",
                            count, what, most));
    return {};
}

shader::ModelBlock model_block(const std::vector<FogModel>& models, const Eigen::Vector3d& eye,
                               double sky_limit) {
    Writer writer(eye, sky_limit);
    for (const FogModel& model : models)
        std::visit([&](const auto& fog) { writer.add(fog); }, model);
    return writer.block();
}

}  // namespace wavefog
