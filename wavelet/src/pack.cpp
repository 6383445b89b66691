#include "wavefog/wavelet/pack.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "range.h"
#include "scheme.h"

namespace wavefog {
namespace {

constexpr int kGap = 1;             // zero texels between two levels
constexpr int kMostSide = 1 << 24;  // of a map; keeps all index arithmetic far from overflow

// The bands of one packed level in the order of the channels; null where there is none. One
// function for both directions, so that packing and unpacking cannot disagree.
template <class Decomposed>
auto channel_bands(Decomposed& decomposition, int level) {
    using BandPointer = decltype(&decomposition.approximation);
    std::array<BandPointer, 4> bands{};
    const bool wavelet = decomposition.form == Form::wavelet;
    if (level == 0 || (wavelet && level == 1)) bands[0] = &decomposition.approximation;
    if (level == 0) return bands;
    auto& detail = decomposition.details[static_cast<std::size_t>(level - 1)];
    if (wavelet) {
        bands[1] = &detail.phi_psi;
        bands[2] = &detail.psi_phi;
        bands[3] = &detail.psi_psi;
    } else {
        bands[0] = &detail.residual;
    }
    return bands;
}

int first_level(Form form, int detail_levels) {
    return form == Form::wavelet && detail_levels > 0 ? 1 : 0;
}

PackedLevel describe(const Decomposition<float>& decomposition, int level) {
    PackedLevel out;
    out.level = level;
    const auto bands = channel_bands(decomposition, level);
    IndexRect rect;
    for (std::size_t c = 0; c < 4; ++c) {
        if (!bands[c]) continue;
        const Band<float>& band = *bands[c];
        out.channels[c] = {band.start_x, band.start_z, band.width(), band.height()};
        if (band.values.size() == 0) continue;
        const IndexRect own = rect_of(band);
        rect = rect.x.size() > 0 ? IndexRect{hull(rect.x, own.x), hull(rect.z, own.z)} : own;
    }
    out.width = rect.x.size();
    out.height = rect.z.size();
    out.origin_x = rect.x.first;
    out.origin_z = rect.z.first;
    return out;
}

PackedAtlas empty_atlas(const Decomposition<float>& decomposition) {
    PackedAtlas atlas;
    atlas.family = decomposition.family;
    atlas.form = decomposition.form;
    atlas.boundary = decomposition.boundary;
    atlas.map_width = decomposition.width;
    atlas.map_height = decomposition.height;
    atlas.detail_levels = decomposition.levels();
    return atlas;
}

std::size_t texel(const PackedAtlas& atlas, int x, int y) {
    return 4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(atlas.width) +
                static_cast<std::size_t>(x));
}

// Calls act(texel value, coefficient) for all coefficients of a level.
template <class Atlas, class Bands, class Act>
void visit_texels(Atlas& atlas, const PackedLevel& level, const Bands& bands, const Act& act) {
    for (std::size_t c = 0; c < 4; ++c) {
        if (!bands[c]) continue;
        const PackedBand& place = level.channels[c];
        for (int j = 0; j < place.height; ++j) {
            std::size_t at = texel(atlas, level.x + place.start_x - level.origin_x,
                                   level.y + place.start_z - level.origin_z + j) +
                             c;
            for (int i = 0; i < place.width; ++i, at += 4)
                act(atlas.rgba[at], bands[c]->values(j, i));
        }
    }
}

void fill(PackedAtlas& atlas, const Decomposition<float>& decomposition) {
    atlas.rgba.assign(texel(atlas, 0, atlas.height), 0.0f);
    for (const PackedLevel& level : atlas.levels)
        visit_texels(atlas, level, channel_bands(decomposition, level.level),
                     [](float& to, const float& from) { to = from; });
}

// The finest level at (0, 0), the others in a line to its right or below, whichever is smaller.
void lay_out(PackedAtlas& atlas) {
    const PackedLevel& finest = atlas.levels.back();
    int along_x = 0, along_y = 0, widest = 0, highest = 0;
    for (auto level = atlas.levels.begin(); level + 1 != atlas.levels.end(); ++level) {
        along_x += level->width + kGap;
        along_y += level->height + kGap;
        widest = std::max(widest, level->width);
        highest = std::max(highest, level->height);
    }
    const bool alone = atlas.levels.size() == 1;
    const int gap = alone ? 0 : kGap;
    const int right_width = finest.width + gap + widest;
    const int right_height = std::max(finest.height, along_y - gap);
    const int below_width = std::max(finest.width, along_x - gap);
    const int below_height = finest.height + gap + highest;
    const bool right = static_cast<std::int64_t>(right_width) * right_height <=
                       static_cast<std::int64_t>(below_width) * below_height;
    atlas.width = right ? right_width : below_width;
    atlas.height = right ? right_height : below_height;
    int next = 0;
    for (auto level = atlas.levels.rbegin() + 1; level < atlas.levels.rend(); ++level) {
        level->x = right ? finest.width + gap : next;
        level->y = right ? next : finest.height + gap;
        next += (right ? level->height : level->width) + kGap;
    }
}

tl::unexpected<Error> damaged(int level, const std::string& what) {
    return data_error("packed level " + std::to_string(level) + ": " + what +
                      "; the metadata do not belong to this image");
}

// Empty text when the level's rectangle and all its bands lie inside the image.
std::string misfit(const PackedAtlas& atlas, const PackedLevel& level) {
    const auto inside = [](std::int64_t first, std::int64_t size, std::int64_t limit) {
        return first >= 0 && size >= 0 && first + size <= limit;
    };
    if (!inside(level.x, level.width, atlas.width) || !inside(level.y, level.height, atlas.height))
        return "its rectangle reaches outside the image";
    if (std::max(std::abs(std::int64_t{level.origin_x}), std::abs(std::int64_t{level.origin_z})) >
        kMostSide)
        return "its first index is out of range";
    for (const PackedBand& band : level.channels)
        if (band.width != 0 || band.height != 0)
            if (!inside(std::int64_t{band.start_x} - level.origin_x, band.width, level.width) ||
                !inside(std::int64_t{band.start_z} - level.origin_z, band.height, level.height))
                return "a band reaches outside its rectangle";
    return {};
}

Result<void> check_header(const PackedAtlas& atlas) {
    if (std::min(atlas.map_width, atlas.map_height) < 1 ||
        std::max(atlas.map_width, atlas.map_height) > kMostSide)
        return data_error("packed image: map of " + std::to_string(atlas.map_width) + "x" +
                          std::to_string(atlas.map_height) + " pixels; each side has 1 to " +
                          std::to_string(kMostSide));
    if (atlas.family.kind == Family::Kind::positive && atlas.form == Form::wavelet)
        return data_error("packed image: family positive in wavelet form; it has no wavelets");
    if (const Result<Scheme> scheme = Scheme::make(atlas.family, atlas.boundary); !scheme)
        return data_error("packed image: " + scheme.error().message);
    const int most = max_levels(atlas.family, atlas.map_width, atlas.map_height, atlas.boundary);
    if (atlas.detail_levels < 0 || atlas.detail_levels > most)
        return data_error("packed image: " + std::to_string(atlas.detail_levels) +
                          " levels; a map of this size has 0 to " + std::to_string(most));
    return {};
}

}  // namespace

PackedAtlas pack(const Decomposition<float>& decomposition) {
    PackedAtlas atlas = empty_atlas(decomposition);
    for (int l = first_level(atlas.form, atlas.detail_levels); l <= atlas.detail_levels; ++l)
        atlas.levels.push_back(describe(decomposition, l));
    lay_out(atlas);
    fill(atlas, decomposition);
    return atlas;
}

std::vector<PackedAtlas> pack_levels(const Decomposition<float>& decomposition) {
    std::vector<PackedAtlas> images;
    const int levels = decomposition.levels();
    for (int l = first_level(decomposition.form, levels); l <= levels; ++l) {
        PackedAtlas image = empty_atlas(decomposition);
        image.levels.push_back(describe(decomposition, l));
        lay_out(image);
        fill(image, decomposition);
        images.push_back(std::move(image));
    }
    return images;
}

Result<Decomposition<float>> unpack(const PackedAtlas& atlas) {
    return unpack({&atlas, 1});
}

Result<Decomposition<float>> unpack(std::span<const PackedAtlas> images) {
    if (images.empty()) return data_error("packed images: there is none; give at least one");
    const PackedAtlas& head = images.front();
    if (const Result<void> checked = check_header(head); !checked)
        return tl::unexpected<Error>(checked.error());

    Decomposition<float> out;
    out.family = head.family;
    out.form = head.form;
    out.boundary = head.boundary;
    out.width = head.map_width;
    out.height = head.map_height;
    out.details.resize(static_cast<std::size_t>(head.detail_levels));
    std::vector<bool> found(out.details.size() + 1, false);
    found[0] = first_level(head.form, head.detail_levels) == 1;
    for (const PackedAtlas& image : images) {
        if (image.width < 0 || image.height < 0 ||
            image.rgba.size() != texel(image, 0, image.height))
            return data_error("packed image: holds " + std::to_string(image.rgba.size()) +
                              " values; its size asks for another number");
        for (const PackedLevel& level : image.levels) {
            if (level.level < 0 || level.level > head.detail_levels)
                return damaged(level.level, "there is no such level");
            if (found[static_cast<std::size_t>(level.level)])
                return damaged(level.level, "is there twice");
            found[static_cast<std::size_t>(level.level)] = true;
            if (const std::string what = misfit(image, level); !what.empty())
                return damaged(level.level, what);
            const auto bands = channel_bands(out, level.level);
            for (std::size_t c = 0; c < 4; ++c) {
                if (!bands[c]) continue;
                const PackedBand& place = level.channels[c];
                *bands[c] = {Grid<float>(place.height, place.width), place.start_x, place.start_z};
            }
            visit_texels(image, level, bands, [](const float& from, float& to) { to = from; });
        }
    }
    for (std::size_t l = 0; l < found.size(); ++l)
        if (!found[l]) return damaged(static_cast<int>(l), "is missing");
    return out;
}

}  // namespace wavefog
