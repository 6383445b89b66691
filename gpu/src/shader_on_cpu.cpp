// The fog shader's maths on the CPU, for one ray at a time.
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>

#include "fog_uniforms.h"
#include "fog_variants.h"
#include "paper_data.h"
#include "radial_block.h"
#include "wavefog/gpu/fog_pass.h"

namespace wavefog {

namespace {

// Rays have no far plane here; in repeated fog the table ends after some periods anyway.
constexpr double kRadialReach = 1e6;

/// The table of method radial around one eye, every azimuth of it.
struct RadialOnCpu {
    Eigen::Vector3d eye;
    shader::RadialBlock block;
    std::vector<glm::vec3> texels;
};

}  // namespace

struct ShaderOnCpu::Impl {
    CellAtlas atlas;
    Grid<float> map;
    FogFacts facts;
    Method method;
    double seconds = 0;
    std::optional<PaperData> paper;
    RadialShape radial_shape;
    std::mutex radial_mutex;
    std::shared_ptr<const RadialOnCpu> radial;  ///< of the last eye

    shader::Variant variant() const {
        return {facts.degree, profile_number(facts.profile), facts.boundary == Boundary::repeat,
                facts.skip};
    }
    std::shared_ptr<const RadialOnCpu> radial_around(const Eigen::Vector3d& eye);
};

namespace {

// The fraction of the path at which it enters the map's box and the profile's support. The ray is
// re-based there in double, so that float32 counts from there (stability.md, rows 4 and 5).
double fog_entry(const FogFacts& fog, const Eigen::Vector3d& o, const Eigen::Vector3d& path) {
    const auto enter = [](double from, double slope, double low, double high) {
        return slope == 0 ? 0.0 : std::min((low - from) / slope, (high - from) / slope);
    };
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    double entry = 0;
    if (fog.boundary == Boundary::zero) {
        const double margin_x = (fog.rect.x1 - fog.rect.x0) / fog.width * fog.degree / 2.0;
        const double margin_z = (fog.rect.z1 - fog.rect.z0) / fog.height * fog.degree / 2.0;
        entry =
            std::max({entry, enter(o.x(), path.x(), fog.rect.x0 - margin_x, fog.rect.x1 + margin_x),
                      enter(o.z(), path.z(), fog.rect.z0 - margin_z, fog.rect.z1 + margin_z)});
    }
    const auto& profile = fog.profile;
    switch (profile.kind) {
        case Profile::Kind::uniform:
            break;
        case Profile::Kind::slab:
            entry = std::max(entry, enter(o.y(), path.y(), profile.bottom, profile.top));
            break;
        case Profile::Kind::exponential:
            entry = std::max(
                entry, enter(o.y(), path.y(), -kInfinity, profile.base + kEtaMax * profile.scale));
            break;
        case Profile::Kind::linear:
            entry = std::max(entry, enter(o.y(), path.y(), -kInfinity, profile.top));
            break;
    }
    return entry;
}

}  // namespace

ShaderOnCpu::ShaderOnCpu(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Result<ShaderOnCpu> ShaderOnCpu::create(const Fog& fog, const Method& method, double seconds) {
    if (method.kind == MethodKind::reference || method.kind == MethodKind::froxel ||
        !method.sampling.every_pixel())
        return usage_error("method " + method.name() +
                           ": has no shader for single rays; choose exact, radial, paper, "
                           "paper-scaling, march:N or homogeneous");
    if (auto drawable = check_drawable(fog); !drawable) return tl::unexpected(drawable.error());
    auto impl = std::make_unique<Impl>();
    const auto pyramid = approximations(fog.decomposition);
    impl->atlas = build_cell_atlas(pyramid);
    impl->map = pyramid.levels.back().values / static_cast<float>(impl->atlas.density_scale);
    impl->facts = fog_facts(fog, impl->atlas);
    impl->method = method;
    impl->seconds = seconds;
    if (method.kind == MethodKind::paper || method.kind == MethodKind::paper_scaling) {
        auto data = make_paper_data(fog.decomposition, method, impl->atlas.density_scale);
        if (!data) return tl::unexpected(data.error());
        impl->paper = std::move(*data);
        impl->facts.skip = false;
    }
    if (method.kind == MethodKind::radial) {
        impl->facts.skip = false;
        impl->radial_shape = radial_shape(impl->facts, method);
    }
    return ShaderOnCpu(std::move(impl));
}
ShaderOnCpu::ShaderOnCpu(ShaderOnCpu&&) noexcept = default;
ShaderOnCpu& ShaderOnCpu::operator=(ShaderOnCpu&&) noexcept = default;
ShaderOnCpu::~ShaderOnCpu() = default;

std::shared_ptr<const RadialOnCpu> ShaderOnCpu::Impl::radial_around(const Eigen::Vector3d& eye) {
    const std::lock_guard lock(radial_mutex);
    if (radial && radial->eye == eye) return radial;
    auto table = std::make_shared<RadialOnCpu>();
    table->eye = eye;
    table->block = radial_block(facts, eye, {}, seconds, kRadialReach, radial_shape);
    table->texels.resize(static_cast<std::size_t>(radial_shape.columns) *
                         static_cast<std::size_t>(radial_shape.rows * radial_shape.layers));
    shader::radial = table->block;
    shader::radial_image = table->texels.data();
    shader::radial_image_width = radial_shape.columns;
    shader::fill_radial(variant(), radial_shape.layers);
    return radial = table;
}

double ShaderOnCpu::optical_depth(const Eigen::Vector3d& o, const Eigen::Vector3d& p) const {
    const auto& fog = impl_->facts;
    const Eigen::Vector3d path = p - o;
    const double metres = path.norm();
    if (metres == 0) return 0;

    // Rays of homogeneous know no map, those of radial are counted from the eye.
    const MethodKind kind = impl_->method.kind;
    const bool whole = kind == MethodKind::homogeneous || kind == MethodKind::radial;
    const Eigen::Vector2d moved = wind_offset(fog.wind, fog.rect, fog.boundary, impl_->seconds);
    const double entry =
        whole ? 0 : fog_entry(fog, o - Eigen::Vector3d(moved.x(), 0, moved.y()), path);
    if (entry >= 1) return 0;
    namespace s = shader;
    s::fog = fog_block(fog, o + entry * path, impl_->method.mu, impl_->seconds, 0);
    s::fog_cells = {impl_->atlas.texels.data(),
                    impl_->atlas.width,
                    impl_->atlas.height,
                    impl_->atlas.channels,
                    false,
                    false};
    s::fog_map = {impl_->map.data(), fog.width, fog.height, 1, fog.boundary == Boundary::repeat,
                  fog.degree > 0};
    s::Ray ray;
    ray.origin = {s::fog.eye.x, s::fog.eye.y};
    ray.slope = {static_cast<float>(path.x() * fog.width / (fog.rect.x1 - fog.rect.x0)),
                 static_cast<float>(path.z() * fog.height / (fog.rect.z1 - fog.rect.z0))};
    ray.eta = s::fog.eye.z;
    ray.rise = static_cast<float>(path.y()) * s::fog.scale.z;
    ray.metres = static_cast<float>(metres);
    ray.passed = static_cast<float>(entry);
    ray.last = static_cast<float>(1 - entry);
    auto evaluation = s::Evaluation::exact;
    switch (impl_->method.kind) {
        case MethodKind::march:
            evaluation = s::Evaluation::march;
            break;
        case MethodKind::homogeneous:
            evaluation = s::Evaluation::homogeneous;
            break;
        case MethodKind::paper:
            evaluation = s::Evaluation::paper;
            break;
        case MethodKind::paper_scaling:
            evaluation = s::Evaluation::paper_scaling;
            break;
        case MethodKind::radial:
            if (impl_->method.radial_step)
                evaluation = impl_->radial_shape.layers > 1 ? s::Evaluation::radial_layered_step
                                                            : s::Evaluation::radial_step;
            else
                evaluation = impl_->radial_shape.layers > 1 ? s::Evaluation::radial_layered
                                                            : s::Evaluation::radial;
            break;
        default:
            break;
    }
    if (impl_->paper) {
        const auto& data = *impl_->paper;
        const auto sampler = [](const std::vector<float>& rgba, int width, int height) {
            return s::sampler2D{rgba.data(), width, height, 4, false, false};
        };
        s::paper = data.block;
        s::paper_bands = sampler(data.bands.rgba, data.bands.width, data.bands.height);
        s::paper_paths =
            sampler(data.table.whole.rgba, data.table.whole.width, data.table.whole.height);
        s::paper_partials =
            sampler(data.table.partial.rgba, data.table.partial.width, data.table.partial.height);
    }
    std::shared_ptr<const RadialOnCpu> table;
    if (kind == MethodKind::radial) {
        table = impl_->radial_around(o);
        const auto& shape = impl_->radial_shape;
        s::radial = table->block;
        s::radial_table = {&table->texels.front().x,
                           shape.columns,
                           shape.rows * shape.layers,
                           3,
                           false,
                           true,
                           true};
    }
    return s::evaluate(impl_->variant(), evaluation, ray, impl_->method.samples);
}

}  // namespace wavefog
