#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "wavefog/wavelet/cell.h"

namespace wavefog {
namespace {

constexpr int kMaxNodes = 64;

// Newton's method on the Legendre polynomial P_n, from Tricomi's estimate of its roots.
GaussRule make_rule(int n) {
    GaussRule rule;
    rule.nodes.resize(static_cast<std::size_t>(n));
    rule.weights.resize(static_cast<std::size_t>(n));
    for (int i = 0; i < n; ++i) {
        long double x = std::cos(std::numbers::pi_v<long double> * (i + 0.75L) / (n + 0.5L));
        long double derivative = 1;
        // Quadratic convergence: 6 steps go far below the rounding of long double.
        for (int step = 0; step < 6; ++step) {
            long double before = 1, value = x;
            for (int k = 2; k <= n; ++k) {
                const long double next = ((2 * k - 1) * x * value - (k - 1) * before) / k;
                before = value;
                value = next;
            }
            derivative = n * (x * value - before) / (x * x - 1);
            x -= value / derivative;
        }
        const auto at = static_cast<std::size_t>(n - 1 - i);
        rule.nodes[at] = static_cast<double>((1 + x) / 2);
        rule.weights[at] = static_cast<double>(1 / ((1 - x * x) * derivative * derivative));
    }
    return rule;
}

}  // namespace

const GaussRule& gauss_legendre(int n) {
    static const std::array<GaussRule, kMaxNodes> rules = [] {
        std::array<GaussRule, kMaxNodes> all;
        for (int count = 1; count <= kMaxNodes; ++count)
            all[static_cast<std::size_t>(count - 1)] = make_rule(count);
        return all;
    }();
    return rules[static_cast<std::size_t>(std::clamp(n, 1, kMaxNodes) - 1)];
}

}  // namespace wavefog
