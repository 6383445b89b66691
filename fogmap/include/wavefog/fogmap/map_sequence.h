// A fog whose map changes in time: pictures as keyframes, mixed in coefficient space.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "wavefog/fogmap/fog.h"
#include "wavefog/fogmap/image.h"

namespace wavefog {

/// Coefficients are linear in time between keys, and those of the first and the last one before and
/// after. All pictures have the same size.
struct MapSequence {
    struct Key {
        double seconds = 0;
        std::filesystem::path image;
    };
    std::vector<Key> keys;  ///< at least one; times ascend
    ReadOptions read;
    FogOptions options;
    std::size_t fog = 0;  ///< of Scene::fogs, which holds it as it is at time 0
    std::string place;    ///< in the scene file, for messages: "scene.json: fog[0].images"
};

/// Reads and decomposes a picture when its time comes, and keeps those on both sides.
class SequencePlayer {
  public:
    explicit SequencePlayer(MapSequence sequence) : sequence_(std::move(sequence)) {}
    /// Sets fog.decomposition to that of a time. It depends on the time alone, not on earlier
    /// calls. A data error names the scene's key and the picture.
    Result<void> show(double seconds, Fog& fog);

  private:
    struct Decomposed {
        std::size_t key = 0;
        Decomposition<float> map;
    };
    Result<const Decomposition<float>*> key(std::size_t index, std::size_t other);

    MapSequence sequence_;
    std::vector<Decomposed> kept_;  ///< at most two
};

}  // namespace wavefog
