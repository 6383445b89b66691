#include "context_mixer.h"

namespace wavefog::wfog {

namespace {

// exp and ln from basic operations: the C library's may differ in the last bit.

double exponential(double x) {
    double sum = 1, term = 1;
    const double part = x / 64;  // |part| < 0.2
    for (int n = 1; n < 16; ++n) {
        term = term * part / n;
        sum = sum + term;
    }
    for (int i = 0; i < 6; ++i) sum = sum * sum;
    return sum;
}

double logarithm(double x) {
    constexpr double ln2 = 0.69314718055994531;
    double result = 0;
    for (; x > 1.5; x = x / 2) result = result + ln2;
    for (; x < 0.75; x = x * 2) result = result - ln2;
    const double z = (x - 1) / (x + 1);
    double power = z;
    for (int n = 1; n < 40; n += 2) {
        result = result + 2 * power / n;
        power = power * z * z;
    }
    return result;
}

}  // namespace

MixerTables::MixerTables() {
    for (std::size_t i = 0; i < stretch.size(); ++i) {
        const double p = (static_cast<double>(i) + 0.5) / 4096;
        stretch[i] = static_cast<float>(logarithm(p / (1 - p)));
        squash[i] =
            static_cast<float>(1 / (1 + exponential((2047.5 - static_cast<double>(i)) / 170)));
    }
    for (std::size_t n = 0; n < rates.size(); ++n)
        rates[n] = static_cast<std::uint16_t>(65536 * 5 / (5 * n + 8));
}

const MixerTables& mixer_tables() {
    static const MixerTables tables;
    return tables;
}

ContextMixer::ContextMixer(const std::array<std::uint32_t, kContexts>& sizes)
    : first_(kNodes * kFirstSets * kInputs, 0.2f), second_(kNodes * kSecondSets * kInputs, 0.2f) {
    for (std::size_t i = 0; i < kContexts; ++i)
        estimates_[i].resize(std::size_t(sizes[i]) * kNodes);
}

}  // namespace wavefog::wfog
