#include "wavefog/fogmap/map_sequence.h"

#include <fmt/format.h>

#include "keyframes.h"
#include "wavefog/wavelet/interpolate.h"

namespace wavefog {

Result<const Decomposition<float>*> SequencePlayer::key(std::size_t index, std::size_t other) {
    for (const Decomposed& kept : kept_)
        if (kept.key == index) return &kept.map;
    const auto fail = [&](const std::string& what) {
        return data_error(fmt::format("{}[{}]: {}", sequence_.place, index, what));
    };
    const auto picture = read_fogmap(sequence_.keys[index].image, sequence_.read);
    if (!picture) return fail(picture.error().message);
    auto fog = make_fog(picture->pixels, sequence_.options);
    if (!fog) return fail(fog.error().message);
    std::erase_if(kept_, [&](const Decomposed& kept) { return kept.key != other; });
    kept_.reserve(2);  // pointers into it stay
    kept_.push_back({index, std::move(fog->decomposition)});
    return &kept_.back().map;
}

Result<void> SequencePlayer::show(double seconds, Fog& fog) {
    const auto& keys = sequence_.keys;
    const auto [a, b, share] = detail::between_keys(keys, seconds);
    const auto first = key(a, b);
    if (!first) return tl::unexpected(first.error());
    if (share == 0) {
        fog.decomposition = **first;
        return {};
    }
    const auto second = key(b, a);
    if (!second) return tl::unexpected(second.error());
    // key() may have moved what it kept.
    const auto again = key(a, b);
    const Decomposition<float>&from = **again, &to = **second;
    if (from.width != to.width || from.height != to.height)
        return data_error(
            fmt::format("{}: [{}] ({}) has {}x{} pixels, [{}] ({}) {}x{}; resize one of them",
                        sequence_.place, a, keys[a].image.string(), from.width, from.height, b,
                        keys[b].image.string(), to.width, to.height));
    if (auto ok = interpolate(**again, **second, share, fog.decomposition); !ok)
        return data_error(fmt::format("{}: [{}] ({}) and [{}] ({}): {}", sequence_.place, a,
                                      keys[a].image.string(), b, keys[b].image.string(),
                                      ok.error().message));
    return {};
}

}  // namespace wavefog
