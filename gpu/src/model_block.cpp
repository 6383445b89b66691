#include "model_block.h"

#include <fmt/format.h>

#include <algorithm>
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

/// The mean of one function is what both integrals are.
bool of_means(const Separable& fog) {
    const auto tables = std::count_if(fog.axes.begin(), fog.axes.end(),
                                      [](const AxisTable& axis) { return !axis.values.empty(); });
    return fog.integral == Separable::Integral::published || tables <= 1;
}

/// Parts of each kind: what `count` and `count_more` hold.
struct Counts {
    int halfspaces = 0, ramps = 0, exponentials = 0, waves = 0, polynomials = 0, objects = 0,
        separables = 0;

    void add(const Halfspace&) { ++halfspaces; }
    void add(const Ramp& fog) { ramps += static_cast<int>(fog.points.size()) + 1; }
    void add(const ExponentialLayer&) { ++exponentials; }
    void add(const Cosines& fog) { waves += static_cast<int>(fog.waves.size()); }
    void add(const Polynomials& fog) { polynomials += static_cast<int>(fog.terms.size()); }
    void add(const Potentials& fog) { objects += static_cast<int>(fog.objects.size()); }
    void add(const Separable&) { ++separables; }
};

class Writer {
  public:
    using Split = std::function<SplitSum(const Vector3d&)>;

    Writer(const Channels& channels, const Vector3d& eye, double sky_limit, const Split& split)
        : eye_(eye), split_(split) {
        block_.limit.x = static_cast<float>(sky_limit);
        block_.limit.z = static_cast<float>(stop_depth(channels));
    }

    void add(const Halfspace& fog) {
        const int i = block_.count.x++;
        block_.plane[i] = to_vec4(fog.normal, fog.normal.dot(eye_ - fog.point));
        using enum Halfspace::Fraction;
        static_assert(MODEL_SATURATED == Halfspace::kSaturated);
        const float fraction = fog.fraction == linear ? MODEL_FRACTION_LINEAR
                               : fog.fraction == exp2 ? MODEL_FRACTION_EXP2
                                                      : 0.0f;
        block_.plane_density[i] =
            to_vec4(fog.extinction, fog.gradient, fraction, fog.extinction * fog.start);
        if (!split_) return;
        const SplitSum along = split_(fog.normal);
        block_.plane_high[i] = to_vec4(along.high, 0);
        block_.plane_low[i] = to_vec4(along.low, 0);
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

    void add(const Separable& fog) {
        const int s = block_.count_more.z++;
        for (int a = 0; a < 3; ++a) {
            const AxisTable& axis = fog.axes[static_cast<std::size_t>(a)];
            if (axis.values.empty()) continue;
            const double cells = static_cast<double>(axis.values.size() - 1);
            const double per_metre = cells / (axis.end - axis.begin);
            double u = (eye_[a] - axis.begin) * per_metre;
            if (axis.repeat) u -= cells * std::floor(u / cells);
            // Beyond 2^22 cells a float would not count them.
            const double cell = std::clamp(std::floor(u), -4194304.0, 4194304.0);
            block_.separable_axis[3 * s + a] = to_vec4(u - cell, per_metre, cells, axis.repeat);
            block_.separable_row[3 * s + a] = {static_cast<int>(cell), tables_++, 0, 0};
        }
        block_.separable[s] = to_vec4(fog.extinction, of_means(fog));
    }

    shader::ModelBlock block() {
        block_.limit.y = static_cast<float>(everywhere_);
        return block_;
    }

  private:
    static constexpr double kFar = 1e30;  // FOG_FAR of fog_ray.glsl
    Vector3d eye_;
    Split split_;
    double everywhere_ = 0;
    int tables_ = 0;
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
          {"objects of potentials", counts.objects, MODEL_MAX_OBJECTS},
          {"separable fogs and tables of height", counts.separables, MODEL_MAX_SEPARABLES}})
        if (count > most)
            return data_error(
                fmt::format("fog: {} {}, the shader holds {}; use fewer, or method "
                            "reference",
                            count, what, most));
    return {};
}

int model_kinds(const std::vector<FogModel>& models) {
    int kinds = 0;
    for (const FogModel& model : models)
        std::visit(
            [&](const auto& fog) {
                using Kind = std::decay_t<decltype(fog)>;
                if constexpr (std::is_same_v<Kind, Halfspace>)
                    kinds |= MODEL_KIND_HALFSPACE |
                             (fog.fraction != Halfspace::Fraction::exp ? MODEL_KIND_FRACTION : 0);
                else if constexpr (std::is_same_v<Kind, Ramp>)
                    kinds |= MODEL_KIND_RAMP;
                else if constexpr (std::is_same_v<Kind, ExponentialLayer>)
                    kinds |= MODEL_KIND_EXPONENTIAL;
                else if constexpr (std::is_same_v<Kind, Cosines>)
                    kinds |= MODEL_KIND_WAVE;
                else if constexpr (std::is_same_v<Kind, Polynomials>)
                    kinds |= MODEL_KIND_POLYNOMIAL;
                else if constexpr (std::is_same_v<Kind, Potentials>)
                    kinds |= MODEL_KIND_OBJECT;
                else
                    kinds |= of_means(fog) ? MODEL_KIND_MEANS : MODEL_KIND_WALK;
            },
            model);
    return kinds;
}

ModelTables model_tables(const std::vector<FogModel>& models) {
    std::vector<const AxisTable*> axes;
    ModelTables tables;
    for (const FogModel& model : models)
        if (const auto* fog = std::get_if<Separable>(&model))
            for (const AxisTable& axis : fog->axes)
                if (!axis.values.empty()) axes.push_back(&axis);
    tables.height = std::max(static_cast<int>(axes.size()), 1);
    for (const AxisTable* axis : axes)
        tables.width = std::max(tables.width, static_cast<int>(axis->values.size()));
    tables.rgba.resize(static_cast<std::size_t>(tables.width) *
                       static_cast<std::size_t>(tables.height) * 4);
    float* row = tables.rgba.data();
    for (const AxisTable* axis : axes) {
        const auto& v = axis->values;
        double integral = 0;
        for (std::size_t i = 0; i < v.size(); ++i) {
            if (i > 0) integral += (v[i - 1] + v[i]) / 2;
            const float high = static_cast<float>(integral);
            row[4 * i] = static_cast<float>(v[i]);
            row[4 * i + 1] = i + 1 < v.size() ? static_cast<float>(v[i + 1] - v[i]) : 0.0f;
            row[4 * i + 2] = high;
            row[4 * i + 3] = static_cast<float>(integral - static_cast<double>(high));
        }
        row += static_cast<std::size_t>(tables.width) * 4;
    }
    return tables;
}

shader::ModelBlock model_block(const std::vector<FogModel>& models, const Channels& channels,
                               const Eigen::Vector3d& eye, double sky_limit,
                               const std::function<SplitSum(const Eigen::Vector3d&)>& split) {
    Writer writer(channels, eye, sky_limit, split);
    for (const FogModel& model : models)
        std::visit([&](const auto& fog) { writer.add(fog); }, model);
    return writer.block();
}

}  // namespace wavefog
