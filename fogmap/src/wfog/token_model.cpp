#include "token_model.h"

#include <algorithm>

#include "context_mixer.h"

namespace wavefog::wfog {

using std::size_t;
using std::uint32_t;

Frequencies frequencies_of(const TokenModel& model) {
    Frequencies f;
    float left = 1;
    uint32_t sum = 0;
    size_t largest = 0;
    for (size_t t = 0; t < kTokens; ++t) {
        const float stop =
            t == kLargest
                ? 1.0f
                : mixer_tables().squash[size_t(model.stops[std::min<size_t>(t, 3)]) * 16 + 8];
        const float here = left * stop;
        left = left - here;
        // The last 16 of the scale make sure that every token has one.
        f.frequency[t] =
            static_cast<std::uint16_t>(1 + static_cast<int>(here * float(kScale - 32)));
        sum += f.frequency[t];
        if (f.frequency[t] > f.frequency[largest]) largest = t;
    }
    f.frequency[largest] = static_cast<std::uint16_t>(f.frequency[largest] + kScale - sum);
    sum = 0;
    for (size_t t = 0; t < kTokens; ++t) {
        f.start[t] = static_cast<std::uint16_t>(sum);
        sum += f.frequency[t];
    }
    return f;
}

}  // namespace wavefog::wfog
