#include "particles_reader.h"

#include <numbers>

#include "model_reader.h"

namespace wavefog::detail {

ParticleSource read_particles(const JsonValue& value) {
    value.only({"model", "source", "position", "area", "direction", "spread_deg", "speed", "rate",
                "life", "step", "radius", "opacity", "lift", "drag", "wind", "seed", "channels"});
    ParticleSource source;
    // Lives and opacities of paper 003.
    if (value.key("source").choice({"fog", "smoke"}) == 1) {
        source.life = {8, 16};
        source.opacity = 0.9;
    }
    source.position = value.key("position").vector3();
    source.rate = value.key("rate").number();
    const auto radius = value.key("radius").numbers(2);
    source.radius = {radius[0], radius[1]};
    if (const auto direction = value.find("direction")) {
        const Eigen::Vector3d v = direction->vector3();
        source.direction = v.norm() > 0 ? v.stableNormalized() : v;
    }
    if (const auto spread = value.find("spread_deg"))
        source.spread = spread->number() * std::numbers::pi / 180;
    if (const auto life = value.find("life")) {
        const auto ends = life->items();
        if (ends.size() != 2) life->fail("must be [least, most] in steps");
        source.life = {ends[0].integer(1, 1 << 20), ends[1].integer(1, 1 << 20)};
    }
    for (const auto& [key, field] : {std::pair{"area", &source.area},
                                     {"speed", &source.speed},
                                     {"step", &source.step},
                                     {"opacity", &source.opacity},
                                     {"lift", &source.lift},
                                     {"drag", &source.drag}})
        if (const auto found = value.find(key)) *field = found->number();
    if (const auto wind = value.find("wind")) source.wind = read_wind(*wind);
    if (const auto seed = value.find("seed"))
        source.seed = static_cast<std::uint64_t>(seed->integer(0, 1 << 30));
    if (const auto channels = value.find("channels")) source.channels = read_channels(*channels);
    if (const auto ok = source.validate(); !ok) value.fail(ok.error().message);
    return source;
}

}  // namespace wavefog::detail
