#include "wavefog/fogmap/fog.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>

#include "finite.h"

namespace wavefog {

namespace {

bool all_finite(const Band<float>& band) {
    return detail::all_finite(band.values);
}

bool all_finite(const Decomposition<float>& decomposition) {
    if (!all_finite(decomposition.approximation)) return false;
    return std::all_of(decomposition.details.begin(), decomposition.details.end(),
                       [](const Detail<float>& detail) {
                           return all_finite(detail.phi_psi) && all_finite(detail.psi_phi) &&
                                  all_finite(detail.psi_psi) && all_finite(detail.residual);
                       });
}

}  // namespace

double Profile::operator()(double y) const {
    switch (kind) {
        case Kind::uniform:
            return 1;
        case Kind::slab:
            return y >= bottom && y <= top ? 1 : 0;
        case Kind::exponential:
            return y <= base ? 1 : std::exp(-(y - base) / scale);
        case Kind::linear:
            return y <= base ? 1 : y >= top ? 0 : (top - y) / (top - base);
    }
    return 1;
}

Result<void> Profile::validate() const {
    for (const auto& [name, value] : {std::pair{"bottom", bottom}, std::pair{"top", top},
                                      std::pair{"base", base}, std::pair{"scale", scale}})
        if (!std::isfinite(value))
            return data_error(fmt::format("{} is {}; it must be a finite number", name, value));
    if (kind == Kind::slab && !(bottom < top))
        return data_error(
            fmt::format("top is {}, bottom is {}; top must be above bottom", top, bottom));
    if (kind == Kind::linear && !(base < top))
        return data_error(fmt::format("top is {}, base is {}; top must be above base", top, base));
    if (kind == Kind::exponential && !(scale > 0))
        return data_error(fmt::format("scale is {}; it must be above 0", scale));
    return {};
}

Eigen::Vector2d wind_offset(const Wind& wind, const Rect& rect, Boundary boundary, double seconds) {
    Eigen::Vector2d metres = wind.offset(seconds);
    if (boundary == Boundary::repeat)
        metres = {std::remainder(metres.x(), rect.x1 - rect.x0),
                  std::remainder(metres.y(), rect.z1 - rect.z0)};
    return metres;
}

Result<void> Fog::validate() const {
    if (!(std::isfinite(rect.x0) && std::isfinite(rect.x1) && rect.x0 < rect.x1 &&
          std::isfinite(rect.z0) && std::isfinite(rect.z1) && rect.z0 < rect.z1))
        return data_error(
            fmt::format("rect is [{}, {}, {}, {}]; it must be [x0, z0, x1, z1] with "
                        "x0 < x1 and z0 < z1",
                        rect.x0, rect.z0, rect.x1, rect.z1));
    if (!std::isfinite(rect.x1 - rect.x0) || !std::isfinite(rect.z1 - rect.z0))
        return data_error("rect is wider than a double can hold; choose a smaller one");
    if (!(std::isfinite(extinction) && extinction >= 0))
        return data_error(fmt::format("extinction is {}; it must be 0 or more (1/m)", extinction));
    if (auto ok = profile.validate(); !ok)
        return data_error("height profile: " + ok.error().message);
    if (auto ok = wind.validate(); !ok) return data_error("wind" + ok.error().message);
    if (auto ok = wavefog::validate(channels); !ok) return ok;
    if (degree() < 0 || degree() > kMaxDegree)
        return data_error(
            fmt::format("spline degree is {}; it must be 0 to {}", degree(), kMaxDegree));
    if (decomposition.width < 1 || decomposition.height < 1 ||
        decomposition.approximation.values.size() == 0)
        return data_error("the fog has no coefficients; read a fogmap of at least one pixel");
    if (!all_finite(decomposition))
        return data_error(
            "a coefficient is NaN or infinite; convert the map again with --sanitize");
    return {};
}

Result<Fog> make_fog(const Grid<float>& map, const FogOptions& options) {
    if (map.size() == 0) return data_error("the map has no pixels; at least one is needed");
    for (Eigen::Index j = 0; j < map.rows(); ++j)
        for (Eigen::Index i = 0; i < map.cols(); ++i)
            if (!(map(j, i) >= 0 && std::isfinite(map(j, i))))
                return data_error(
                    fmt::format("pixel ({}, {}) is {}; a fogmap is finite and not "
                                "negative: read it with --sanitize",
                                i, j, map(j, i)));
    if (options.degree < 0 || options.degree > kMaxDegree)
        return usage_error(fmt::format("spline degree {} does not exist here; use 0 (haar) to {}",
                                       options.degree, kMaxDegree));
    if (options.levels < -1)
        return usage_error(fmt::format("levels is {}; use 0 or more, or auto", options.levels));

    Family family = default_family(options.degree, options.form);
    if (!options.family.empty()) {
        const auto parsed = parse_family(options.family, options.degree);
        if (!parsed) return tl::unexpected(parsed.error());
        family = *parsed;
    }
    const int most =
        max_levels(static_cast<int>(map.cols()), static_cast<int>(map.rows()), options.boundary);
    const int levels = options.levels >= 0 ? options.levels : std::min(kAutoLevels, most);
    try {
        auto decomposition = decompose(map, family, levels, options.form, options.boundary);
        if (!decomposition) return tl::unexpected(decomposition.error());
        if (!all_finite(*decomposition))
            return data_error(
                fmt::format("densities up to {} overflow in sums of floats; divide the map, and "
                            "multiply the extinction by as much",
                            map.maxCoeff()));
        Fog fog;
        fog.decomposition = std::move(*decomposition);
        fog.rect = {0, 0, static_cast<double>(map.cols()), static_cast<double>(map.rows())};
        return fog;
    } catch (const std::bad_alloc&) {
        return data_error(
            fmt::format("not enough memory for the transform of {} x {} pixels; use a "
                        "smaller map",
                        map.cols(), map.rows()));
    }
}

}  // namespace wavefog
