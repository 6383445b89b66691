#include <fmt/format.h>

#include <charconv>
#include <optional>
#include <string_view>
#include <vector>

#include "wavefog/fogmap/scene.h"

namespace wavefog {

namespace {

constexpr int kMaxSamples = 65536;
constexpr int kMinTable = 2, kMaxTable = 128;
constexpr int kMaxFroxels = 1024;
constexpr int kMinRadial = 2, kMaxRadial = 8192;
constexpr const char* kMethods =
    "reference, exact, radial[:AZIMUTHSxROWS][:step], paper[:N[:perimeter]], "
    "paper-scaling[:N[:perimeter]], march:N, "
    "froxel:XxYxZ, homogeneous";
constexpr int kLargestSampling = 16384;  // as a picture's sides

std::vector<std::string_view> split(std::string_view text, char at) {
    std::vector<std::string_view> parts;
    for (;;) {
        const auto end = text.find(at);
        parts.push_back(text.substr(0, end));
        if (end == std::string_view::npos) return parts;
        text.remove_prefix(end + 1);
    }
}

std::optional<int> number(std::string_view text, int low, int high) {
    int value = 0;
    const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || stop != text.data() + text.size() || value < low || value > high)
        return std::nullopt;
    return value;
}

// Options after the name; false if they do not fit.
bool parse_table(const std::vector<std::string_view>& parts, Method& method) {
    if (parts.size() > 1) {
        const auto table = number(parts[1], kMinTable, kMaxTable);
        if (!table) return false;
        method.table = *table;
    }
    if (parts.size() > 2 && parts[2] != "perimeter") return false;
    if (parts.size() == 3) method.layout = PathLayout::perimeter;
    return parts.size() <= 3;
}

// "AxBx...": as many sizes as `values` has.
template <std::size_t N>
bool parse_sizes(std::string_view text, int low, int high, int (&values)[N]) {
    const auto sizes = split(text, 'x');
    if (sizes.size() != N) return false;
    for (std::size_t i = 0; i < N; ++i) {
        const auto size = number(sizes[i], low, high);
        if (!size) return false;
        values[i] = *size;
    }
    return true;
}

// "256x256", "256x256:average", "vertices"; empty if it is none of these.
std::optional<FogSampling> sampling_of(std::string_view text) {
    FogSampling sampling;
    sampling.vertices = text == "vertices";
    if (sampling.vertices) return sampling;
    const auto parts = split(text, ':');
    int sides[2] = {0, 0};
    if (parts.size() > 2 || !parse_sizes(parts[0], 1, kLargestSampling, sides)) return std::nullopt;
    sampling.width = sides[0];
    sampling.height = sides[1];
    if (parts.size() == 1) return sampling;
    if (parts[1] != "average") return std::nullopt;
    sampling.upsample = FogSampling::Upsample::average;
    return sampling;
}

// A method with what follows its "@".
Result<Method> with_sampling(Method method, std::string_view sampling, const std::string& text) {
    const auto read = sampling_of(sampling);
    if (!read)
        return usage_error(
            fmt::format("method \"{}\": after the @ give a size from 1x1 to {}x{}, with :average "
                        "or without, or "
                        "vertices; for example exact@256x256",
                        text, kLargestSampling, kLargestSampling));
    method.sampling = *read;
    if (auto ok = check_sampling(method); !ok) return tl::unexpected(ok.error());
    return method;
}

}  // namespace

std::string FogSampling::name() const {
    if (vertices) return "vertices";
    if (width == 0) return "";
    return fmt::format("{}x{}{}", width, height, upsample == Upsample::average ? ":average" : "");
}

std::string Method::name() const {
    if (!sampling.every_pixel()) {
        Method everywhere = *this;
        everywhere.sampling = {};
        return everywhere.name() + "@" + sampling.name();
    }
    const auto with_table = [&](std::string base) {
        if (table > 0) base += fmt::format(":{}", table);
        if (table > 0 && layout == PathLayout::perimeter) base += ":perimeter";
        return base;
    };
    switch (kind) {
        case MethodKind::reference:
            return "reference";
        case MethodKind::exact:
            return "exact";
        case MethodKind::radial:
            return "radial" +
                   (radial[0] > 0 ? fmt::format(":{}x{}", radial[0], radial[1]) : std::string()) +
                   (radial_step ? ":step" : "");
        case MethodKind::paper:
            return with_table("paper");
        case MethodKind::paper_scaling:
            return with_table("paper-scaling");
        case MethodKind::march:
            return fmt::format("march:{}", samples);
        case MethodKind::froxel:
            return fmt::format("froxel:{}x{}x{}", froxels[0], froxels[1], froxels[2]);
        case MethodKind::homogeneous:
            break;
    }
    return "homogeneous";
}

Result<Method> parse_method(const std::string& text) {
    if (const auto at = text.find('@'); at != std::string::npos) {
        const Result<Method> method = parse_method(text.substr(0, at));
        if (!method) return method;
        return with_sampling(*method, std::string_view(text).substr(at + 1), text);
    }
    Method method;
    const auto parts = split(text, ':');
    const auto& name = parts.front();
    const bool bare = parts.size() == 1;
    if (name == "paper" || name == "paper-scaling") {
        method.kind = name == "paper" ? MethodKind::paper : MethodKind::paper_scaling;
        if (!parse_table(parts, method))
            return usage_error(
                fmt::format("method \"{}\": N must be {} to {} samples an edge, the layout "
                            "\"perimeter\" or nothing; for example {}:32:perimeter",
                            text, kMinTable, kMaxTable, name));
    } else if (name == "march") {
        method.kind = MethodKind::march;
        const auto samples = parts.size() == 2 ? number(parts[1], 1, kMaxSamples) : std::nullopt;
        if (!samples)
            return usage_error(
                fmt::format("method \"{}\": N must be 1 to {} samples; for example march:32", text,
                            kMaxSamples));
        method.samples = *samples;
    } else if (name == "froxel") {
        method.kind = MethodKind::froxel;
        if (parts.size() != 2 || !parse_sizes(parts[1], 1, kMaxFroxels, method.froxels))
            return usage_error(fmt::format(
                "method \"{}\": give three sizes from 1 to {}; for example froxel:160x90x64", text,
                kMaxFroxels));
    } else if (name == "radial") {
        method.kind = MethodKind::radial;
        method.radial_step = !bare && parts.back() == "step";
        const std::size_t sizes = parts.size() - 1 - (method.radial_step ? 1 : 0);
        if (sizes > 1 ||
            (sizes == 1 && !parse_sizes(parts[1], kMinRadial, kMaxRadial, method.radial)))
            return usage_error(fmt::format(
                "method \"{}\": give azimuths and rows from {} to {}, \"step\", both or nothing; "
                "for example radial:1024x256:step",
                text, kMinRadial, kMaxRadial));
    } else if (bare && name == "reference") {
        method.kind = MethodKind::reference;
    } else if (bare && name == "exact") {
        method.kind = MethodKind::exact;
    } else if (bare && name == "homogeneous") {
        method.kind = MethodKind::homogeneous;
    } else {
        return usage_error(fmt::format(
            "method \"{}\" does not exist; choose one of: {}; and @WxH, @WxH:average or "
            "@vertices behind it",
            text, kMethods));
    }
    return method;
}

Result<void> check_sampling(const Method& method) {
    if (method.sampling.every_pixel()) return {};
    const auto refuse = [&](const char* why) -> Result<void> {
        return usage_error(fmt::format("method \"{}\": {}", method.name(), why));
    };
    if (method.kind == MethodKind::reference)
        return refuse("the reference integrates every pixel; leave out what follows the @");
    if (method.kind == MethodKind::froxel)
        return refuse(
            "froxels are a reduced resolution of their own; leave out what follows the @");
    if (method.kind == MethodKind::radial && method.sampling.vertices)
        return refuse(
            "the table of radial ends at the picture's sides, and vertices lie beyond; use "
            "exact@vertices, or a reduced picture such as radial@256x256");
    return {};
}

}  // namespace wavefog
