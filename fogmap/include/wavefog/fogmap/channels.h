// What red, green and blue see of a fog.
#pragma once

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "wavefog/wavelet/result.h"

namespace wavefog {

/// How much of a fog's extinction red, green and blue see (paper 001, section 3.2.5). A density of
/// its own for each channel is three fogs, each seen by one.
using Channels = std::array<double, 3>;
inline constexpr Channels kAllChannels = {1, 1, 1};

/// A data error for channels that are negative, not finite, or all 0.
Result<void> validate(const Channels& channels);

/// Those that the colours see alike together, in the order in which they first come. T has a field
/// `channels`.
template <class T>
std::vector<std::vector<T>> by_channels(std::vector<T> all) {
    std::vector<std::vector<T>> groups;
    for (T& one : all) {
        const auto same = std::find_if(groups.begin(), groups.end(), [&](const auto& group) {
            return group.front().channels == one.channels;
        });
        if (same == groups.end())
            groups.emplace_back().push_back(std::move(one));
        else
            same->push_back(std::move(one));
    }
    return groups;
}

/// Those of things that the colours see alike.
template <class T>
const Channels& common_channels(const std::vector<T>& alike) {
    return alike.empty() ? kAllChannels : alike.front().channels;
}

/// The different channels there are, in the order in which they first come.
template <class T>
std::vector<Channels> channels_of(const std::vector<T>& all) {
    std::vector<Channels> found;
    for (const T& one : all)
        if (std::find(found.begin(), found.end(), one.channels) == found.end())
            found.push_back(one.channels);
    return found;
}

}  // namespace wavefog
