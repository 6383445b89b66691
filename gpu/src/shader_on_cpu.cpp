// The fog shader's maths on the CPU, for one ray at a time.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "fog_uniforms.h"
#include "fog_variants.h"
#include "paper_data.h"
#include "wavefog/gpu/fog_pass.h"

namespace wavefog {

struct ShaderOnCpu::Impl {
    CellAtlas atlas;
    Grid<float> map;
    FogFacts facts;
    Method method;
    std::optional<PaperData> paper;
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

Result<ShaderOnCpu> ShaderOnCpu::create(const Fog& fog, const Method& method) {
    if (method.kind == MethodKind::reference || method.kind == MethodKind::froxel)
        return usage_error("method " + method.name() +
                           ": has no shader for single rays; choose exact, paper, paper-scaling, "
                           "march:N or homogeneous");
    if (auto drawable = check_drawable(fog); !drawable) return tl::unexpected(drawable.error());
    auto impl = std::make_unique<Impl>();
    const auto pyramid = approximations(fog.decomposition);
    impl->atlas = build_cell_atlas(pyramid);
    impl->map = pyramid.levels.back().values / static_cast<float>(impl->atlas.density_scale);
    impl->facts = fog_facts(fog, impl->atlas);
    impl->method = method;
    if (method.kind == MethodKind::paper || method.kind == MethodKind::paper_scaling) {
        auto data = make_paper_data(fog.decomposition, method, impl->atlas.density_scale);
        if (!data) return tl::unexpected(data.error());
        impl->paper = std::move(*data);
        impl->facts.skip = false;
    }
    return ShaderOnCpu(std::move(impl));
}
ShaderOnCpu::ShaderOnCpu(ShaderOnCpu&&) noexcept = default;
ShaderOnCpu& ShaderOnCpu::operator=(ShaderOnCpu&&) noexcept = default;
ShaderOnCpu::~ShaderOnCpu() = default;

double ShaderOnCpu::optical_depth(const Eigen::Vector3d& o, const Eigen::Vector3d& p) const {
    const auto& fog = impl_->facts;
    const Eigen::Vector3d path = p - o;
    const double metres = path.norm();
    if (metres == 0) return 0;

    const double entry =
        impl_->method.kind == MethodKind::homogeneous ? 0 : fog_entry(fog, o, path);
    if (entry >= 1) return 0;
    namespace s = shader;
    s::fog = fog_block(fog, o + entry * path, impl_->method.mu, 0, 0);
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
    return s::evaluate(
        {fog.degree, profile_number(fog.profile), fog.boundary == Boundary::repeat, fog.skip},
        evaluation, ray, impl_->method.samples);
}

}  // namespace wavefog
