#include "bands.h"

#include <cstring>

#include "plane.h"

namespace wavefog::wfog {

namespace {

template <class BandPointer, class D>
std::vector<std::vector<BandPointer>> list_bands(D& d) {
    std::vector<std::vector<BandPointer>> levels = {{&d.approximation}};
    for (auto& detail : d.details)
        levels.push_back({&detail.phi_psi, &detail.psi_phi, &detail.psi_psi, &detail.residual});
    return levels;
}

}  // namespace

std::vector<std::vector<Band<float>*>> bands_of(Decomposition<float>& d) {
    return list_bands<Band<float>*>(d);
}
std::vector<std::vector<const Band<float>*>> bands_of(const Decomposition<float>& d) {
    return list_bands<const Band<float>*>(d);
}

bool same_coefficients(const Decomposition<float>& a, const Decomposition<float>& b) {
    const auto ours = bands_of(a), theirs = bands_of(b);
    if (ours.size() != theirs.size()) return false;
    for (std::size_t level = 0; level < ours.size(); ++level)
        for (std::size_t i = 0; i < ours[level].size(); ++i) {
            const Grid<float>&x = ours[level][i]->values, &y = theirs[level][i]->values;
            if (x.rows() != y.rows() || x.cols() != y.cols()) return false;
            // Empty bands have no address.
            if (x.size() > 0 &&
                std::memcmp(x.data(), y.data(), std::size_t(x.size()) * sizeof(float)) != 0)
                return false;
        }
    return true;
}

int band_levels(const Band<float>& band, int tile_bits) {
    return default_stream_levels(band.width(), band.height(), tile_bits);
}

}  // namespace wavefog::wfog
