#include "wavefog/fogmap/camera_file.h"

#include "camera_reader.h"
#include "file_io.h"

namespace wavefog {
namespace {

using detail::JsonValue;

constexpr std::uintmax_t kMaxCameraBytes = 1u << 20;

DepthValues read_depth_values(const JsonValue& value) {
    using Kind = DepthValues::Kind;
    DepthValues depth;
    constexpr Kind kinds[] = {Kind::gl, Kind::metres, Kind::inverse};
    depth.kind = kinds[value.key("depth_values").choice({"gl", "metres", "inverse"})];
    if (depth.kind == Kind::gl) {
        for (const char* key : {"measured", "depth_scale", "depth_offset", "unmeasured"})
            if (const auto found = value.find(key))
                found->fail("belongs to depth in metres; remove it, or change \"depth_values\"");
        return depth;
    }
    depth.measured = value.key("measured").choice({"axis", "distance"}) == 0
                         ? DepthValues::Measured::axis
                         : DepthValues::Measured::distance;
    if (const auto scale = value.find("depth_scale")) depth.scale = scale->above(0);
    if (const auto offset = value.find("depth_offset")) depth.offset = offset->number();
    if (const auto unmeasured = value.find("unmeasured"))
        depth.unmeasured = unmeasured->choice({"background", "neighbours"}) == 0
                               ? DepthValues::Unmeasured::background
                               : DepthValues::Unmeasured::neighbours;
    return depth;
}

}  // namespace

Result<CameraFile> load_camera(const std::filesystem::path& file) {
    try {
        const auto text = detail::read_text_file(file, kMaxCameraBytes);
        if (!text) return tl::unexpected(text.error());
        const std::string name = file.string();
        const auto json = detail::parse_json(*text, name);
        if (!json) return tl::unexpected(json.error());
        const JsonValue root(*json, name);
        return CameraFile{detail::read_camera(root, {"depth_values", "measured", "depth_scale",
                                                     "depth_offset", "unmeasured"}),
                          read_depth_values(root)};
    } catch (const detail::JsonFailure& failure) {
        return tl::unexpected(failure.error);
    }
}

}  // namespace wavefog
