// The description of a fog file: what its textures mean. The same keys stand in the EXR header
// ("wavefog.KEY") and in the JSON file beside it.
#pragma once

#include <string>
#include <vector>

#include "json_reader.h"
#include "wavefog/fogmap/fog_file.h"
#include "wavefog/wavelet/pack.h"

namespace wavefog::detail {

inline constexpr int kFogFileVersion = 1;

struct FogTexture {
    std::string image;  ///< file name, in the directory of the description
    std::string part;   ///< name of the part in a multi-part file, else empty
    PackedAtlas atlas;  ///< layout; `rgba` is kept in the image
};

struct FogMeta {
    Layout layout = Layout::atlas;
    bool half = false;
    double scale = 1;  ///< coefficient = texel * scale; a power of two, so that floats stay exact
    Fog fog;           ///< all but the coefficients
    std::vector<FogTexture> textures;
};

nlohmann::json write_meta(const FogMeta& meta);

/// Throws JsonFailure if a value is missing or impossible. That the layout fits the images is
/// unpack()'s to check.
FogMeta read_meta(const JsonValue& value);

/// True if the object describes a fog file of any version.
bool is_meta(const nlohmann::json& value);

}  // namespace wavefog::detail
