#include "wavefog/wavelet/interpolate.h"

namespace wavefog {
namespace {

void mix(const Band<float>& a, const Band<float>& b, float share, Band<float>& out) {
    out.start_x = a.start_x;
    out.start_z = a.start_z;
    // The ends come back bit for bit, infinities of neither reach the other.
    if (share == 0)
        out.values = a.values;
    else if (share == 1)
        out.values = b.values;
    else
        out.values = (1 - share) * a.values + share * b.values;
}

}  // namespace

Result<void> interpolate(const Decomposition<float>& a, const Decomposition<float>& b, double share,
                         Decomposition<float>& out) {
    if (a.width != b.width || a.height != b.height || a.family != b.family || a.form != b.form ||
        a.boundary != b.boundary || a.levels() != b.levels())
        return data_error(
            "the maps differ in size, basis, family, form, wrap or levels; decompose both in the "
            "same way");
    out.family = a.family;
    out.form = a.form;
    out.boundary = a.boundary;
    out.width = a.width;
    out.height = a.height;
    out.details.resize(a.details.size());
    const auto weight = static_cast<float>(share);
    mix(a.approximation, b.approximation, weight, out.approximation);
    for (std::size_t l = 0; l < a.details.size(); ++l)
        for (const auto band : {&Detail<float>::phi_psi, &Detail<float>::psi_phi,
                                &Detail<float>::psi_psi, &Detail<float>::residual})
            mix(a.details[l].*band, b.details[l].*band, weight, out.details[l].*band);
    return {};
}

}  // namespace wavefog
