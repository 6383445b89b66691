#include "paper_data.h"

#include <algorithm>

namespace wavefog {
namespace {

// Exact for degree 0 and 1; 1.6e-4 of a cell for degree 2 (stability.md 7).
int default_samples(int degree) {
    return degree < 2 ? 2 : 32;
}

// The bands lie in texels, level by level; the shader wants the texel of index (0, 0).
void place_levels(const PackedAtlas& atlas, shader::PaperBlock& block) {
    const auto place = [&](int l, const PackedLevel& p) {
        block.place[l] = {p.x - p.origin_x, p.y - p.origin_z, 0, 0};
        block.range[l] = {p.origin_x, p.origin_z, p.origin_x + p.width, p.origin_z + p.height};
    };
    for (const auto& packed : atlas.levels) {
        place(packed.level, packed);
        // The approximation lives in the red channel of the coarsest details.
        if (packed.level == 1 && atlas.form == Form::wavelet) place(0, packed);
    }
}

}  // namespace

Result<PaperData> make_paper_data(const Decomposition<float>& decomposition, const Method& method,
                                  double density_scale) {
    const bool wavelets = method.kind == MethodKind::paper && decomposition.levels() > 0;
    if (wavelets && decomposition.form != Form::wavelet)
        return usage_error(
            "method paper: walks through wavelet bands, this fog is in scaling form; use "
            "paper-scaling, or convert with --form wavelet");
    const int samples = method.table > 0 ? method.table : default_samples(decomposition.degree());
    auto table = make_path_table(decomposition.family, samples, method.layout, wavelets);
    if (!table) return tl::unexpected(table.error());

    PaperData data;
    data.table = std::move(*table);
    data.bands = pack(method.kind == MethodKind::paper || decomposition.form == Form::scaling
                          ? decomposition
                          : to_scaling_form(decomposition));
    const float to_texel = static_cast<float>(1 / density_scale);
    for (float& v : data.bands.rgba) v *= to_texel;

    auto& block = data.block;
    block = {};
    place_levels(data.bands, block);
    const auto& functions = data.table.functions;
    for (int f = 0; f < 4; ++f)
        block.first_block[f] = functions[static_cast<std::size_t>(f)].first_block;
    const int phi = 2 * (data.table.degree + 1), psi = functions[3].pieces_x;
    const int first = std::min(0, data.table.psi_first);
    const int last = std::max(phi, data.table.psi_first + psi);
    block.pieces = {phi, psi, data.table.psi_first, 0};
    const int patches = method.layout == PathLayout::mean ? samples - 1 : 4 * samples;
    block.table = {patches, method.layout == PathLayout::perimeter ? 1 : 0, first,
                   (last - first + 1) / 2};
    return data;
}

}  // namespace wavefog
