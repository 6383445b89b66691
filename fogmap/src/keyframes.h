// Where a time lies among keys that have a time each.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace wavefog::detail {

/// Between keys `a` and `b` at `share` of the way; before the first and after the last at rest, a
/// = b.
struct BetweenKeys {
    std::size_t a = 0, b = 0;
    double share = 0;
};

/// `keys`: at least one, their `seconds` ascending.
template <class Key>
BetweenKeys between_keys(const std::vector<Key>& keys, double seconds) {
    const auto after =
        std::upper_bound(keys.begin(), keys.end(), seconds,
                         [](double time, const Key& key) { return time < key.seconds; });
    const auto next = static_cast<std::size_t>(after - keys.begin());
    const std::size_t a = next == 0 ? 0 : next - 1, b = std::min(next, keys.size() - 1);
    if (a == b) return {a, b, 0};
    return {a, b, (seconds - keys[a].seconds) / (keys[b].seconds - keys[a].seconds)};
}

}  // namespace wavefog::detail
