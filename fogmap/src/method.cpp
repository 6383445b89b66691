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

}  // namespace

std::string Method::name() const {
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
        return usage_error(
            fmt::format("method \"{}\" does not exist; choose one of: {}", text, kMethods));
    }
    return method;
}

}  // namespace wavefog
