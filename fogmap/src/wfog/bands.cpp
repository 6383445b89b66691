#include "bands.h"

#include <algorithm>
#include <bit>
#include <cstdint>

#include "plane.h"

namespace wavefog::wfog {

std::vector<std::vector<Band<float>*>> bands_of(Decomposition<float>& d) {
    std::vector<std::vector<Band<float>*>> levels = {{&d.approximation}};
    for (Detail<float>& detail : d.details)
        levels.push_back({&detail.phi_psi, &detail.psi_phi, &detail.psi_psi, &detail.residual});
    return levels;
}

bool same_coefficients(const Decomposition<float>& a, const Decomposition<float>& b) {
    Decomposition<float> first = a, second = b;
    const auto ours = bands_of(first), theirs = bands_of(second);
    if (ours.size() != theirs.size()) return false;
    for (std::size_t level = 0; level < ours.size(); ++level)
        for (std::size_t i = 0; i < ours[level].size(); ++i) {
            const Grid<float>&x = ours[level][i]->values, &y = theirs[level][i]->values;
            if (x.rows() != y.rows() || x.cols() != y.cols() ||
                !std::equal(x.data(), x.data() + x.size(), y.data(), [](float p, float q) {
                    return std::bit_cast<std::uint32_t>(p) == std::bit_cast<std::uint32_t>(q);
                }))
                return false;
        }
    return true;
}

int band_levels(const Band<float>& band, int tile_bits) {
    return default_stream_levels(band.width(), band.height(), tile_bits);
}

}  // namespace wavefog::wfog
